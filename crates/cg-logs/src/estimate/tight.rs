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

#[cfg(test)]
mod tests {
    use super::told;

    /// Less than what a model leaves of a calibrated ratio anyway is not told.
    #[test]
    fn only_what_matters_is_told() {
        assert_eq!(
            [0.0, 0.012, 0.013, 0.1].map(|sd| told(sd).is_some()),
            [false, false, true, true]
        );
    }
}
