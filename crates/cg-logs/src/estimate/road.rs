//! How much of the uncertainty of a height the bank of the road makes.

use cg_core::{CHANNELS, Channel, Height, Maneuver};

use super::options::RoadChoice;

/// Share of the variance above which the bank of the road is reported.
const MUCH: f64 = 0.25;
/// Number of turns from which a log without a road counts as a drive on public ones. A test has one to three.
const DRIVE_TURNS: u32 = 4;
/// The sensors that would help.
const REMEDY: &str = "a suspension roll with a specific force (level sensors and an accelerometer, or inclinometers on \
                      frame and axle) does not feel it; if the road was flat: ⟨road flat⟩";

/// What the bank of the road does to the heights of a load.
#[derive(Clone, Copy, Debug)]
pub struct RoadPart {
    /// The least standard deviation of the height of a maneuver due to the bank in each channel, m.
    least_m: [f64; CHANNELS],
    /// Whether a roll angle was relative to gravity.
    to_gravity: bool,
    /// Whether the bank is part of any uncertainty, as that of a roll angle beside sensors that do not feel it.
    has_bank: bool,
}

impl Default for RoadPart {
    fn default() -> Self {
        Self { least_m: [f64::INFINITY; CHANNELS], to_gravity: false, has_bank: false }
    }
}

impl RoadPart {
    /// That of these maneuvers.
    pub fn of<'a>(maneuvers: impl IntoIterator<Item = &'a Maneuver<f64>>) -> Self {
        let mut part = Self::default();
        maneuvers.into_iter().for_each(|maneuver| part.push(maneuver));
        part
    }

    /// Adds a maneuver.
    pub fn push(&mut self, maneuver: &Maneuver<f64>) {
        self.to_gravity |= maneuver.to_gravity;
        for (least_m, outcome) in self.least_m.iter_mut().zip(&maneuver.outcomes) {
            self.has_bank |= outcome.road_sd_m > 0.0;
            if outcome.height_m.is_ok() {
                *least_m = least_m.min(outcome.road_sd_m);
            }
        }
    }

    /// Whether the bank of the road is unknown and changes a roll angle.
    pub fn is_unknown(&self, road: Option<RoadChoice>) -> bool {
        let known = road.is_some_and(|road| road.bank_sd_rad <= 0.0);
        !known && (road.is_some() || self.to_gravity || self.has_bank)
    }

    /// That roads count as flat because nothing else was said, in a drive with this number of turns. The bank that all
    /// curves have in common hides in their ratio; only differences are seen.
    pub fn assumed_flat(road: Option<RoadChoice>, turns: u32) -> Option<String> {
        let is_assumed = road.is_none() && turns >= DRIVE_TURNS;
        is_assumed.then(|| {
            "nothing says on which roads this was, so they count as flat, as on a test track: curves that all lean to \
             their inside by 1 % would make the height about 5 % too low; if they were flat: ⟨road flat⟩, if not: \
             ⟨road public⟩"
                .to_owned()
        })
    }

    /// The share of the bank in the variance of a height by this channel.
    pub fn share(&self, channel: Channel, height: &Height<f64>) -> f64 {
        let road_m = self.least_m[channel.index()];
        if !channel.feels_bank() || !road_m.is_finite() {
            return 0.0;
        }
        let share = (road_m / height.height_m.sd).min(1.0);
        share * share
    }

    /// What is said of a result whose height has this share, `None` for a result without a height.
    pub fn message(share: Option<f64>) -> Option<String> {
        match share {
            None => Some(format!(
                "the bank of the road is not known and changes the roll angle; {REMEDY}"
            )),
            Some(share) => (share > MUCH).then(|| {
                format!(
                    "the bank of the road is not known: it makes up {:.0} % of the variance of the height; \
                     {REMEDY}",
                    100.0 * share
                )
            }),
        }
    }
}
