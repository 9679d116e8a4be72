//! `cg fmu`: plant or estimator as a functional mock-up unit (FMI 3.0).

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use cg_fmu::{Binary, Fmu, FmuFiles, FmuKind, package};
use cg_output::{Draft, Files, Kind};
use cg_vehicle::calibration::Calibration;
use cg_vehicle::files;
use clap::Args;

use crate::outcome::Outcome;
use crate::truck;
use crate::words::word;

/// Arguments of `cg fmu`.
#[derive(Debug, Args)]
pub(crate) struct FmuArgs {
    /// Vehicle file
    #[arg(long, value_name = "V.toml")]
    vehicle: PathBuf,
    /// What the FMU computes
    #[arg(long, value_parser = word::<FmuKind>())]
    kind: FmuKind,
    /// Calibration of this vehicle (from `cg calibrate`), for the estimator
    #[arg(long, value_name = "C.toml")]
    calibration: Option<PathBuf>,
    /// Shared library of the functions of FMI; may be repeated, once for each platform [default: that of
    /// this platform beside the program]
    #[arg(long, value_name = "LIB")]
    library: Vec<PathBuf>,
    /// File to write, X.fmu
    #[arg(long, short, value_name = "X.fmu")]
    output: PathBuf,
}

pub(crate) fn run(arguments: &FmuArgs, files: Files) -> anyhow::Result<Outcome> {
    let mut files = files
        .reads("--vehicle", &arguments.vehicle)
        .reads_some("--calibration", arguments.calibration.as_deref());
    for library in &arguments.library {
        files = files.reads("--library", library);
    }
    let output = &arguments.output;
    if output.extension().is_none_or(|extension| extension != "fmu") {
        return Err(anyhow!(
            "{}: the name of an FMU ends in .fmu; change --output",
            output.display()
        ));
    }
    let target = files.prints()?.writes("--output", output, Kind::Fmu)?;
    // Errors and warnings have the names of the files here; in the FMU they are resources.
    let vehicle = truck::load(&arguments.vehicle)?;
    if let (FmuKind::Estimator, Some(path)) = (arguments.kind, &arguments.calibration) {
        Calibration::load(path, &vehicle)?;
    }
    let fmu = Fmu::new(
        arguments.kind,
        FmuFiles {
            vehicle: text(&arguments.vehicle)?,
            calibration: arguments.calibration.as_deref().map(text).transpose()?,
        },
    )?;
    let own = if arguments.library.is_empty() { vec![beside()?] } else { Vec::new() };
    let libraries = arguments.library.iter().chain(&own);
    let binaries = libraries.map(|path| binary(path)).collect::<anyhow::Result<Vec<_>>>()?;
    let bytes = package(&fmu, &binaries)?;
    target.write_bytes(&bytes)?.map_or(Ok(()), Draft::publish)?;
    Ok(Outcome::Done)
}

fn text(path: &Path) -> anyhow::Result<String> {
    files::read_text(path, files::VEHICLE_BYTES).with_context(|| path.display().to_string())
}

fn binary(path: &Path) -> anyhow::Result<Binary> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).with_context(|| name.clone())?;
    Ok(Binary::new(&name, bytes)?)
}

/// The shared library of this platform, in the folder of the program or in `lib` beside that.
fn beside() -> anyhow::Result<PathBuf> {
    let program = std::env::current_exe().context("the place of the program is not known")?;
    let folder = program.parent().unwrap_or(Path::new("."));
    let name = format!("{DLL_PREFIX}cg_fmi{DLL_SUFFIX}");
    let places = [folder.join(&name), folder.join("../lib").join(&name)];
    places.into_iter().find(|path| path.exists()).ok_or_else(|| {
        anyhow!(
            "{}: no {name}, which an FMU contains; build it with cargo build --release --package cg-fmi, \
             or give --library",
            folder.display()
        )
    })
}
