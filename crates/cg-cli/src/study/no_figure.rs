//! In place of `figure` in a build without the feature `plots`.

use cg_thesis::study::Study;

pub(super) fn svg(_: &Study) -> anyhow::Result<String> {
    Err(anyhow::anyhow!(super::LEFT_OUT))
}
