//! One log in, one answer out: the command line and Python both call this.
//!
//! | file | what |
//! |---|---|
//! | `options` | what to estimate with |
//! | `engine` | the estimator in the chosen method |
//! | `answer` | what a log's answer holds |
//! | `signals` | whether lateral acceleration, yaw rate and speed agree |
//! | `intake` | takes in samples |
//! | `diagnosis`, `messages`, `finish` | the end of a log: likely causes of a contradiction, words, the answer |
//! | `prediction` | the roll that the model expects, next to the measured one |

mod options;
mod answer;
mod engine;
mod signals;
mod intake;
mod diagnosis;
mod messages;
mod finish;
mod prediction;

pub use answer::{ChannelEstimate, LogEstimate, ManeuverEstimate, Verdict};
pub use intake::{Identified, LogEstimator};
pub use options::{ChannelChoice, EstimateOptions, Method, QUANTILE_95};
pub use prediction::Prediction;
