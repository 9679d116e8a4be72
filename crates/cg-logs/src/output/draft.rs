//! A file that takes its name only when it is whole.
//!
//! It is written beside its place as `.NAME.PROCESS-RANDOM.part`. Dropped before it is published, in
//! a panic too, it removes itself; [`abandon`] removes all of them when the process is asked to end.
//! What a killed process left is removed by the next one that writes the same file.

use std::fs::{self, File, Metadata};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile};

use super::error::OutputError;
use super::place::folder;
use super::target::Target;

/// How a draft's name ends.
const END: &str = ".part";
/// As much of the file's name is in the draft's: four bytes each at most, of 255.
const NAME_CHARS: usize = 50;
/// Tries to make a draft that nobody takes for a leftover.
const TRIES: usize = 100;

/// The drafts of this process. Who holds it keeps others from being begun and published.
static DRAFTS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn drafts() -> MutexGuard<'static, Vec<PathBuf>> {
    // A list of paths has no state to be half-way in.
    DRAFTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// As long as it lives, no draft is begun or published.
pub struct Abandoned {
    _drafts: MutexGuard<'static, Vec<PathBuf>>,
}

/// Removes all drafts of this process, which is about to end.
pub fn abandon() -> Abandoned {
    let drafts = drafts();
    for draft in drafts.iter() {
        // Nobody is left to be told; the next run removes what stays.
        let _ = fs::remove_file(draft);
    }
    Abandoned { _drafts: drafts }
}

/// A file beside its place.
pub struct Draft {
    /// None once it is published.
    file: Option<NamedTempFile>,
    target: Target,
    resolved: PathBuf,
}

impl Draft {
    /// A draft for `resolved`, and the file to write to.
    pub(super) fn create(target: Target, resolved: PathBuf) -> io::Result<(Self, File)> {
        let before = fs::metadata(&resolved).ok();
        let mut drafts = drafts();
        let file = begin(&resolved, before.as_ref())?;
        let written = file.as_file().try_clone()?;
        drafts.push(file.path().to_owned());
        drop(drafts);
        Ok((Self { file: Some(file), target, resolved }, written))
    }

    /// Gives the file its name, once its bytes are on the disk.
    ///
    /// # Errors
    /// Those of the system; [`super::OutputError`] if a file that is not ours has come there in the
    /// meantime. Then nothing of the draft stays.
    pub fn publish(self) -> io::Result<()> {
        Self::publish_all([self])
    }

    /// The same for files that belong together: all can be, before the first is.
    ///
    /// # Errors
    /// As [`Self::publish`].
    pub fn publish_all(drafts: impl IntoIterator<Item = Self>) -> io::Result<()> {
        let mut all: Vec<Self> = drafts.into_iter().collect();
        for draft in &all {
            draft.target.replaces().map_err(io::Error::other)?;
            if let Some(file) = &draft.file {
                keep_mode(file.as_file(), &draft.resolved)?;
                file.as_file().sync_data()?;
            }
        }
        // Declared after the drafts and so dropped before them: they lock it again.
        let mut names = self::drafts();
        for draft in &mut all {
            if let Some(file) = draft.file.take() {
                names.retain(|name| name != file.path());
                file.persist(&draft.resolved).map_err(|failed| failed.error)?;
            }
        }
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            let mut names = drafts();
            names.retain(|name| name != file.path());
            drop(file);
        }
    }
}

/// What the name of each draft of a file begins with.
fn beginning(target: &Path) -> String {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    format!(".{}.", name.chars().take(NAME_CHARS).collect::<String>())
}

