//! Kinds of output files. Each kind begins in a unique way, by which cg recognizes its own files.

use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use flate2::read::GzDecoder;
use serde_json::Value;

/// Number of bytes of a file that are inspected. The truth of a log and a state are shorter.
const HEAD: u64 = 1 << 20;
/// Beginning of a state file.
pub const STATE_HEAD: &str = "{\"format\":\"cg-height state\"";
/// The comment in a log that is not simulated.
pub const LOG_COMMENT: &str = "cg-height log";
/// The comment in the table and the figure of a study.
pub const STUDY_COMMENT: &str = "cg study";

/// The attribute in the model description of an FMU.
pub const FMU_TOOL: &str = "generationTool=\"cg-height ";

/// A kind of output file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// A log: CSV, also compressed with gzip.
    Log,
    /// CAN frames in any format. They cannot be distinguished from recorded ones, so they are never taken for an output that may be
    /// replaced.
    Frames,
    /// The truth of a simulated log.
    Truth,
    /// A vehicle file. People edit it, so it is never taken for an output that may be replaced.
    Vehicle,
    /// A calibration.
    Calibration,
    /// A design for firmware.
    Design,
    /// The report page of `cg estimate`.
    Report,
    /// The table of a study.
    Table,
    /// The figure of a study.
    Figure,
    /// The state that `cg run` keeps over a restart.
    State,
    /// The metrics of `cg run`.
    Metrics,
    /// A functional mock-up unit.
    Fmu,
}

impl fmt::Display for Kind {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Log => "log",
            Self::Frames => "CAN log",
            Self::Truth => "truth file of a simulated log",
            Self::Vehicle => "vehicle file",
            Self::Calibration => "calibration",
            Self::Design => "design",
            Self::Report => "report",
            Self::Table => "table of a study",
            Self::Figure => "figure of a study",
            Self::State => "state file",
            Self::Metrics => "metrics file",
            Self::Fmu => "FMU",
        })
    }
}

impl Kind {
    /// Whether the file is an output of this kind. A file that cannot be read is not.
    pub(crate) fn is_ours(self, path: &Path) -> bool {
        head(path).is_ok_and(|head| self.is_head_of_ours(&head))
    }

    fn is_head_of_ours(self, head: &[u8]) -> bool {
        let starts = |with: &str| head.starts_with(with.as_bytes());
        match self {
            Self::Log => {
                (starts("# truth ") && holds(head, "\n# truth noise_sd_rad = "))
                    || starts(&format!("# {LOG_COMMENT}\n"))
            }
            Self::Frames | Self::Vehicle => false,
            Self::Truth => serde_json::from_slice(head).is_ok_and(|truth: Value| {
                ["height_m", "noise_sd_rad", "seed"].iter().all(|key| truth.get(key).is_some())
            }),
            Self::Calibration => starts("# Calibration of the vehicle \""),
            Self::Design => {
                starts("// Design of the vehicle \"")
                    || starts("{\n    \"comment\": \"Design of the vehicle ")
            }
            Self::Report => holds(head, "<meta name=\"generator\" content=\"cg estimate\">"),
            Self::Table => starts(&format!("# {STUDY_COMMENT} ")),
            Self::Figure => starts("<svg ") && holds(head, &format!("<!-- {STUDY_COMMENT} ")),
            Self::State => looks_like_a_state(head),
            Self::Metrics => starts("# HELP cg_"),
            // The model description comes first and is not compressed.
            Self::Fmu => starts("PK\x03\x04") && holds(head, FMU_TOOL),
        }
    }
}

/// Whether this is a state file or its remains. After a power failure or a disk error, the file may
/// be truncated or contain zeros.
fn looks_like_a_state(bytes: &[u8]) -> bool {
    bytes.iter().all(|byte| *byte == 0)
        || STATE_HEAD.as_bytes().starts_with(bytes)
        || [STATE_HEAD, "\"design_crc32\":", "\"load_since_s\":", "\ncrc32 "]
            .iter()
            .any(|part| holds(bytes, part))
}

fn holds(text: &[u8], part: &str) -> bool {
    memchr::memmem::find(text, part.as_bytes()).is_some()
}

/// Reads the inspected bytes of a file.
///
/// # Errors
/// The error of the system if they cannot be read.
pub(crate) fn try_reading(path: &Path) -> io::Result<()> {
    io::copy(&mut File::open(path)?.take(HEAD), &mut io::sink()).map(|_| ())
}

/// The first bytes of a file, decompressed.
fn head(path: &Path) -> io::Result<Vec<u8>> {
    let mut file = BufReader::new(File::open(path)?);
    let mut head = Vec::new();
    if file.fill_buf()?.starts_with(&[0x1f, 0x8b]) {
        GzDecoder::new(file).take(HEAD).read_to_end(&mut head)?;
    } else {
        file.take(HEAD).read_to_end(&mut head)?;
    }
    Ok(head)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damaged_state_is_still_ours_and_another_file_is_not() {
        let state = format!(
            "{STATE_HEAD},\"version\":1,\"design_crc32\":1,\"saved_s\":0.0,\"load_since_s\":null}}\ncrc32 00112233\n"
        );
        let ours = |bytes: &[u8]| Kind::State.is_head_of_ours(bytes);
        for length in 0..state.len() {
            assert!(ours(&state.as_bytes()[..length]), "{length} bytes");
            let mut zeros = state.clone().into_bytes();
            zeros[..length].fill(0);
            // The line with the checksum remains longest.
            assert!(ours(&zeros) || length > state.len() - 17, "{length} zeros");
        }
        for bit in 0..state.len() * 8 {
            let mut bad = state.clone().into_bytes();
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(ours(&bad), "bit {bit}");
        }
        for other in
            ["{}", "name = \"kraz\"\n", "time_s,steer_rad,roll_rad\n", "{\"format\":\"x\"}"]
        {
            assert!(!ours(other.as_bytes()), "{other}");
        }
    }

    #[test]
    fn a_recording_is_not_ours() {
        for recorded in [
            "(1436509052.249713) can0 18F0090B#7E7DFF007D807DFF\n",
            "(0000000000.000000) can0 18F0090B#7E7DFF007D807DFF\n",
            "(0.000000) can0 18F0090B#7E7DFF007D807DFF\n", // as converters write it
            "time_s,steer_rad,roll_rad\n0,0,0\n",
            "# truth is out there\ntime_s,steer_rad,roll_rad\n",
        ] {
            assert!(!Kind::Log.is_head_of_ours(recorded.as_bytes()), "{recorded}");
        }
    }
}
