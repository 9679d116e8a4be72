//! Compiles and runs the C example: its output must be bit-identical to the estimator's here.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use cg_core::{Channel, Design, Estimator, FilteredArx, Prior, Settings, Status, Step};
use cg_ffi::{CgHeight, CgRollover, CgSample, CgStep};
use cg_logs::log::{LogOptions, LogReader};
use cg_vehicle::emit::{Language, emit};
use cg_vehicle::{Variant, Vehicle};
use tempfile::TempDir;

const TARGET: &str = "thumbv7em-none-eabihf";

fn repository(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

fn design() -> Design<f32> {
    let vehicle = Vehicle::load(repository("fixtures/vehicles/kraz.toml")).unwrap();
    cg_vehicle::design::design(&vehicle, Variant::Complete).unwrap().cast()
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn samples() -> Vec<CgSample> {
    let path = repository("fixtures/logs/F_drive1_p15_h155.csv.gz");
    let mut reader = LogReader::open(&path, &LogOptions::default()).unwrap();
    std::iter::from_fn(|| reader.next_row().unwrap())
        .map(|row| CgSample {
            time_us: (row.time_s * 1e6).round() as u64,
            steer_rad: row.steer_rad as f32,
            roll_rad: row.roll_rad as f32,
            tilt_rad: f32::NAN,
            speed_mps: row.speed_mps as f32,
            lateral_acceleration_mps2: row.lateral_acceleration_mps2 as f32,
            yaw_rate_radps: row.yaw_rate_radps as f32,
            trailer_mass_kg: row.trailer_mass_kg as f32,
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
            s.tilt_rad,
            s.speed_mps,
            s.lateral_acceleration_mps2,
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

fn maneuver(step: &Step<f32>, out: &mut String) {
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
        ] {
            write!(out, " {:08x}", bits(value)).unwrap();
        }
    }
    out.push('\n');
}

/// The output that the example must print.
fn expected(design: &Design<f32>, samples: &[CgSample]) -> String {
    // The numbers of a design in the order of C: all fields are single precision.
    let text = emit(design, Language::Rust, &[]);
    let body = &text[text.find("speed_mps").unwrap()..];
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for word in body.split(|c: char| !(c.is_alphanumeric() || "+-._".contains(c))) {
        if let Ok(value) = word.parse::<f32>() {
            for byte in value.to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
    }
    let mut out = format!("design {hash:016x}\nrefusals missed 0\n");
    let mut estimator =
        Estimator::<f32, FilteredArx<f32>>::new(*design, Settings::truck(), Prior::standard());
    let mut turning = 0;
    for sample in samples {
        let step = estimator.push(&sample.sample()).unwrap();
        turning += u32::from(step.status == Status::Turning);
        maneuver(&step, &mut out);
    }
    let closed = estimator.finish();
    maneuver(&Step { status: Status::Absent, closed }, &mut out);
    writeln!(out, "turning {turning}").unwrap();
    let heights = [
        estimator.height(Channel::Steer),
        estimator.height(Channel::LateralAcceleration),
        estimator.combined_height(),
    ];
    for (channel, height) in heights.iter().enumerate() {
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
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        let (design, samples) = (design(), samples());
        let comment = ["The truck of the tests.".to_owned()];
        let text = emit(&design, Language::C, &comment);
        std::fs::write(folder.path().join("truck.h"), text).unwrap();
        std::fs::write(folder.path().join("log.bin"), bytes(&samples)).unwrap();
        let expected = expected(&design, &samples);
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

#[test]
fn c_says_what_rust_says_and_touches_nothing_else() {
    let scene = Scene::new();
    let library = library(None);
    let system = ["-lpthread", "-ldl", "-lm"];
    run(scene.compiler("gcc", "plain").arg(&library).args(system));
    assert_eq!(run(&mut scene.program("plain")), scene.expected);
    let sanitizers = ["-g", "-fsanitize=address,undefined", "-fno-sanitize-recover"];
    run(scene.compiler("gcc", "checked").args(sanitizers).arg(&library).args(system));
    assert_eq!(run(&mut scene.program("checked")), scene.expected);
}

#[test]
fn c_on_a_cortex_m4f_says_what_rust_says_here() {
    let scene = Scene::new();
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
fn the_header_says_the_size_that_the_library_has() {
    let header = std::fs::read_to_string(repository("crates/cg-ffi/include/cg_height.h")).unwrap();
    let line = format!("#define CG_ESTIMATOR_SIZE {}\n", cg_ffi::CG_ESTIMATOR_SIZE);
    assert!(header.contains(&line));
}
