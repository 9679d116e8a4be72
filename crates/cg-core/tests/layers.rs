//! Arrows point one way: a crate uses only those before it, a module only those above it in `lib.rs`.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests")]

use std::path::{Path, PathBuf};

/// The libraries in the order of ARCHITECTURE.md.
const CRATES: [&str; 5] = ["cg-core", "cg-vehicle", "cg-logs", "cg-plant", "cg-thesis"];
/// Those whose modules are in flow order too.
const IN_ORDER: [&str; 3] = ["cg-core", "cg-plant", "cg-thesis"];

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join(name)
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// All source files below a path.
fn sources(path: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(path) else { return vec![path.to_owned()] };
    let mut found: Vec<PathBuf> =
        entries.flat_map(|entry| sources(&entry.unwrap().path())).collect();
    found.retain(|path| path.extension().is_some_and(|end| end == "rs"));
    found
}

/// Names that follow `prefix` in the code of a file, its comments and tests left out.
fn named(path: &Path, prefix: &str) -> Vec<String> {
    let text = read(path);
    let code = text.split("#[cfg(test)]\nmod ").next().unwrap();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let code: Vec<&str> = lines.collect();
    let code = code.join("\n");
    let name = |rest: &str| {
        let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        rest[..end].to_owned()
    };
    code.split(prefix).skip(1).map(name).collect()
}

#[test]
fn a_crate_uses_those_before_it() {
    let mut arrows = 0;
    for (place, name) in CRATES.iter().enumerate() {
        let manifest = read(&folder(name).join("Cargo.toml"));
        let dependencies = manifest.split("[dependencies]").nth(1).unwrap();
        let dependencies = dependencies.split("\n[").next().unwrap();
        for used in dependencies.lines().filter(|line| line.starts_with("cg-")) {
            let used = used.split(['.', ' ']).next().unwrap();
            let before = CRATES.iter().position(|other| *other == used);
            assert!(before.is_some_and(|before| before < place), "{name} uses {used}");
            arrows += 1;
        }
    }
    assert!(arrows >= 8, "only {arrows} arrows between crates were seen");
}

#[test]
fn a_module_uses_those_above_it() {
    for name in IN_ORDER {
        let src = folder(name).join("src");
        let lib = read(&src.join("lib.rs"));
        let module = |line: &str| {
            let line = line.strip_prefix("pub ").unwrap_or(line);
            Some(line.strip_prefix("mod ")?.strip_suffix(';')?.to_owned())
        };
        let modules: Vec<String> = lib.lines().filter_map(module).collect();
        assert!(modules.len() >= 3, "lib.rs of {name} lists {modules:?}");
        let mut arrows = 0;
        for (place, module) in modules.iter().enumerate() {
            let one = src.join(format!("{module}.rs"));
            let files = if one.exists() { vec![one] } else { sources(&src.join(module)) };
            assert!(!files.is_empty(), "{name}: no file of {module}");
            for used in files.iter().flat_map(|file| named(file, "crate::")) {
                let Some(above) = modules.iter().position(|other| *other == used) else { continue };
                assert!(above <= place, "{name}: {module} uses {used}");
                arrows += 1;
            }
        }
        assert!(arrows > 0, "{name}: no arrow was seen");
    }
}
