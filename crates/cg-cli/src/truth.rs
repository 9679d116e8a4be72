//! Known heights of logs, which `--truth` names.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};
use cg_vehicle::files;
use serde::Deserialize;

/// Heights that a c.g. can have, m.
const POSSIBLE_M: [f64; 2] = [0.1, 10.0];

/// Known heights of some logs, or that of the only log.
pub(crate) enum Truth {
    /// Each belongs to the logs that are named so.
    Of(Vec<KnownHeight>),
    /// Of the only log.
    OfAll(f64),
}

/// What `cg simulate --truth` writes beside one log.
#[derive(Deserialize)]
struct Simulated {
    height_m: f64,
}

/// An entry of a list.
#[derive(Deserialize)]
pub(crate) struct KnownHeight {
    log: PathBuf,
    height_m: f64,
}

impl KnownHeight {
    /// Whether this names a log: with the same path, or one that ends as the other does.
    fn names(&self, log: &Path) -> bool {
        log.ends_with(&self.log) || self.log.ends_with(log)
    }
}

impl Truth {
    /// Reads the truth of these logs.
    pub(crate) fn load(path: &Path, logs: &[PathBuf]) -> anyhow::Result<Self> {
        let file = path.display();
        let text = files::read_text(path, files::TABLE_BYTES)
            .with_context(|| format!("{file}: cannot be read; check the path given to --truth"))?;
        let expected = || {
            format!(
                "{file}: expected a JSON list of objects with \"log\" and \"height_m\", or the file that \
                 cg simulate --truth writes"
            )
        };
        let truth = if text.trim_start().starts_with('{') {
            let Simulated { height_m } = serde_json::from_str(&text).with_context(expected)?;
            if logs.len() != 1 {
                bail!(
                    "{file}: is the truth of one simulated log, but {} logs are given; give a list of objects \
                     with \"log\" and \"height_m\"",
                    logs.len()
                );
            }
            Self::OfAll(height_m)
        } else {
            Self::Of(serde_json::from_str(&text).with_context(expected)?)
        };
        truth.check(logs).with_context(|| file.to_string())?;
        Ok(truth)
    }

    /// Checks that the heights are possible, that no log has two, and that one has any.
    fn check(&self, logs: &[PathBuf]) -> anyhow::Result<()> {
        let heights_m: Vec<f64> = match self {
            Self::Of(known) => known.iter().map(|one| one.height_m).collect(),
            Self::OfAll(height_m) => vec![*height_m],
        };
        let [least_m, greatest_m] = POSSIBLE_M;
        if let Some(wrong_m) = heights_m.iter().find(|m| !(least_m..=greatest_m).contains(*m)) {
            bail!("height_m {wrong_m} must lie between {least_m} and {greatest_m} m");
        }
        let mut is_any = false;
        for log in logs {
            is_any |= self.found(log)?.is_some();
        }
        if is_any || logs.is_empty() {
            return Ok(());
        }
        bail!(
            "none of its logs is one of those that are given; \"log\" is the name of a file, with or without folders"
        )
    }

    /// The known height of a log, m.
    pub(crate) fn height_m(&self, log: &Path) -> Option<f64> {
        self.found(log).ok().flatten()
    }

    /// That of the entry that names the most of the log's path.
    fn found(&self, log: &Path) -> anyhow::Result<Option<f64>> {
        let known = match self {
            Self::Of(known) => known,
            Self::OfAll(height_m) => return Ok(Some(*height_m)),
        };
        // The same path says more than one that goes on.
        let common = |one: &KnownHeight| {
            let shorter = one.log.components().count().min(log.components().count());
            (one.log == log, shorter)
        };
        let named = || known.iter().filter(|one| one.names(log));
        let Some(most) = named().map(common).max() else { return Ok(None) };
        let mut best = named().filter(|one| common(one) == most);
        let first = best.next();
        match (first, best.next()) {
            (Some(first), Some(second)) => Err(anyhow!(
                "{} and {} both name {}; keep one, or name them with their folders",
                first.log.display(),
                second.log.display(),
                log.display()
            )),
            _ => Ok(first.map(|first| first.height_m)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth(known: &[(&str, f64)]) -> Truth {
        let entry =
            |(log, height_m): &(&str, f64)| KnownHeight { log: log.into(), height_m: *height_m };
        Truth::Of(known.iter().map(entry).collect())
    }

    fn height_m(known: &[(&str, f64)], log: &str) -> Option<f64> {
        truth(known).height_m(Path::new(log))
    }

    #[test]
    fn a_path_says_more_than_a_name() {
        let known = [("y/log.csv", 1.33), ("x/log.csv", 1.9)];
        for known in [known, [known[1], known[0]]] {
            assert_eq!(height_m(&known, "x/log.csv"), Some(1.9));
            assert_eq!(height_m(&known, "runs/y/log.csv"), Some(1.33));
            assert_eq!(height_m(&known, "z/log.csv"), None);
        }
        assert_eq!(height_m(&[("log.csv", 1.5), ("x/log.csv", 1.9)], "x/log.csv"), Some(1.9));
        assert_eq!(height_m(&[("a/x/log.csv", 1.5), ("x/log.csv", 1.9)], "x/log.csv"), Some(1.9));
        assert_eq!(height_m(&[("log.csv", 1.5)], "x/log.csv"), Some(1.5));
        assert_eq!(height_m(&[("x/log.csv", 1.5)], "log.csv"), Some(1.5));
        assert_eq!(height_m(&[("a_log.csv", 1.5)], "log.csv"), None);
    }

    #[test]
    fn what_says_nothing_clear_is_refused() {
        let logs = [PathBuf::from("log.csv")];
        for (known, reason) in [
            (&[("log.csv", 1.9), ("log.csv", 1.3)][..], "both name log.csv"),
            (&[("x/log.csv", 1.9), ("y/log.csv", 1.3)], "both name log.csv"),
            (&[("other.csv", 1.9)], "none of its logs"),
            (&[("log.csv", -1.3)], "height_m -1.3 must lie between"),
            (&[("log.csv", 1300.0)], "height_m 1300 must lie between"),
        ] {
            let error = truth(known).check(&logs).unwrap_err().to_string();
            assert!(error.contains(reason), "{error}");
        }
        truth(&[("log.csv", 1.9), ("other.csv", 1.3)]).check(&logs).unwrap();
    }
}
