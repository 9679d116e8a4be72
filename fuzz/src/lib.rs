//! One function for each reader of foreign input, called by libFuzzer (`fuzz_targets/`) and by
//! `crates/cg-logs/tests/fuzz_seeds.rs`.
//!
//! Each function returns whether the reader accepted the bytes, so that a kept seed that is no longer
//! accepted is noticed. A panic, a failed assertion, a hang or high memory use is a finding.

use std::io::Cursor;
use std::sync::LazyLock;

use cg_core::{AlignSettings, Design, Estimator, FilteredArx, Prior, Quantity, Sample, Settings};
use cg_logs::can::{Content, Decoder, Frame, MappedSignal, Sampler, SignalMap, parse};
use cg_logs::log::{LogError, LogOptions, LogReader, Signal};
use cg_logs::state::{Owner, State, design_crc32};
use cg_vehicle::calibration::Calibration;
use cg_vehicle::design::{design, design_with};
use cg_vehicle::{Variant, Vehicle};

mod drive;

/// The truck of the calibrations and states.
static TRUCK: LazyLock<Vehicle> = LazyLock::new(|| {
    Vehicle::parse(include_str!("../../fixtures/vehicles/kraz.toml"), "kraz.toml")
        .expect("a fixture")
});
static DESIGN: LazyLock<Design<f64>> =
    LazyLock::new(|| design(&TRUCK, Variant::Complete).expect("a fixture"));

/// The choices in the first byte, and the bytes after it.
fn choices(data: &[u8]) -> (u8, &[u8]) {
    data.split_first().map_or((0, data), |(&first, rest)| (first, rest))
}

/// The bytes before and after the first zero byte.
fn two_parts(data: &[u8]) -> (&[u8], &[u8]) {
    match data.iter().position(|&byte| byte == 0) {
        Some(at) => (&data[..at], &data[at + 1..]),
        None => (&[], data),
    }
}

/// True for one in 32 inputs, always the same ones: for slow checks.
fn is_chosen(data: &[u8]) -> bool {
    crc32fast::hash(data).is_multiple_of(32)
}

fn finite_or_absent(value: f64) -> bool {
    value.is_nan() || value.is_finite()
}

/// A log: one byte of options, then CSV or candump text, plain or gzip.
pub fn log_reader(data: &[u8]) -> bool {
    let (choice, log) = choices(data);
    let on = |bit: u8| choice >> bit & 1 == 1;
    let mut options = LogOptions::default();
    if on(0) {
        options.settings = Some(TRUCK.align_settings());
    }
    if on(2) {
        options.columns = vec!["roll=angle[deg]".parse().expect("a column")];
    }
    if on(3) {
        options.flip = vec![Signal::Roll];
    }
    let stream = Box::new(Cursor::new(log.to_vec()));
    let reader = match LogReader::from_reader("log", stream, &options) {
        Ok(reader) => reader,
        Err(error) => {
            assert!(error.to_string().starts_with("log"), "{error}");
            return false;
        }
    };
    let reader = if on(1) { reader.over_bad_rows() } else { reader };
    read_all(reader, log.len())
}

fn read_all(mut reader: LogReader, most_bytes: usize) -> bool {
    let mut previous_s = f64::NEG_INFINITY;
    let mut rows = 0_u32;
    loop {
        match reader.next_row() {
            Ok(Some(row)) => {
                assert!(row.time_s.is_finite() && row.time_s > previous_s, "{row:?}");
                for signal in Signal::ALL {
                    assert!(finite_or_absent(row.get(signal)), "{signal} of {row:?}");
                }
                previous_s = row.time_s;
                rows += 1;
            }
            Ok(None) => break,
            Err(error) => {
                let text = error.to_string();
                let place = if error.is_of_a_row() && !reader.is_of_frames() {
                    format!("log, line {}", reader.line())
                } else {
                    "log".to_owned()
                };
                assert!(text.starts_with(&place), "{text}, not at {place}");
                if let LogError::TimeOrder { time_s, .. } = error {
                    previous_s = time_s;
                } else if !error.is_of_a_row() {
                    assert!(matches!(reader.next_row(), Ok(None)), "goes on after {text}");
                    break;
                }
            }
        }
    }
    assert!(reader.bytes_read() <= most_bytes as u64);
    assert!(reader.news().iter().all(|(_, sentence)| !sentence.is_empty()));
    assert!(reader.remarks().iter().all(|remark| !remark.is_empty()));
    rows > 0
}