/// Makes the file, not readable by more people than the one that it will replace.
fn begin(target: &Path, before: Option<&Metadata>) -> io::Result<NamedTempFile> {
    target.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    let name = format!("{}{}-", beginning(target), std::process::id());
    let mut builder = Builder::new();
    builder.prefix(&name).suffix(END);
    for _ in 0..TRIES {
        let file = builder.make_in(folder(target), |path| create(path, before))?;
        // Held until the file is closed, however the process ends. Where there are no locks, the
        // process's number alone says whose the draft is.
        let sweeping = matches!(file.as_file().try_lock(), Err(fs::TryLockError::WouldBlock));
        if !sweeping && file.path().exists() {
            return Ok(file);
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

/// A new file: with the permissions of the one before, or all that the process's mask leaves. The
/// error is the system's own: who reports it names the file that was asked for, not its draft.
fn create(path: &Path, before: Option<&Metadata>) -> io::Result<File> {
    let mut options = File::options();
    options.read(true).write(true).create_new(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::{OpenOptionsExt, PermissionsExt};
        options.mode(before.map_or(0o666, |about| about.permissions().mode()));
    }
    #[cfg(not(unix))]
    let _ = before;
    options.open(path)
}

/// Gives a draft the mode of the file that it will replace, and its owner as far as one may.
fn keep_mode(draft: &File, target: &Path) -> io::Result<()> {
    let Ok(about) = fs::metadata(target) else { return Ok(()) };
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        let now = draft.metadata()?;
        if (now.uid(), now.gid()) != (about.uid(), about.gid()) {
            // Only the administrator may give files away.
            let _ = fchown(draft, Some(about.uid()), Some(about.gid()));
        }
    }
    draft.set_permissions(about.permissions())
}

/// Removes the drafts of `target` that processes which are no more have left.
pub(super) fn sweep(target: &Path) {
    let beginning = beginning(target);
    // What cannot be listed or removed hinders nobody.
    let Ok(entries) = fs::read_dir(folder(target)) else { return };
    for entry in entries.flatten() {
        let (name, path) = (entry.file_name(), entry.path());
        let process = name.to_str().and_then(|name| process(name.strip_prefix(&beginning)?));
        let is_left = process.is_some_and(|process| {
            // In a container each program may have the same number.
            if process == std::process::id() { !drafts().contains(&path) } else { !lives(process) }
        });
        if is_left {
            remove_if_left(&path);
        }
    }
}

/// The number of the process in `PROCESS-RANDOM.part`.
fn process(rest: &str) -> Option<u32> {
    let (process, random) = rest.strip_suffix(END)?.split_once('-')?;
    random.chars().all(char::is_alphanumeric).then_some(process)?.parse().ok()
}

/// Whether there is such a process, be it another one that has the number now.
fn lives(process: u32) -> bool {
    let Ok(about) = fs::read_to_string(format!("/proc/{process}/stat")) else {
        // Without a list of processes the lock alone decides.
        return false;
    };
    // The state comes behind the name in parentheses; Z has ended and waits to be asked how.
    about.rsplit_once(") ").is_none_or(|(_, state)| !state.starts_with('Z'))
}

/// A draft whose writer lives is locked, wherever that runs.
fn remove_if_left(draft: &Path) {
    let is_file = fs::symlink_metadata(draft).is_ok_and(|about| about.is_file());
    let Some(file) = is_file.then(|| File::open(draft).ok()).flatten() else { return };
    if !matches!(file.try_lock(), Err(fs::TryLockError::WouldBlock)) {
        let _ = fs::remove_file(draft);
    }
}

impl Target {
    /// A draft, and the file to write to. No draft where the path leads to something that is no
    /// regular file and must not be replaced, such as `/dev/stdout` or a pipe.
    ///
    /// # Errors
    /// Those of the system; [`OutputError`] if something else is there now.
    pub fn open(&self) -> io::Result<(Option<Draft>, File)> {
        match self.replaces().map_err(io::Error::other)? {
            Some(resolved) => {
                let (draft, file) = Draft::create(self.clone(), resolved)?;
                Ok((Some(draft), file))
            }
            None => Ok((None, fs::OpenOptions::new().write(true).open(&self.path)?)),
        }
    }

    /// Writes `text` beside the file's place, with one line feed at its end; with
    /// [`Draft::publish`] it appears there.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn write(&self, text: &str) -> Result<Option<Draft>, OutputError> {
        let write = || -> io::Result<Option<Draft>> {
            let (draft, mut file) = self.open()?;
            io::Write::write_all(&mut file, format!("{}\n", text.trim_end()).as_bytes())?;
            Ok(draft)
        };
        write().map_err(|source| self.failed(source))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Its number says more than its text: a disk that is full, a folder that is not there.
    #[test]
    fn an_error_is_the_systems_own_without_the_name_of_the_draft() {
        let folder = tempfile::tempdir().unwrap();
        let error = begin(&folder.path().join("missing/out.csv"), None).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::NotFound);
        assert!(error.raw_os_error().is_some(), "{error}");
        assert!(!error.to_string().contains(".part"), "{error}");
    }
}
