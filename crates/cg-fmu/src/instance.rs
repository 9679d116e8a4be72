//! One instance of an FMU: its values, and what may be called when.

use std::path::Path;
use std::sync::Arc;

use crate::error::FmuError;
use crate::fmu::Fmu;
use crate::subject::Running;
use crate::variable::{Causality, Type, Variable};

/// Greatest difference between the time of an instance and the communication point of a caller, who adds up
/// the steps in an order of its own.
const SAME_TIME_S: f64 = 1e-6;

/// The part of its life in which an instance is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Instantiated,
    Initialization,
    Stepping,
    Terminated,
}

impl Phase {
    /// What is allowed now.
    fn next(self) -> &'static str {
        match self {
            Self::Instantiated => "enter the initialization mode first",
            Self::Initialization => "exit the initialization mode first",
            Self::Stepping => "only steps, termination and reset are allowed while it is simulated",
            Self::Terminated => "the instance was terminated: reset it first",
        }
    }
}

/// The result of a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stepped {
    /// Why the simulation should end, if it should.
    pub end: Option<String>,
}

/// An instance.
pub struct Instance {
    fmu: Arc<Fmu>,
    phase: Phase,
    time_s: f64,
    values: Vec<f64>,
    running: Option<Box<dyn Running>>,
    /// Whether the outputs among `values` are those of an earlier time.
    stale: bool,
}

impl Clone for Instance {
    fn clone(&self) -> Self {
        Self {
            fmu: Arc::clone(&self.fmu),
            values: self.values.clone(),
            running: self.running.as_ref().map(|running| running.copy()),
            ..*self
        }
    }
}

impl Instance {
    /// An instance with the start values of its variables.
    pub fn new(fmu: Arc<Fmu>) -> Self {
        let values = fmu.variables().iter().map(|variable| variable.start).collect();
        Self { fmu, phase: Phase::Instantiated, time_s: 0.0, values, running: None, stale: true }
    }

    /// An instance of the FMU whose resources are in a folder.
    ///
    /// # Errors
    /// As [`Fmu::unpacked`].
    pub fn unpacked(token: &str, resources: &Path) -> Result<Self, FmuError> {
        Ok(Self::new(Arc::new(Fmu::unpacked(token, resources)?)))
    }

    /// Begins the initialization at a time.
    ///
    /// # Errors
    /// [`FmuError`] if it has begun already.
    pub fn enter_initialization(&mut self, start_s: f64) -> Result<(), FmuError> {
        self.expect(Phase::Instantiated)?;
        if !start_s.is_finite() {
            return Err(FmuError::new(format!("the start time {start_s} s must be finite")));
        }
        self.time_s = start_s;
        self.phase = Phase::Initialization;
        Ok(())
    }

    /// Ends the initialization: the plant drives straight, or the estimator waits for its first sample.
    ///
    /// # Errors
    /// [`FmuError`] if a parameter or an input is not possible.
    pub fn exit_initialization(&mut self) -> Result<(), FmuError> {
        self.expect(Phase::Initialization)?;
        self.start()?;
        self.phase = Phase::Stepping;
        Ok(())
    }

    /// Advances from a time by an interval of any length.
    ///
    /// # Errors
    /// [`FmuError`] if the time is not that of the end of the last step, or an input is not possible.
    pub fn step(&mut self, from_s: f64, interval_s: f64) -> Result<Stepped, FmuError> {
        self.expect(Phase::Stepping)?;
        if !((from_s - self.time_s).abs() <= SAME_TIME_S) {
            return Err(FmuError::new(format!(
                "the step begins at {from_s} s, but the instance is at {} s",
                self.time_s
            )));
        }
        if !(interval_s > 0.0 && interval_s.is_finite()) {
            return Err(FmuError::new(format!(
                "the communication step size {interval_s} s must be positive"
            )));
        }
        let inputs = self.places(Causality::Input);
        let Some(running) = &mut self.running else { return Err(FmuError::new("not initialized")) };
        self.stale = true;
        let end = running.step(&self.values[inputs], from_s, interval_s)?;
        self.time_s = from_s + interval_s;
        Ok(Stepped { end })
    }

    /// Ends the simulation and returns its last messages. The outputs can still be read.
    ///
    /// # Errors
    /// [`FmuError`] if it is not being simulated.
    pub fn terminate(&mut self) -> Result<Vec<String>, FmuError> {
        self.expect(Phase::Stepping)?;
        self.phase = Phase::Terminated;
        Ok(self.running.as_ref().map(|running| running.messages()).unwrap_or_default())
    }

