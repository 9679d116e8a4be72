//! Flags in the messages of the libraries, which contain neutral names of options.

use cg_vehicle::hint;

/// A message of a library with its options written as flags.
pub(crate) fn with_flags(message: &str) -> String {
    hint::told(message, |name, value| {
        let flag = flag(name);
        // A value with characters that a shell interprets is quoted.
        match value.contains(|c: char| !c.is_alphanumeric() && !"_=[].*+-".contains(c)) {
            _ if value.is_empty() => flag,
            false => format!("{flag} {value}"),
            true => format!("{flag} '{value}'"),
        }
    })
}

fn flag(name: &str) -> String {
    match name {
        "columns" => "--column".to_owned(),
        "signals" => "--signal".to_owned(),
        "turn_rad" => "--turn-deg".to_owned(),
        "step_rate_per_s" => "--step-rate".to_owned(),
        _ => format!("--{}", name.replace('_', "-")),
    }
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use clap::CommandFactory;

    use super::*;

    #[test]
    fn options_are_flags_and_foreign_names_are_quoted() {
        let message =
            "⟨flip roll⟩, ⟨force⟩, ⟨columns roll=Gyro X[deg]⟩, ⟨turn_rad⟩ or ⟨columns a=b[s]⟩";
        let expected =
            "--flip roll, --force, --column 'roll=Gyro X[deg]', --turn-deg or --column a=b[s]";
        assert_eq!(with_flags(message), expected);
        assert_eq!(with_flags("no option ⟨ here"), "no option ⟨ here");
    }

    /// The Rust files of a folder. (The text of docs/vehicle.md lies among them and names commands.)
    fn sources(folder: &Path) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let files =
            entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] });
        files.filter(|path| path.extension().is_some_and(|kind| kind == "rs")).collect()
    }

    /// Every option in a message of a library is a flag of some command, and no library contains a
    /// flag.
    #[test]
    fn every_option_that_a_library_names_is_a_flag() {
        let command = crate::cli::Cli::command();
        let flags: Vec<String> = command
            .get_subcommands()
            .flat_map(clap::Command::get_arguments)
            .chain(command.get_arguments())
            .filter_map(|argument| Some(format!("--{}", argument.get_long()?)))
            .collect();
        let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let mut seen = 0;
        for library in ["cg-core", "cg-vehicle", "cg-logs", "cg-plant", "cg-thesis"] {
            for path in sources(&crates.join(library).join("src")) {
                let text = std::fs::read_to_string(&path).unwrap();
                let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
                for line in lines {
                    let at = path.display();
                    for option in line.split('⟨').skip(1) {
                        let end = option.find(|c: char| {
                            c != '_' && !c.is_ascii_lowercase() && !c.is_ascii_digit()
                        });
                        let name = &option[..end.unwrap_or(option.len())];
                        if !name.is_empty() {
                            assert!(flags.contains(&flag(name)), "{at}: {name} of {line}");
                            seen += 1;
                        }
                    }
                    let named = line.split("--").skip(1);
                    let is_flag = |rest: &str| rest.starts_with(|c: char| c.is_ascii_lowercase());
                    assert!(!named.into_iter().any(is_flag), "{at}: a flag in {line}");
                }
            }
        }
        assert!(seen > 30, "only {seen} options were seen");
    }
}
