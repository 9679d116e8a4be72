//! Estimation of the height from one log, for the command line and for Python.
//!
//! | file | what |
//! |---|---|
//! | `basis` | the calibration on which a height rests, and its age |
//! | `options` | options of the estimate |
//! | `known` | speed and trailer mass that replace those of the log: what they may be |
//! | `positions` | the truck with its lift axles down and raised |
//! | `engine` | the estimator with the chosen method |
//! | `answer` | the result for a log |
//! | `signals` | whether lateral acceleration, yaw rate and speed agree |
//! | `agreement` | whether they agree at present, and specific forces with them |
//! | `pair` | two signals compared |
//! | `rolls` | whether two roll sensors agree |
//! | `levels`, `pressures` | whether level sensors stand still, and pressures belong together |
//! | `values` | whether values are missing samples, or in steps as large as the signal |
//! | `near_zero` | whether a signal has a dead band |
//! | `range_end` | whether a signal is cut off at the end of a range |
//! | `frozen` | whether an input repeats one value while the truck rolls |
//! | `forces` | whether a specific force contains gravity |
//! | `sensors` | these checks together |
//! | `leaning` | whether the trailer leans in straight driving |
//! | `left_out` | maneuvers that contradict the height so far |
//! | `since_stop` | whether the load was another one after a stop |
//! | `tight` | what is said of a calibration in tight turns |
//! | `tilts` | what is not known of the gains of inclinometers |
//! | `rated` | the noise and the mounting of a roll rate whose integral is the roll angle |
//! | `windward`, `by_wind` | what a side wind makes of the ratios, and which part of an interval that is |
//! | `strong`, `strength`, `speed_change` | how near to rolling over the turns came, and how the speed changed in them |
//! | `weighed` | whether the mass is that of the present load |
//! | `recorder` | inputs and roll angles of a log, for the shapes of a calibration |
//! | `felt` | the lateral acceleration that the truck feels, a specific force from other sensors |
//! | `road` | how much of the uncertainty the bank of the road makes |
//! | `reason` | why a maneuver has no height |
//! | `unheard` | turns without a height, one after the other |
//! | `means` | means of neighboring samples |
//! | `row_sample`, `speed_age` | the sample of a row, and which signals a log has; rows whose last speed is too old |
//! | `intake` | processing of the rows |
//! | `closing`, `kept` | the end of a maneuver, and what is kept of it |
//! | `mass` | mass and speed in the turns of a log |
//! | `scatter` | whether curves contradict each other, as on a banked road |
//! | `diagnosis`, `messages`, `finish` | the end of a log: likely causes, messages, the result |
//! | `prediction` | the roll angle that the model predicts, next to the measured one |

mod basis;
mod options;
mod known;
mod answer;
mod positions;
mod engine;
mod entry;
mod pair;
mod signals;
mod agreement;
mod rolls;
mod levels;
mod pressures;
mod near_zero;
mod range_end;
mod values;
mod frozen;
mod forces;
mod sensors;
mod leaning;
mod left_out;
mod since_stop;
mod weighed;
mod recorder;
mod felt;
mod tight;
mod tilts;
mod rated;
mod by_wind;
mod windward;
mod speed_change;
mod strength;
mod strong;
mod road;
mod reason;
mod unheard;
mod means;
mod speed_age;
mod row_sample;
mod kept;
mod intake;
mod closing;
mod mass;
mod diagnosis;
mod scatter;
mod messages;
mod finish;
mod prediction;
#[cfg(test)]
mod trial;

pub use answer::{ChannelEstimate, LogEstimate, ManeuverEstimate, Verdict};
pub use basis::Basis;
pub(crate) use basis::date_s;
pub use by_wind::ByWind;
pub use engine::Engine;
pub use felt::{add_force, felt_mps2};
pub use intake::{Identified, LogEstimator};
pub use kept::Ended;
pub(crate) use known::mass_contradiction;
pub use known::{is_held, is_other_load, known_mass, known_speed, weighed_mass};
pub use leaning::{Leaning, threshold_g};
pub use left_out::{Doubt, LeftOut};
pub(crate) use options::EMPTY_SHARE;
pub use options::{
    ChannelChoice, EstimateOptions, Method, QUANTILE_95, RoadChoice, UnknownRoad, interval_95,
};
pub use positions::{Lift, Truck};
pub use prediction::Prediction;
pub use rated::Rated;
pub use road::RoadPart;
pub use sensors::SensorCheck;
pub use since_stop::SinceStop;
pub use speed_age::SpeedAge;
pub use strength::Strength;
pub use strong::StrongTurns;
pub use tilts::Tilts;
pub use unheard::Unheard;
pub use weighed::Weighed;
pub use windward::{Gust, Gusts, Windward};
