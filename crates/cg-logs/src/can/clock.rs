//! Computes a continuous time from time stamps.
//!
//! The estimator needs a time that only increases. Time stamps of frames are wall-clock time, which
//! is set now and then: by a time server, by a GPS receiver, or at the first start, when it is
//! years off. In live operation, the monotonic clock distinguishes a jump from a pause. In a log, a
//! time that decreases is a jump.

/// Start of the stream time. It is not zero, so that times before the first frame can be
/// represented.
const ORIGIN_US: u64 = 1_000_000;
/// Difference between wall clock and monotonic clock that counts as a jump and not as a delay.
const JUMP_US: u64 = 500_000;
/// Duration that replaces a jump in a log. It is long enough to end a maneuver.
const UNKNOWN_US: u64 = 1_000_000;

/// Computes stream time from time stamps.
#[derive(Clone, Debug, Default)]
pub struct Clock {
    last: Option<Last>,
}

#[derive(Clone, Debug)]
#[allow(clippy::struct_field_names, reason = "units stand in names")]
struct Last {
    raw_us: u64,
    stream_us: u64,
    monotonic_us: Option<u64>,
}

/// A stream time, and the jump of the wall clock before it, µs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instant {
    /// Stream time, µs.
    pub stream_us: u64,
    /// The jump of the wall clock, µs; 0 for none.
    pub jump_us: i64,
}

impl Clock {
    /// Stream time of a time stamp. `monotonic_us` is the monotonic clock at about the same time,
    /// if there is one.
    pub fn stream(&mut self, raw_us: u64, monotonic_us: Option<u64>) -> Instant {
        let Some(last) = &mut self.last else {
            self.last = Some(Last { raw_us, stream_us: ORIGIN_US, monotonic_us });
            return Instant { stream_us: ORIGIN_US, jump_us: 0 };
        };
        let passed_us = i64::try_from(i128::from(raw_us) - i128::from(last.raw_us));
        let true_us = monotonic_us
            .zip(last.monotonic_us)
            .and_then(|(now, then)| i64::try_from(now.saturating_sub(then)).ok());
        let (step_us, jump_us) = match (passed_us, true_us) {
            (Ok(passed), Some(truth)) if passed.abs_diff(truth) > JUMP_US => {
                (truth.unsigned_abs(), passed.saturating_sub(truth))
            }
            // Frames from two queues may be slightly out of order.
            (Ok(passed), None) if passed < 0 && passed.unsigned_abs() > JUMP_US => {
                (UNKNOWN_US, passed)
            }
            (Ok(passed), _) => (u64::try_from(passed).unwrap_or(0), 0),
            (Err(_), _) => (UNKNOWN_US, 0),
        };
        if step_us == 0 && jump_us == 0 {
            // A time stamp that is not later than the previous one gets the same stream time.
            return Instant { stream_us: last.stream_us, jump_us };
        }
        *last = Last { raw_us, stream_us: last.stream_us.saturating_add(step_us), monotonic_us };
        Instant { stream_us: last.stream_us, jump_us }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(stamps: &[(u64, Option<u64>)]) -> Vec<(u64, i64)> {
        let mut clock = Clock::default();
        let instants = stamps.iter().map(|&(raw, monotonic)| clock.stream(raw, monotonic));
        instants.map(|i| (i.stream_us - ORIGIN_US, i.jump_us)).collect()
    }

    #[test]
    fn a_wall_clock_that_is_set_does_not_move_the_stream() {
        let hour = 3_600_000_000;
        let stamps = [(hour, Some(0)), (hour + 100, Some(90)), (9, Some(200)), (19, Some(210))];
        let back = -(i64::try_from(hour).unwrap() + 100 - 9) - 110;
        assert_eq!(steps(&stamps), [(0, 0), (100, 0), (210, back), (220, 0)]);
        let forward = [(0, Some(0)), (hour, Some(100))];
        assert_eq!(steps(&forward), [(0, 0), (100, 3_599_999_900)]);
    }

    /// Time stamps of a faulty device, 2^63 µs apart, which is the largest possible jump.
    #[test]
    fn no_jump_is_too_far() {
        let stamps = [(1 << 63, Some(0)), (0, Some(100))];
        assert_eq!(steps(&stamps)[1], (100, i64::MIN));
    }

    #[test]
    fn half_a_second_off_is_a_jump_and_less_a_late_frame() {
        assert_eq!(steps(&[(0, Some(0)), (600_000, Some(50_000))])[1], (50_000, 550_000));
        assert_eq!(steps(&[(0, Some(0)), (400_000, Some(50_000))])[1], (400_000, 0));
    }

    #[test]
    fn a_pause_is_no_jump() {
        assert_eq!(steps(&[(0, Some(0)), (70_000_000, Some(70_000_100))])[1], (70_000_000, 0));
        assert_eq!(steps(&[(0, None), (70_000_000, None)])[1], (70_000_000, 0));
    }

    #[test]
    fn a_log_that_goes_back_goes_on() {
        let stamps = [(5_000_000, None), (4_999_990, None), (5_000_010, None), (1_000, None)];
        let back = 1_000 - 5_000_010;
        assert_eq!(steps(&stamps), [(0, 0), (0, 0), (10, 0), (1_000_010, back)]);
    }
}
