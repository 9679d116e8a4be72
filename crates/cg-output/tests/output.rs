//! Output files: they appear completely or not at all, and replace only what they may replace.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(clippy::panic, reason = "one test causes a panic")]

use std::fs;
use std::io::Write;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::panic::catch_unwind;
use std::path::Path;
use std::process::Command;

use cg_output::{Draft, Files, Kind, OutputError, Target};

const OURS: &str = "# HELP cg_height_metres height\n";

fn target(path: &Path) -> Result<Target, OutputError> {
    Files::new(false).writes("--metrics", path, Kind::Metrics)
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_panic_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cg.prom");
    let panicked = catch_unwind(|| {
        let (draft, mut file) = target(&path).unwrap().open().unwrap();
        file.write_all(b"half").unwrap();
        assert_eq!(names(path.parent().unwrap()).len(), 1);
        assert!(draft.is_none(), "there is a draft, and this assertion panics");
    });
    assert!(panicked.is_err());
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_file_that_came_in_the_meantime_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cg.prom");
    let draft = target(&path).unwrap().write(OURS).unwrap().unwrap();
    fs::write(&path, "precious").unwrap();
    let error = draft.publish().unwrap_err().to_string();
    assert!(
        error.contains("not a metrics file written by cg-height") && error.contains("--metrics"),
        "{error}"
    );
    assert_eq!(fs::read_to_string(&path).unwrap(), "precious");
    assert_eq!(names(folder.path()), ["cg.prom"]);
}

#[test]
fn files_that_belong_together_appear_both_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let (one, two) = (folder.path().join("one"), folder.path().join("two"));
    let drafts = || [&one, &two].map(|path| target(path).unwrap().write(OURS).unwrap().unwrap());
    let both = drafts();
    fs::write(&two, "precious").unwrap();
    Draft::publish_all(both).unwrap_err();
    assert_eq!(names(folder.path()), ["two"]);
    fs::remove_file(&two).unwrap();
    Draft::publish_all(drafts()).unwrap();
    assert_eq!(names(folder.path()), ["one", "two"]);
}

/// The draft is no more readable than the file that it replaces, also while it is being written.
#[test]
fn a_draft_is_as_secret_as_the_file_that_it_replaces() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cg.prom");
    for mode in [0o600, 0o640, 0o604, 0o666] {
        fs::write(&path, OURS).unwrap();
        fs::set_permissions(&path, PermissionsExt::from_mode(mode)).unwrap();
        let draft = target(&path).unwrap().write(OURS).unwrap().unwrap();
        for name in names(folder.path()) {
            let now = fs::metadata(folder.path().join(name)).unwrap().mode() & 0o777;
            assert_eq!(now & !mode, 0, "{now:o} for {mode:o}");
        }
        draft.publish().unwrap();
        assert_eq!(fs::metadata(&path).unwrap().mode() & 0o777, mode);
    }
}

#[test]
fn the_longest_name_that_a_file_can_have_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("é".repeat(127));
    target(&path).unwrap().write(OURS).unwrap().unwrap().publish().unwrap();
    assert_eq!(names(folder.path()).len(), 1);
}

/// A draft is kept if its lock is held or if its process is running.
#[cfg(target_os = "linux")] // it reads /proc
#[test]
fn only_drafts_of_processes_that_are_no_more_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cg.prom");
    let draft = |process: u32| folder.path().join(format!(".cg.prom.{process}-x1.part"));
    let mut child = Command::new("sleep").arg("60").spawn().unwrap();
    let (living, own) = (child.id(), std::process::id());
    fs::write(draft(living), "").unwrap();
    // A draft of a process with the same number in another container, or before the last restart.
    fs::write(draft(own), "").unwrap();
    let (ours, _file) = target(&path).unwrap().open().unwrap();
    let kept = names(folder.path());
    assert!(kept.len() == 2 && !draft(own).exists() && draft(living).exists(), "{kept:?}");
    // The own draft of this process is kept when the same file is requested again.
    target(&path).unwrap();
    assert_eq!(names(folder.path()), kept);
    child.kill().unwrap();
    // The process has ended, but its exit status has not been read.
    while !fs::read_to_string(format!("/proc/{living}/stat")).unwrap().contains(") Z ") {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let locked = fs::File::open(draft(living)).unwrap();
    locked.lock().unwrap();
    target(&path).unwrap();
    assert!(draft(living).exists(), "another process holds its lock");
    drop(locked);
    target(&path).unwrap();
    assert!(!draft(living).exists());
    child.wait().unwrap();
    drop(ours);
    assert!(names(folder.path()).is_empty());
}