    /// Makes it as it was after its construction.
    pub fn reset(&mut self) {
        *self = Self::new(Arc::clone(&self.fmu));
    }

    /// The time.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// The values of variables of types that `is_type` accepts, by their references.
    ///
    /// # Errors
    /// [`FmuError`] if there is no such variable, or if it cannot be computed yet.
    pub fn get(
        &mut self,
        references: &[u32],
        is_type: fn(Type) -> bool,
        mut write: impl FnMut(usize, f64),
    ) -> Result<(), FmuError> {
        for (place, &reference) in references.iter().enumerate() {
            if reference == 0 && is_type(Type::Float64("s")) {
                write(place, self.time_s);
                continue;
            }
            let (index, variable) = self.variable(reference, is_type)?;
            if variable.causality == Causality::Output {
                self.refresh()?;
            }
            write(place, self.values[index]);
        }
        Ok(())
    }

    /// Sets variables of types that `is_type` accepts: parameters before the end of the initialization,
    /// inputs before a step.
    ///
    /// # Errors
    /// [`FmuError`] if there is no such variable, or if it cannot be set now. Then none is set.
    pub fn set(
        &mut self,
        references: &[u32],
        is_type: fn(Type) -> bool,
        values: &[f64],
    ) -> Result<(), FmuError> {
        let early = matches!(self.phase, Phase::Instantiated | Phase::Initialization);
        let mut places = Vec::with_capacity(references.len());
        for &reference in references {
            let (index, variable) = self.variable(reference, is_type)?;
            let allowed = match variable.causality {
                Causality::Parameter => early,
                Causality::Input => early || self.phase == Phase::Stepping,
                Causality::Output => false,
            };
            if !allowed {
                let why = match variable.causality {
                    Causality::Output => "it is an output",
                    _ => self.phase.next(),
                };
                return Err(FmuError::new(format!("{} cannot be set: {why}", variable.name)));
            }
            places.push(index);
        }
        for (index, value) in places.into_iter().zip(values) {
            self.values[index] = *value;
        }
        if self.phase == Phase::Initialization {
            self.running = None;
            self.stale = true;
        }
        Ok(())
    }

    fn variable(
        &self,
        reference: u32,
        is_type: fn(Type) -> bool,
    ) -> Result<(usize, &Variable), FmuError> {
        let index = usize::try_from(reference).ok().and_then(|place| place.checked_sub(1));
        let found = index.and_then(|index| Some((index, self.fmu.variables().get(index)?)));
        found.filter(|(_, variable)| is_type(variable.kind)).ok_or_else(|| {
            FmuError::new(format!(
                "there is no variable of this type with value reference {reference}"
            ))
        })
    }

    /// The places of the variables of a kind, which are next to each other.
    fn places(&self, causality: Causality) -> std::ops::Range<usize> {
        let all = self.fmu.variables();
        let first = all.partition_point(|variable| rank(variable.causality) < rank(causality));
        let end = all.partition_point(|variable| rank(variable.causality) <= rank(causality));
        first..end
    }

    fn start(&mut self) -> Result<(), FmuError> {
        if self.running.is_none() {
            let parameters = &self.values[self.places(Causality::Parameter)];
            let inputs = &self.values[self.places(Causality::Input)];
            self.running = Some(self.fmu.subject().start(parameters, inputs)?);
        }
        Ok(())
    }

    /// Computes the outputs if they are those of an earlier time. During the initialization they are those
    /// of the present parameters and inputs.
    fn refresh(&mut self) -> Result<(), FmuError> {
        if self.phase == Phase::Instantiated {
            return Err(FmuError::new(format!("outputs cannot be read: {}", self.phase.next())));
        }
        if self.stale {
            self.start()?;
            let outputs = self.places(Causality::Output);
            if let Some(running) = &self.running {
                running.write_outputs(&mut self.values[outputs]);
            }
            self.stale = false;
        }
        Ok(())
    }

    fn expect(&self, phase: Phase) -> Result<(), FmuError> {
        if self.phase == phase {
            return Ok(());
        }
        Err(FmuError::new(format!("this cannot be called now: {}", self.phase.next())))
    }
}

/// The order of the variables.
fn rank(causality: Causality) -> u8 {
    match causality {
        Causality::Parameter => 0,
        Causality::Input => 1,
        Causality::Output => 2,
    }
}
