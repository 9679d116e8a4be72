use crate::common::{Scratch, cg, fixture, kraz};

#[test]
fn a_parquet_log_names_the_feature_that_reads_it() {
    let scratch = Scratch::new();
    let log = scratch.file("drive.parquet", "PAR1");
    cg(&["estimate", &log, "--vehicle", &kraz()]).refused(&["drive.parquet", "feature `parquet`"]);
}

#[test]
fn a_dbc_file_names_the_feature_that_reads_it() {
    let dbc = fixture("can/j1939.dbc");
    let signal = ["--dbc", &dbc, "--signal", "roll=SSI2.RollAngle"];
    cg(&[&["estimate", "-", "--vehicle", &kraz()], &signal[..]].concat())
        .refused(&["j1939.dbc", "feature `dbc`"]);
}

#[test]
fn a_study_names_the_feature_that_draws_it() {
    cg(&["study", "height", "--output", "nowhere"]).refused(&["feature `plots`"]);
    assert!(!std::path::Path::new("nowhere").exists());
}
