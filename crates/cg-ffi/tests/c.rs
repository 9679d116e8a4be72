//! Compiles and runs the C example: its output must be bit-identical to the estimator's here.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common;
use cg_core::truck::simulation::Simulation;
use cg_core::{Channel, Estimator, FilteredArx, Prior, Sample, Settings, Status, Step};
use cg_ffi::{CHANNELS, CgHeight, CgRollover, CgSample, CgStep, Design};
use cg_logs::log::{LogOptions, LogReader};
use cg_vehicle::emit::{Language, emit};
use cg_vehicle::{Variant, Vehicle};
use tempfile::TempDir;

const TARGET: &str = "thumbv7em-none-eabihf";

fn repository(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

fn design(channels: [Channel; CHANNELS]) -> Design {
    let vehicle = Vehicle::load(repository("fixtures/vehicles/kraz.toml")).unwrap();
    let all = cg_vehicle::design::design(&vehicle, Variant::Complete).unwrap();
    all.cast().with_channels(channels).unwrap()
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn log() -> Vec<CgSample> {
    let path = repository("fixtures/logs/F_drive1_p15_h155.csv.gz");
    let mut reader = LogReader::open(&path, &LogOptions::default()).unwrap();
    std::iter::from_fn(|| reader.next_row().unwrap())
        .map(|row| {
            common::for_c(&Sample {
                steer_rad: row.steer_rad as f32,
                roll_rad: row.roll_rad as f32,
                speed_mps: row.speed_mps as f32,
                lateral_acceleration_mps2: row.lateral_acceleration_mps2 as f32,
                yaw_rate_radps: row.yaw_rate_radps as f32,
                trailer_mass_kg: row.trailer_mass_kg as f32,
                ..Sample::absent((row.time_s * 1e6).round() as u64)
            })
        })
        .collect()
}

/// Seven turns of eight seconds to either side, with ten seconds of straight driving after each. The
/// reduced models of the suspensions are the truck.
fn turns(design: &Design) -> Vec<CgSample> {
    let mut rolls = design.channels.each_ref().map(|channel| {
        let [.., model, _, _] = &channel.models;
        Simulation::new(model, 0.02, 0.0)
    });
    (0..6300_u16)
        .map(|k| {
            let (side, phase) = (if (k / 900) % 2 == 0 { 1.0 } else { -1.0 }, f32::from(k % 900));
            let turn = ((phase - 200.0) / 400.0).clamp(0.0, 1.0);
            let force_mps2 = side * 6.4 * turn * (1.0 - turn);
            let [suspension, tractor] = &mut rolls;
            common::for_c(&Sample {
                suspension_roll_rad: suspension.push(force_mps2),
                lateral_specific_force_mps2: force_mps2,
                tractor_suspension_roll_rad: tractor.push(0.9 * force_mps2),
                tractor_lateral_specific_force_mps2: 0.9 * force_mps2,
                speed_mps: design.nominal_speed_mps,
                trailer_mass_kg: design.trailer_mass_kg[3],
                ..Sample::absent(u64::from(k) * 20_000)
            })
        })
        .collect()
}

/// An array of `cg_sample`, little-endian, as C lays it out.
fn bytes(samples: &[CgSample]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for s in samples {
        bytes.extend(s.time_us.to_le_bytes());
        for value in [
            s.steer_rad,
            s.roll_rad,
            s.roll_to_gravity_rad,
            s.tilt_rad,
            s.suspension_roll_rad,
            s.speed_mps,
            s.lateral_acceleration_mps2,
            s.lateral_specific_force_mps2,
            s.tractor_suspension_roll_rad,
            s.tractor_lateral_specific_force_mps2,
            s.tractor_tilt_rad,
            s.yaw_rate_radps,
            s.trailer_mass_kg,
        ] {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend([0; 4]);
    }
    assert_eq!(bytes.len(), size_of_val(samples));
    bytes
}

fn bits(value: f32) -> u32 {
    if value.is_nan() { 0x7fc0_0000 } else { value.to_bits() }
}

fn maneuver(step: &Step<f32, CHANNELS>, out: &mut String) {
    let told = CgStep::new(step);
    if told.closed == 0 {
        return;
    }
    let (speed, mass) = (bits(told.speed_mps), bits(told.trailer_mass_kg));
    write!(out, "maneuver {} {} {speed:08x} {mass:08x}", told.start_us, told.end_us).unwrap();
    for o in told.outcomes {
        write!(out, " | {}", o.reject).unwrap();
        for value in [
            o.ratio.value,
            o.ratio.sd,
            o.snr_db,
            o.height_m.value,
            o.height_m.sd,
            o.systematic_sd_m,
            o.road_sd_m,
        ] {
            write!(out, " {:08x}", bits(value)).unwrap();
        }
    }
    out.push('\n');
}

/// The output that the example must print.
fn expected(design: &Design, samples: &[CgSample]) -> String {
    // The numbers of a design in the order of C: all fields are single precision, but an index is whole.
    let text = emit(design, Language::Rust, &[]);
    let body = &text[text.find("speed_mps").unwrap()..];
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut is_index = false;
    for word in body.split(|c: char| !(c.is_alphanumeric() || "+-._".contains(c))) {
        if let Ok(value) = word.parse::<f32>() {
            let bits = if is_index { word.parse().unwrap() } else { value.to_bits() };
            for byte in bits.to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
        is_index = word == "index" || (is_index && word.is_empty());
    }
    let mut out = format!("design {hash:016x}\nrefusals missed 0\n");
    let mut estimator = Estimator::<f32, FilteredArx<f32>, _, CHANNELS>::new(
        *design,
        Settings::truck(),
        Prior::standard(),
    );
    let mut turning = 0;
    for sample in samples {
        let step = estimator.push(&sample.sample()).unwrap();
        turning += u32::from(step.status == Status::Turning);
        maneuver(&step, &mut out);
    }
    let closed = estimator.finish();
    maneuver(&Step { status: Status::Absent, closed }, &mut out);
    writeln!(out, "turning {turning}").unwrap();
    let alone = [0, 1].map(|place| {
        let channel = design.channel(place).unwrap();
        (i32::try_from(channel.index()).unwrap(), estimator.height(channel))
    });
    for (channel, height) in alone.iter().chain(&[(-1, estimator.combined_height())]) {
        let h = CgHeight::new(height.as_ref().unwrap());
        let [value, sd, random] = [h.height_m.value, h.height_m.sd, h.random_sd_m].map(bits);
        writeln!(out, "height {channel}: {value:08x} {sd:08x} {random:08x} of {}", h.maneuvers)
            .unwrap();
    }
    let height = estimator.combined_height().unwrap().height_m;
    let last = samples.last().unwrap();
    let rollover = design.rollover(height, last.trailer_mass_kg, last.speed_mps).unwrap();
    let rollover = CgRollover::new(&rollover);
    let threshold = rollover.static_rollover_threshold_g;
    writeln!(out, "threshold {:08x} {:08x}", bits(threshold.value), bits(threshold.sd)).unwrap();
    out
}

/// Runs a command and returns its standard output.
fn run(command: &mut Command) -> String {
    let done = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(done.status.success(), "{command:?}\n{}{}", text(&done.stdout), text(&done.stderr));
    assert!(done.stderr.is_empty(), "{command:?}\n{}", text(&done.stderr));
    text(&done.stdout)
}

/// Builds the static library in its own folder, so that it is up to date.
fn library(target: Option<&str>) -> PathBuf {
    let folder = repository("target/ffi");
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["build", "--quiet", "--release", "--package", "cg-ffi", "--lib"]);
    cargo.current_dir(repository(".")).arg("--target-dir").arg(&folder);
    if let Some(target) = target {
        cargo.args(["--target", target]);
    }
    run(&mut cargo);
    folder.join(target.unwrap_or("")).join("release/libcg_ffi.a")
}

struct Scene {
    folder: TempDir,
    expected: String,
}

impl Scene {
    /// Steer angle and lateral acceleration of a log.
    fn log() -> Self {
        Self::new(&design([Channel::Steer, Channel::LateralAcceleration]), &log())
    }

    /// The suspensions of trailer and tractor in simulated turns.
    fn turns() -> Self {
        let design = design([Channel::Suspension, Channel::Tractor]);
        Self::new(&design, &turns(&design))
    }

    fn new(design: &Design, samples: &[CgSample]) -> Self {
        let folder = TempDir::new().unwrap();
        let comment = ["The truck of the tests.".to_owned()];
        let text = emit(design, Language::C, &comment);
        std::fs::write(folder.path().join("truck.h"), text).unwrap();
        std::fs::write(folder.path().join("log.bin"), bytes(samples)).unwrap();
        let expected = expected(design, samples);
        assert!(expected.matches("maneuver").count() > 5, "{expected}");
        Self { folder, expected }
    }

    /// A compiler command with the arguments that every build of the example needs.
    fn compiler(&self, name: &str, output: &str) -> Command {
        let mut compiler = Command::new(name);
        compiler.args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-O2"]);
        compiler
            .arg("-I")
            .arg(repository("crates/cg-ffi/include"))
            .arg("-I")
            .arg(self.folder.path());
        compiler.arg("-DDESIGN=\"truck.h\"");
        compiler.arg(format!("-DLOG=\"{}\"", self.folder.path().join("log.bin").display()));
        compiler.arg(repository("crates/cg-ffi/examples/height.c"));
        compiler.arg("-o").arg(self.folder.path().join(output));
        compiler
    }

    fn program(&self, name: &str) -> Command {
        Command::new(self.folder.path().join(name))
    }
}

fn runs_here(scene: &Scene) {
    let library = library(None);
    let system = ["-lpthread", "-ldl", "-lm"];
    run(scene.compiler("gcc", "plain").arg(&library).args(system));
    assert_eq!(run(&mut scene.program("plain")), scene.expected);
    let sanitizers = ["-g", "-fsanitize=address,undefined", "-fno-sanitize-recover"];
    run(scene.compiler("gcc", "checked").args(sanitizers).arg(&library).args(system));
    assert_eq!(run(&mut scene.program("checked")), scene.expected);
}

fn runs_on_a_chip(scene: &Scene) {
    let library = library(Some(TARGET));
    let example = |name: &str| repository("crates/cg-ffi/examples").join(name);
    run(scene
        .compiler("arm-none-eabi-gcc", "chip")
        .args(["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"])
        .args(["--specs=rdimon.specs", "-Wl,--gc-sections,-z,noexecstack", "-T"])
        .arg(example("mps2.ld"))
        .arg(example("startup.c"))
        .arg(&library));
    let image = scene.folder.path().join("chip");
    let symbols = run(Command::new("arm-none-eabi-nm").arg("--demangle").arg(&image));
    assert!(symbols.contains("cg_estimator_push"), "no symbols");
    for symbol in symbols.lines() {
        assert!(!symbol.contains("panic") && !symbol.contains("__rust_alloc"), "{symbol}");
    }
    let said = run(Command::new("qemu-system-arm")
        .args(["-machine", "mps2-an386", "-nographic", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(&image));
    assert_eq!(said, scene.expected);
}

#[test]
fn c_says_what_rust_says_and_touches_nothing_else() {
    runs_here(&Scene::log());
}

#[test]
fn c_on_a_cortex_m4f_says_what_rust_says_here() {
    runs_on_a_chip(&Scene::log());
}

#[test]
fn the_suspensions_of_trailer_and_tractor_say_the_same_in_c() {
    let scene = Scene::turns();
    runs_here(&scene);
    runs_on_a_chip(&scene);
}

#[test]
fn the_header_says_the_size_that_the_library_has() {
    let header = std::fs::read_to_string(repository("crates/cg-ffi/include/cg_height.h")).unwrap();
    let line = format!("#define CG_ESTIMATOR_SIZE {}\n", cg_ffi::CG_ESTIMATOR_SIZE);
    assert!(header.contains(&line));
}
