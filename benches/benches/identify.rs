//! Time per row of the identifiers and of the whole pipeline. The named peer is nalgebra's batch QR
//! of the same regression (order 5, 5).
#![allow(
    missing_docs,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    clippy::unwrap_used
)]

use cg_core::{Arx, Estimator, FilteredArx, Identify, Prior, Real, Reduced5, Sample, Settings};
use cg_vehicle::Variant;
use cg_vehicle::design::design;
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use nalgebra::{DMatrix, DVector};

const ROWS: usize = 4000;

fn main() {
    divan::main();
}

/// Steer and roll from the middle of the drive.
fn signals() -> Vec<(f64, f64)> {
    let rows = cg_bench::drive();
    rows.iter().skip(2000).take(ROWS).map(|row| (row.steer_rad, row.roll_rad)).collect()
}

fn model<T: Real>() -> Reduced5<T> {
    design(&cg_bench::kraz(), Variant::Complete).unwrap().cast::<T>().channels[0].models[0]
}

#[divan::bench(types = [f32, f64])]
fn filtered_arx_row<T: Real>(bencher: Bencher) {
    let data: Vec<(T, T)> = signals().iter().map(|(u, y)| (T::of(*u), T::of(*y))).collect();
    let model = model::<T>();
    let interval_s = T::of(0.02);
    bencher.counter(ItemsCount::new(ROWS)).bench(|| {
        let mut identifier = <FilteredArx<_>>::for_model(&model, Prior::standard());
        for (u, y) in black_box(&data) {
            identifier.push(*u, *y, interval_s, true);
        }
        identifier
    });
}

#[divan::bench(types = [f32, f64])]
fn shift_form_arx_5_5_row<T: Real>(bencher: Bencher) {
    let data: Vec<(T, T)> = signals().iter().map(|(u, y)| (T::of(*u), T::of(*y))).collect();
    bencher.counter(ItemsCount::new(ROWS)).bench(|| {
        let mut arx = Arx::<T, 10>::new(5, 5, 1).unwrap();
        for (u, y) in black_box(&data) {
            arx.push(*u, *y, true);
        }
        arx
    });
}

/// Peer: builds the regressor matrix, QR, solves.
#[divan::bench]
fn nalgebra_qr_5_5_row(bencher: Bencher) {
    let data = signals();
    bencher.counter(ItemsCount::new(ROWS)).bench(|| {
        let data = black_box(&data);
        let phi = DMatrix::from_fn(ROWS - 5, 10, |i, j| {
            if j < 5 { -data[i + 4 - j].1 } else { data[i + 9 - j].0 }
        });
        let y = DVector::from_fn(ROWS - 5, |i, _| data[i + 5].1);
        let qr = phi.qr();
        qr.r().solve_upper_triangular(&(qr.q().transpose() * y))
    });
}

/// Both channels: condition, identify, close and check maneuvers, fuse.
#[divan::bench(types = [f32, f64])]
fn estimator_push<T: Real>(bencher: Bencher) {
    let design = design(&cg_bench::kraz(), Variant::Complete).unwrap().cast::<T>();
    let samples: Vec<Sample<T>> = cg_bench::drive()
        .iter()
        .take(ROWS)
        .map(|row| Sample {
            steer_rad: T::of(row.steer_rad),
            roll_rad: T::of(row.roll_rad),
            speed_mps: T::of(row.speed_mps),
            lateral_acceleration_mps2: T::of(row.lateral_acceleration_mps2),
            yaw_rate_radps: T::of(row.yaw_rate_radps),
            trailer_mass_kg: T::of(row.trailer_mass_kg),
            ..Sample::absent((row.time_s * 1e6).round().max(0.0) as u64)
        })
        .collect();
    bencher.counter(ItemsCount::new(ROWS)).bench(|| {
        let mut estimator =
            Estimator::<T, FilteredArx<T>>::new(design, Settings::truck(), Prior::standard());
        for sample in black_box(&samples) {
            let _ = black_box(estimator.push(sample));
        }
        estimator
    });
}

/// The reduced model's step matrices, computed once per new sampling interval.
#[divan::bench(types = [f32, f64])]
fn discretise<T: Real>(bencher: Bencher) {
    let model: Reduced5<T> = model();
    bencher.bench(|| cg_core::truck::filters::StepMatrices::new(black_box(&model), T::of(0.02)));
}
