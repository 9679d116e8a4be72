//! `cg model`: transfer function, poles, zeros, DC ratio, reduced model and static loads; of a calibrated
//! truck the compensated models too.

use std::io::Write;

use anyhow::Context;
use cg_core::truck::reduced::ORDER;
use cg_core::{Channel, RatioLine};
use cg_vehicle::belief::Belief;
use cg_vehicle::compensated::{CompensatedModel, compensated_models};
use cg_vehicle::reduction::{Method, reduce};
use cg_vehicle::response::{NamedResponse, StateSpace};
use cg_vehicle::system::{Rational, TransferFunction};
use cg_vehicle::{LinearModel, Vehicle, VehicleError};
use serde::Serialize;

use crate::args::ModelFormat;
use crate::cli::ModelArgs;
use crate::outcome::Outcome;

/// The JSON output.
#[derive(Serialize)]
struct Description {
    vehicle: String,
    speed_mps: f64,
    height_m: f64,
    trailer_mass_kg: f64,
    numerator: Vec<f64>,
    denominator: Vec<f64>,
    poles: Vec<(f64, f64)>,
    zeros: Vec<(f64, f64)>,
    gain: f64,
    dc_gain: f64,
    ratio: Line,
    lateral_acceleration_ratio: Line,
    suspension_ratio: Line,
    tractor_ratio: Line,
    reduced: Reduced,
    static_balance: Balance,
    responses: Vec<Response>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    compensated: Vec<Compensated>,
}

/// The transfer function to one of the responses of appendix C of the thesis. The denominator of a yaw angle
/// has a root at zero, and its DC gain is absent.
#[derive(Serialize)]
struct Response {
    name: String,
    unit: &'static str,
    numerator: Vec<f64>,
    denominator: Vec<f64>,
    dc_gain: Option<f64>,
}

/// The compensated model of a channel, with a DC gain of one.
#[derive(Serialize)]
struct Compensated {
    channel: String,
    order: usize,
    function: Quotient,
    product: Quotient,
    reduced: Quotient,
    change_percent: f64,
    reduction_error_percent: f64,
}

/// Coefficients in descending powers of s.
#[derive(Serialize)]
struct Quotient {
    numerator: Vec<f64>,
    denominator: Vec<f64>,
}

/// `R_a(h) = (a1 h + a0)/(b1 h + b0)` with h in meters.
#[derive(Serialize)]
struct Line {
    a0: f64,
    a1: f64,
    b0: f64,
    b1: f64,
}

#[derive(Serialize)]
struct Reduced {
    order: usize,
    method: &'static str,
    numerator: Vec<f64>,
    denominator: Vec<f64>,
}

#[derive(Serialize)]
struct Balance {
    axle_load_n: Vec<f64>,
    hitch_load_n: f64,
    residual_nm: f64,
}

pub(crate) fn run(arguments: &ModelArgs) -> anyhow::Result<Outcome> {
    let vehicle = arguments.truck.load()?;
    let calibration = arguments.truck.calibration(&vehicle)?;
    let vehicle = arguments.truck.lift.of(&vehicle)?;
    let description = match calibration {
        None => describe(arguments, &vehicle)?,
        Some(calibration) => {
            let belief = calibration.belief();
            let compensated = compensated(arguments, &vehicle, &belief)?;
            let calibrated = describe(arguments, &belief.applied_to(&vehicle))?;
            Description { compensated, ..calibrated }
        }
    };
    let mut out = std::io::stdout().lock();
    match arguments.format {
        ModelFormat::Json => writeln!(out, "{}", serde_json::to_string(&description)?),
        ModelFormat::Table => print(&mut out, &description),
    }
    .context("standard output: cannot be written")?;
    Ok(Outcome::Done)
}

/// The compensated models of a calibrated truck.
fn compensated(
    arguments: &ModelArgs,
    vehicle: &Vehicle,
    belief: &Belief,
) -> anyhow::Result<Vec<Compensated>> {
    let speed_mps = arguments.speed_mps.unwrap_or(vehicle.nominal_speed_mps);
    let at = (speed_mps, arguments.load.load(vehicle));
    let quotient = |one: &Rational| Quotient {
        numerator: one.numerator.iter().rev().copied().collect(),
        denominator: one.denominator.iter().rev().copied().collect(),
    };
    let models = compensated_models(vehicle, arguments.truck.model, belief, at)?;
    let described = |model: &CompensatedModel| Compensated {
        channel: model.channel.to_string(),
        order: model.function.denominator.len() - 1,
        function: quotient(&model.function),
        product: quotient(&model.product),
        reduced: quotient(&model.reduced),
        change_percent: 100.0 * model.change,
        reduction_error_percent: 100.0 * model.reduction_error,
    };
    Ok(models.iter().map(described).collect())
}

