//! The nonlinear plant as an FMU.

use cg_logs::log::{LogRow, Signal};
use cg_plant::plant::{Ground, Progress};
use cg_plant::simulate::{PlantInput, PlantRun, PlantStart};
use cg_vehicle::{Load, Vehicle};

use crate::error::FmuError;
use crate::subject::{Running, Subject};
use crate::variable::{Type, Variable, unit_of};

/// The plant of a vehicle.
pub(crate) struct PlantSubject {
    vehicle: Vehicle,
    variables: Vec<Variable>,
    /// The signals that the sensors of the vehicle show.
    signals: Vec<Signal>,
}

impl PlantSubject {
    pub(crate) fn new(vehicle: Vehicle) -> Result<Self, FmuError> {
        let usual = PlantStart::of(&vehicle);
        let run = PlantRun::new(&vehicle, &usual)?;
        let sample = run.sample();
        let row = run.row(0.0, &sample);
        let has = |signal: &Signal| signal.quantity().is_some() && !row.get(*signal).is_nan();
        let signals: Vec<Signal> = Signal::ALL.into_iter().filter(has).collect();
        let mut variables = parameters(&vehicle, &usual).to_vec();
        variables.extend(inputs(&usual));
        for quantity in signals.iter().filter_map(|signal| signal.quantity()) {
            let text = (quantity.column(), quantity.meaning());
            variables.push(Variable::output(text, Type::Float64(unit_of(quantity))));
        }
        for state in sample.state_names() {
            let text = (state.name, state.meaning);
            variables.push(Variable::output(text, Type::Float64(state.unit)));
        }
        let rolled_over =
            ("rolled_over", "Whether a unit has rolled beyond 0.6 rad; it then stays");
        variables.push(Variable::output(rolled_over, Type::Boolean));
        Ok(Self { vehicle, variables, signals })
    }
}

fn parameters(vehicle: &Vehicle, usual: &PlantStart) -> [Variable; 4] {
    let payload_kg = usual.load.trailer_mass_kg - vehicle.empty_trailer_mass_kg();
    [
        Variable::parameter(("payload_kg", "Mass of the payload"), "kg", payload_kg),
        Variable::parameter(
            ("height_m", "Height of the c.g. of the trailer's sprung mass above the road at rest"),
            "m",
            usual.load.cg_height_m,
        ),
        Variable::parameter(
            ("payload_behind_hitch_m", "Distance of the payload's c.g. behind the fifth wheel"),
            "m",
            usual.payload_behind_hitch_m,
        ),
        Variable::parameter(
            ("payload_left_m", "Distance of the payload's c.g. to the left of the middle"),
            "m",
            usual.payload_left_m,
        ),
    ]
}

fn inputs(usual: &PlantStart) -> [Variable; 4] {
    [
        Variable::input(
            (
                "steer_demand_rad",
                "Mean road-wheel angle at the end of the next step, left positive",
            ),
            "rad",
            0.0,
        ),
        Variable::input(
            ("speed_demand_mps", "Forward speed at the end of the next step"),
            "m/s",
            usual.speed_mps,
        ),
        Variable::input(
            ("bank_rad", "Bank of the road at the end of the next step, left side higher positive"),
            "rad",
            0.0,
        ),
        Variable::input(
            ("grade_rad", "Grade of the road at the end of the next step, uphill positive"),
            "rad",
            0.0,
        ),
    ]
}

impl Subject for PlantSubject {
    fn variables(&self) -> &[Variable] {
        &self.variables
    }

    fn start(&self, parameters: &[f64], inputs: &[f64]) -> Result<Box<dyn Running>, FmuError> {
        let &[payload_kg, cg_height_m, payload_behind_hitch_m, payload_left_m] = parameters else {
            return Err(FmuError::new("the plant has four parameters"));
        };
        let input = input(inputs)?;
        let trailer_mass_kg = self.vehicle.empty_trailer_mass_kg() + payload_kg;
        let start = PlantStart {
            load: Load { trailer_mass_kg, cg_height_m },
            payload_behind_hitch_m,
            payload_left_m,
            speed_mps: input.speed_mps,
            bank_rad: input.ground.bank_rad,
            grade_rad: input.ground.grade_rad,
        };
        let run = PlantRun::new(&self.vehicle, &start)?;
        Ok(Box::new(RunningPlant { run, signals: self.signals.clone() }))
    }
}

fn input(inputs: &[f64]) -> Result<PlantInput, FmuError> {
    let &[steer_rad, speed_mps, bank_rad, grade_rad] = inputs else {
        return Err(FmuError::new("the plant has four inputs"));
    };
    let ground = Ground { bank_rad, grade_rad, ..Ground::default() };
    Ok(PlantInput { steer_rad, speed_mps, ground })
}

#[derive(Clone)]
struct RunningPlant {
    run: PlantRun,
    signals: Vec<Signal>,
}

impl Running for RunningPlant {
    fn step(
        &mut self,
        inputs: &[f64],
        _from_s: f64,
        interval_s: f64,
    ) -> Result<Option<String>, FmuError> {
        let before = self.run.simulation().progress();
        let after = self.run.step(&input(inputs)?, interval_s)?;
        if before != Progress::Running || after == Progress::Running {
            return Ok(None);
        }
        Ok(self.run.simulation().upright().err().map(|error| error.to_string()))
    }

    fn write_outputs(&self, outputs: &mut [f64]) {
        let sample = self.run.sample();
        let row: LogRow = self.run.row(self.run.simulation().time_s(), &sample);
        let rolled_over = self.run.simulation().progress() != Progress::Running;
        let signals = self.signals.iter().map(|signal| row.get(*signal));
        let values = signals.chain(sample.states()).chain([f64::from(u8::from(rolled_over))]);
        for (output, value) in outputs.iter_mut().zip(values) {
            *output = value;
        }
    }

    fn messages(&self) -> Vec<String> {
        Vec::new()
    }

    fn copy(&self) -> Box<dyn Running> {
        Box::new(self.clone())
    }
}
