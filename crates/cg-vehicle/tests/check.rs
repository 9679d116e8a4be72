//! The check of vehicle files.

#[path = "check/fixtures.rs"]
mod fixtures;

const NAMES: [&str; 6] =
    ["air", "baseline", "baseline-tables", "kraz", "worn-tyres-half", "worn-tyres-third"];

fn path(name: &str) -> String {
    format!("{}/../../fixtures/vehicles/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}
