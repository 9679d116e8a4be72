//! A truck that learns itself from its empty trips; the study `in-service` has the whole year.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use cg_thesis::accuracy::Truck;
use cg_thesis::study::{Answer, InService, LadenTrip, in_service};

/// Root mean square error and number of misses after the third empty trip.
fn score(
    trips: &[Vec<LadenTrip>],
    answer: fn(&LadenTrip) -> Option<Answer>,
) -> (f64, usize, usize) {
    let known = trips.iter().flatten().filter(|trip| trip.empty_trips >= 3);
    let answers: Vec<Answer> = known.map(|trip| answer(trip).unwrap()).collect();
    #[allow(clippy::cast_precision_loss)] // dozens
    let mean = answers.iter().map(|one| one.error.powi(2)).sum::<f64>() / answers.len() as f64;
    let missed = answers.iter().filter(|one| !one.holds).count();
    (mean.sqrt(), missed, answers.len())
}

/// A year of a truck whose springs lose 15 %. What the empty trips leave open is how its roll centers
/// and the tractor's c.g. differ from the file, so this truck has those of the file.
#[test]
fn a_truck_that_wears_knows_itself_after_three_empty_trips() {
    let what = InService { trucks: 1, trips: 60, truck: Truck::OfTheFile };
    let year = in_service(&common::vehicle("kraz.toml"), what).unwrap();
    let (learned, missed, answers) = score(&year, |trip| trip.learned);
    let (file, ..) = score(&year, |trip| trip.unlearned);
    println!("rms {learned:.4}, with the file {file:.4}; {missed} of {answers} missed");
    assert!(learned <= 0.015 && file > 3.0 * learned);
    assert_eq!(missed, 0);
    let last = year[0].last().unwrap();
    assert!(last.empty_trips >= 3 && last.counted == last.empty_trips.min(12));
}