fn describe(arguments: &ModelArgs, vehicle: &Vehicle) -> anyhow::Result<Description> {
    let speed_mps = arguments.speed_mps.unwrap_or(vehicle.nominal_speed_mps);
    let load = arguments.load.load(vehicle);
    let model = LinearModel::new(vehicle, arguments.truck.model, speed_mps, load)?;
    let state_space = &model.state_space;
    let TransferFunction { numerator, denominator, poles, zeros, gain, dc_gain } =
        state_space.to_trailer_roll().transfer_function()?;
    let models = reduce(state_space, &[]).map_err(|error| error.of_vehicle(vehicle))?;
    let line = |line: &RatioLine<f64>| Line { a0: line.a0, a1: line.a1, b0: line.b0, b1: line.b1 };
    let mut reduced_denominator = vec![1.0];
    let steer = &models.of_channels[Channel::Steer.index()];
    reduced_denominator.extend(steer.denominator.iter().rev());
    Ok(Description {
        vehicle: vehicle.name.clone(),
        speed_mps,
        height_m: load.cg_height_m,
        trailer_mass_kg: load.trailer_mass_kg,
        numerator,
        denominator,
        poles,
        zeros,
        gain,
        dc_gain,
        ratio: line(&model.ratio[0]),
        lateral_acceleration_ratio: line(&model.ratio[1]),
        suspension_ratio: line(&model.ratio[2]),
        tractor_ratio: line(&model.ratio[3]),
        reduced: Reduced {
            order: ORDER,
            method: match models.method {
                Method::Pade => "pade",
                Method::SlowestPoles => "slowest-poles",
            },
            numerator: steer.numerator.iter().rev().copied().collect(),
            denominator: reduced_denominator,
        },
        static_balance: Balance {
            axle_load_n: model.balance.axle_load_n,
            hitch_load_n: model.balance.hitch_load_n,
            residual_nm: model.balance.residual_nm,
        },
        responses: responses(state_space)?,
        compensated: Vec::new(),
    })
}

fn responses(model: &StateSpace) -> Result<Vec<Response>, VehicleError> {
    let of = |response: NamedResponse| {
        let function = model.transfer_function_of(&response)?;
        Ok(Response {
            name: response.name,
            unit: response.unit,
            numerator: function.numerator,
            denominator: function.denominator,
            dc_gain: Some(function.dc_gain).filter(|gain| gain.is_finite()),
        })
    };
    model.responses().into_iter().map(of).collect()
}

fn print(out: &mut impl Write, d: &Description) -> std::io::Result<()> {
    writeln!(
        out,
        "{}: {:.2} m/s, c.g. height {:.3} m, trailer {:.0} kg",
        d.vehicle, d.speed_mps, d.height_m, d.trailer_mass_kg
    )?;
    writeln!(out, "\nSteer angle to trailer roll angle (ISO 8855: left turns positive)")?;
    writeln!(out, "  DC gain {:.5} rad/rad, leading coefficient {:.6}", d.dc_gain, d.gain)?;
    writeln!(out, "\n  power      numerator    denominator")?;
    let degree = d.denominator.len() - 1;
    let lead = d.denominator.len() - d.numerator.len();
    for (k, denominator) in d.denominator.iter().enumerate() {
        let numerator = k
            .checked_sub(lead)
            .and_then(|k| d.numerator.get(k))
            .map_or_else(String::new, |a| format!("{a:.5e}"));
        writeln!(out, "  s^{:<4}  {numerator:>13}  {denominator:>13.5e}", degree - k)?;
    }
    for (name, roots) in [("Poles", &d.poles), ("Zeros", &d.zeros)] {
        writeln!(out, "\n  {name}, rad/s")?;
        for (re, im) in roots.iter().filter(|root| root.1 >= 0.0) {
            if *im == 0.0 {
                writeln!(out, "  {re:12.4}")?;
            } else {
                writeln!(out, "  {re:12.4} ± {im:.4}i")?;
            }
        }
    }
    writeln!(
        out,
        "\nDC ratio as a function of height, R = (a1 h + a0) / (b1 h + b0), h in meters"
    )?;
    for (name, line) in [
        ("steer", &d.ratio),
        ("lateral acceleration", &d.lateral_acceleration_ratio),
        ("suspension", &d.suspension_ratio),
        ("tractor", &d.tractor_ratio),
    ] {
        writeln!(
            out,
            "  {name:<21} a0 {:+.6}  a1 {:+.6}  b0 {:+.6}  b1 {:+.6}",
            line.a0, line.a1, line.b0, line.b1
        )?;
    }
    writeln!(
        out,
        "\nReduced to order {} ({}), descending powers",
        d.reduced.order, d.reduced.method
    )?;
    writeln!(out, "  numerator   {:?}", rounded(&d.reduced.numerator))?;
    writeln!(out, "  denominator {:?}", rounded(&d.reduced.denominator))?;
    writeln!(out, "\nStatic loads")?;
    for (i, load_n) in d.static_balance.axle_load_n.iter().enumerate() {
        writeln!(out, "  axle {}       {:9.2} kN", i + 1, load_n / 1e3)?;
    }
    writeln!(out, "  fifth wheel  {:9.2} kN", d.static_balance.hitch_load_n / 1e3)?;
    print_responses(out, &d.responses)?;
    d.compensated.iter().try_for_each(|model| print_compensated(out, model))
}

fn print_responses(out: &mut impl Write, responses: &[Response]) -> std::io::Result<()> {
    writeln!(out, "\nSteer angle to every response; --format json has the coefficients")?;
    for response in responses {
        let (zeros, poles) = (response.numerator.len() - 1, response.denominator.len() - 1);
        let gain = response.dc_gain.map_or_else(
            || "no DC gain: it grows in a steady turn".to_owned(),
            |gain| format!("DC gain {gain:.5} {} per rad", response.unit),
        );
        writeln!(out, "  {:<25} degree {zeros} over {poles}, {gain}", response.name)?;
    }
    Ok(())
}

fn print_compensated(out: &mut impl Write, model: &Compensated) -> std::io::Result<()> {
    writeln!(
        out,
        "\nCompensated {}: F(s) of order {} changes a step by {:.2} %, order {ORDER} leaves {:.2} % of it",
        model.channel, model.order, model.change_percent, model.reduction_error_percent
    )?;
    let all = [("F", &model.function), ("product", &model.product), ("reduced", &model.reduced)];
    for (name, Quotient { numerator, denominator }) in all {
        writeln!(out, "  {name:<8} {:?} / {:?}", rounded(numerator), rounded(denominator))?;
    }
    Ok(())
}

fn rounded(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| (value * 1e4).round() / 1e4).collect()
}
