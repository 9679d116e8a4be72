//! `modelDescription.xml`.

use std::io;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};

use crate::fmu::{Fmu, FmuKind};
use crate::variable::{Causality, Enumeration, Type, UNITS, Variable};

/// The program and its version, by which cg knows its own files.
const TOOL: &str = concat!("cg-height ", env!("CARGO_PKG_VERSION")); // kind::FMU_TOOL
/// Proposed communication step.
const STEP_S: &str = "0.01";
/// Longest internal step of the plant.
const PLANT_STEP_S: &str = "0.001";

type Xml = Writer<Vec<u8>>;
type Attributes<'a> = &'a [(&'a str, &'a str)];

impl Fmu {
    /// The model description.
    pub(crate) fn description(&self) -> Result<Vec<u8>, io::Error> {
        let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
        xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        let what = match self.kind() {
            FmuKind::Plant => "Nonlinear plant of the semitrailer",
            FmuKind::Estimator => "Estimator of the c.g. height of the semitrailer",
        };
        let description = format!("{what} \"{}\"", self.vehicle_name());
        let root = [
            ("fmiVersion", "3.0"),
            ("modelName", self.kind().model_identifier()),
            ("instantiationToken", &self.token()),
            ("description", &description),
            ("generationTool", TOOL),
            ("version", env!("CARGO_PKG_VERSION")),
            ("license", "MIT OR Apache-2.0"),
            ("variableNamingConvention", "flat"),
        ];
        xml.create_element("fmiModelDescription").with_attributes(root).write_inner_content(
            |xml| {
                self.write_co_simulation(xml)?;
                write_units(xml)?;
                self.write_types(xml)?;
                xml.create_element("LogCategories").write_inner_content(write_categories)?;
                let experiment = [("startTime", "0"), ("stopTime", "60"), ("stepSize", STEP_S)];
                empty(xml, "DefaultExperiment", &experiment)?;
                xml.create_element("ModelVariables").write_inner_content(|xml| {
                    empty(xml, "Float64", &TIME)?;
                    let mut all = (1..).zip(self.variables());
                    all.try_for_each(|(reference, variable)| {
                        write_variable(xml, reference, variable)
                    })
                })?;
                xml.create_element("ModelStructure").write_inner_content(|xml| {
                    self.write_outputs(xml, "Output")?;
                    self.write_outputs(xml, "InitialUnknown")
                })?;
                Ok(())
            },
        )?;
        Ok(xml.into_inner())
    }

    fn write_co_simulation(&self, xml: &mut Xml) -> io::Result<()> {
        let mut attributes = vec![
            ("modelIdentifier", self.kind().model_identifier()),
            ("canGetAndSetFMUState", "true"),
            ("canHandleVariableCommunicationStepSize", "true"),
        ];
        if self.kind() == FmuKind::Plant {
            attributes.push(("fixedInternalStepSize", PLANT_STEP_S));
        }
        empty(xml, "CoSimulation", &attributes)
    }

    /// The enumerations of the variables.
    fn write_types(&self, xml: &mut Xml) -> io::Result<()> {
        let all: Vec<&Enumeration> = self
            .variables()
            .iter()
            .filter_map(|variable| match variable.kind {
                Type::Enumeration(kind) => Some(kind),
                _ => None,
            })
            .collect();
        if all.is_empty() {
            return Ok(());
        }
        xml.create_element("TypeDefinitions")
            .write_inner_content(|xml| all.iter().try_for_each(|kind| write_enumeration(xml, kind)))
            .map(|_| ())
    }

    fn write_outputs(&self, xml: &mut Xml, element: &str) -> io::Result<()> {
        for (reference, variable) in (1..).zip(self.variables()) {
            if variable.causality == Causality::Output {
                let reference: &str = &i32::to_string(&reference);
                empty(xml, element, &[("valueReference", reference)])?;
            }
        }
        Ok(())
    }
}

const TIME: [(&str, &str); 6] = [
    ("name", "time"),
    ("valueReference", "0"),
    ("description", "Time"),
    ("causality", "independent"),
    ("variability", "continuous"),
    ("unit", "s"),
];

fn empty(xml: &mut Xml, element: &str, attributes: Attributes<'_>) -> io::Result<()> {
    xml.create_element(element)
        .with_attributes(attributes.iter().copied())
        .write_empty()
        .map(|_| ())
}

fn write_units(xml: &mut Xml) -> io::Result<()> {
    xml.create_element("UnitDefinitions")
        .write_inner_content(|xml| {
            UNITS.iter().try_for_each(|(symbol, exponents)| {
                let texts: Vec<(&str, String)> =
                    exponents.iter().map(|(base, power)| (*base, power.to_string())).collect();
                let base: Vec<(&str, &str)> =
                    texts.iter().map(|(base, power)| (*base, power.as_str())).collect();
                xml.create_element("Unit")
                    .with_attribute(("name", *symbol))
                    .write_inner_content(|xml| empty(xml, "BaseUnit", &base))
                    .map(|_| ())
            })
        })
        .map(|_| ())
}

fn write_enumeration(xml: &mut Xml, kind: &Enumeration) -> io::Result<()> {
    xml.create_element("EnumerationType")
        .with_attributes([("name", kind.name), ("description", kind.meaning)])
        .write_inner_content(|xml| {
            (1..).zip(kind.items).try_for_each(|(value, (name, meaning))| {
                let value: &str = &i32::to_string(&value);
                empty(xml, "Item", &[("name", name), ("value", value), ("description", meaning)])
            })
        })
        .map(|_| ())
}

fn write_categories(xml: &mut Xml) -> io::Result<()> {
    for (name, meaning) in [
        ("logStatusWarning", "Why a simulation ended, and what the estimator says at its end"),
        ("logStatusError", "Errors; they are always reported"),
    ] {
        empty(xml, "Category", &[("name", name), ("description", meaning)])?;
    }
    Ok(())
}

fn write_variable(xml: &mut Xml, reference: u32, variable: &Variable) -> io::Result<()> {
    let (causality, variability) = match (variable.causality, variable.kind) {
        (Causality::Parameter, _) => ("parameter", "fixed"),
        (Causality::Input, _) => ("input", "continuous"),
        (Causality::Output, Type::Float64(_)) => ("output", "continuous"),
        (Causality::Output, _) => ("output", "discrete"),
    };
    let reference = reference.to_string();
    let mut attributes = vec![
        ("name", variable.name.as_str()),
        ("valueReference", reference.as_str()),
        ("description", variable.description.as_str()),
        ("causality", causality),
        ("variability", variability),
    ];
    let start = variable.start.to_string();
    if variable.causality != Causality::Output {
        attributes.push(("start", start.as_str()));
    }
    let element = match variable.kind {
        Type::Float64(unit) => {
            attributes.extend((!unit.is_empty()).then_some(("unit", unit)));
            "Float64"
        }
        Type::Int64 => "Int64",
        Type::Boolean => "Boolean",
        Type::Enumeration(kind) => {
            attributes.push(("declaredType", kind.name));
            "Enumeration"
        }
    };
    empty(xml, element, &attributes)
}
