//! What is said of a calibration in tight turns.

/// Relative standard deviation of a ratio by articulation from which on the statement says so.
const TOLD: f64 = 0.0125;

/// What the statement says of turns whose articulation makes a ratio uncertain by this.
pub(super) fn told(articulated_sd: f64) -> Option<String> {
    (articulated_sd > TOLD).then(|| {
        "the turns were so tight that the trailer stood far from the direction of the tractor: the run counts for less; \
         calibrate in wider turns"
            .to_owned()
    })
}