/// Mappings that are used if the DBC file has the signal.
const MAPS: [&str; 4] = [
    "roll=M.S[deg]*-1+0.3",
    "tilt=SSI2.RollAngle",
    "steering_wheel=VDC2.SteeringWheelAngle",
    "speed=CCVS1.WheelBasedVehicleSpeed*0.5-1e3",
];

/// The mappings whose signals the DBC file has.
fn mapped(dbc: &[u8]) -> Vec<MappedSignal> {
    let text = String::from_utf8_lossy(dbc);
    let mut mapped = Vec::new();
    for map in MAPS {
        let map: SignalMap = map.parse().expect("a mapping");
        match MappedSignal::parse("x.dbc", &text, &[map]) {
            Ok(found) => mapped.extend(found),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    mapped
}

/// A DBC file and a candump log, with a zero byte between them.
pub fn candump(data: &[u8]) -> bool {
    let (dbc, log) = two_parts(data);
    let text = String::from_utf8_lossy(log);
    let mut samples = 0;
    let plain = Sampler::new(Decoder::default(), AlignSettings::NONE);
    samples += sampled(plain, &text, false);
    let mapped = mapped(dbc);
    if !mapped.is_empty() {
        let decoder = Decoder::new(mapped, Vec::new(), Vec::new());
        samples += sampled(Sampler::new(decoder, TRUCK.align_settings()), &text, true);
    }
    samples > 0
}

/// The number of samples from the frames of a log, in live operation or not.
fn sampled(mut sampler: Sampler, log: &str, live: bool) -> u32 {
    let mut samples = 0;
    let mut last_us = 0;
    let mut check = |sample: Sample<f64>| {
        assert!(sample.time_us > last_us, "{last_us} us, then {sample:?}");
        last_us = sample.time_us;
        assert!(all_finite_or_absent(&sample), "{sample:?}");
        samples += 1;
    };
    let mut monotonic_us = 0;
    for line in log.lines() {
        let content = match parse(line) {
            Ok(Some(line)) => line.content,
            Ok(None) => continue,
            Err(error) => {
                assert!(!error.to_string().is_empty());
                continue;
            }
        };
        let Content::Data(frame) = content else { continue };
        monotonic_us += 5_000;
        sampler.push(&frame, live.then_some(monotonic_us), |_| {});
        while let Some(sample) = sampler.next_sample() {
            check(sample);
        }
        sampler.news();
    }
    while let Some(sample) = sampler.rest() {
        check(sample);
    }
    sampler.remarks();
    samples
}

fn all_finite_or_absent(sample: &Sample<f64>) -> bool {
    [
        sample.steer_rad,
        sample.roll_rad,
        sample.tilt_rad,
        sample.speed_mps,
        sample.lateral_acceleration_mps2,
        sample.yaw_rate_radps,
        sample.trailer_mass_kg,
    ]
    .into_iter()
    .all(finite_or_absent)
}

/// A DBC file and the payload of frames, with a zero byte between them.
pub fn dbc(data: &[u8]) -> bool {
    let (dbc, payload) = two_parts(data);
    let mapped = mapped(dbc);
    let found = !mapped.is_empty();
    let decoder = Decoder::new(mapped, Vec::new(), Vec::new());
    for (identifier, extended, _) in decoder.frames() {
        for length in [0, 1, 7, 8, 64] {
            let bytes = &payload[..payload.len().min(length)];
            if let Some(frame) = Frame::new(0, identifier, extended, bytes) {
                decoder.decode(&frame, |_, _, _| {});
            }
        }
    }
    found
}

/// A vehicle file: an accepted file gives a design, or an error with the reason.
pub fn vehicle_file(data: &[u8]) -> bool {
    let text = String::from_utf8_lossy(data);
    let vehicle = match Vehicle::check(&text, "v.toml") {
        Ok((vehicle, findings)) => {
            assert!(findings.iter().all(|finding| finding.in_file("v.toml").len() > 10));
            vehicle
        }
        Err(error) => {
            assert!(error.to_string().contains("v.toml"), "{error}");
            return false;
        }
    };
    let settings = vehicle.align_settings();
    let kg = settings.trailer_mass_kg(|quantity| match quantity {
        Quantity::TrailerAxleLoad => 1e4,
        Quantity::TrailerSuspensionPressure => 2e5,
        _ => f64::NAN,
    });
    assert!(finite_or_absent(kg), "{settings:?}");
    if is_chosen(data) {
        let variant =
            if vehicle.as_printed.is_some() { Variant::AsPrinted } else { Variant::Complete };
        match design(&vehicle, variant) {
            Ok(design) => {
                drive::hundred_samples(Estimator::new(
                    design,
                    Settings::truck(),
                    Prior::standard(),
                ));
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    true
}

/// A calibration of the fixture's truck; the first byte selects whether its checksum is corrected.
pub fn calibration_file(data: &[u8]) -> bool {
    let (choice, rest) = choices(data);
    let mut text = String::from_utf8_lossy(rest).into_owned();
    if choice & 1 == 1 {
        // The checksum of a file is that of its text with line feeds, without empty lines at its end.
        let content = text.trim_ascii_end().replace("\r\n", "\n");
        text = format!("{content}\n# crc32 {:08x}\n", crc32fast::hash(content.as_bytes()));
    }
    match Calibration::parse(&text, "c.toml", &TRUCK) {
        Ok(calibration) => {
            let belief = calibration.belief();
            assert!(belief.mean.iter().all(|mean| mean.is_finite()));
            if is_chosen(data)
                && let Err(error) = design_with(&TRUCK, calibration.model, &belief)
            {
                assert!(!error.to_string().is_empty());
            }
            true
        }
        Err(error) => {
            assert!(error.to_string().contains("c.toml"), "{error}");
            false
        }
    }
}

/// A state of the fixture's truck; the first byte selects whether its checksums are corrected.
pub fn state_file(data: &[u8]) -> bool {
    let (choice, rest) = choices(data);
    let crc32 = design_crc32(&DESIGN);
    let mut bytes = rest.to_vec();
    if choice & 1 == 1 {
        let line = rest.split(|&byte| byte == b'\n').next().unwrap_or_default();
        let json = with_design(&String::from_utf8_lossy(line), crc32);
        bytes = format!("{json}\ncrc32 {:08x}\n", crc32fast::hash(json.as_bytes())).into_bytes();
    }
    let own = Owner::of(&TRUCK, None, &DESIGN).expect("a fixture");
    match State::parse(&bytes, &own) {
        Ok(state) => {
            let (settings, prior) = (Settings::truck(), Prior::standard());
            let estimator: Option<Estimator<f64, FilteredArx<f64>>> =
                Estimator::restored(*DESIGN, settings, prior, &state.memory((0, None)));
            drive::hundred_samples(estimator.expect("what is accepted is sound"));
            true
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            false
        }
    }
}

/// A state's JSON with the number after `"design_crc32":` replaced.
fn with_design(json: &str, crc32: u32) -> String {
    const KEY: &str = "\"design_crc32\":";
    match json.split_once(KEY) {
        Some((before, after)) => {
            let rest = after.trim_start_matches(|c: char| c.is_ascii_digit());
            format!("{before}{KEY}{crc32}{rest}")
        }
        None => json.to_owned(),
    }
}

/// Samples from the byte code of [`drive`], for an estimator in double and one in single precision.
pub fn estimator_push(data: &[u8]) -> bool {
    let double = drive::drive::<f64>(data, &DESIGN);
    let single = drive::drive::<f32>(data, &DESIGN.cast());
    double && single
}
