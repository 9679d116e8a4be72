//! A module of cg-core uses only the modules above it in `lib.rs`.

use std::path::Path;

#[test]
fn arrows_point_up() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let read = |name: &str| std::fs::read_to_string(src.join(name)).unwrap();
    let lib = read("lib.rs");
    let module = |line: &'static str| {
        line.strip_prefix("pub ").unwrap_or(line).strip_prefix("mod ")?.strip_suffix(';')
    };
    let modules: Vec<&str> = lib.leak().lines().filter_map(module).collect();
    assert!(modules.len() > 8, "lib.rs lists {modules:?}");
    for (place, module) in modules.iter().enumerate() {
        let text = read(&format!("{module}.rs"));
        for used in text.split("use crate::").skip(1) {
            let used = used.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap();
            let above = modules.iter().position(|m| *m == used);
            assert!(above.is_some_and(|above| above < place), "{module} uses {used}");
        }
    }
}
