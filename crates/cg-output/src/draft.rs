//! A file that gets its name only when it is complete.
//!
//! A draft is written next to its target as `.NAME.PROCESS-RANDOM.part`. If it is dropped before it
//! is published, also by a panic, it is removed. [`abandon`] removes all drafts when the process is
//! asked to end. The drafts of a killed process are removed by the next process that writes the
//! same file.

use std::fs::{self, File, Metadata};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile};

use super::error::OutputError;
use super::place::folder;
use super::target::Target;

/// Suffix of the names of drafts.
const END: &str = ".part";
/// Number of characters of the file's name in the draft's name. A character has at most four bytes,
/// and a name at most 255.
const NAME_CHARS: usize = 50;
/// Maximum number of attempts to create a draft that no other process removes as left over.
const TRIES: usize = 100;

/// The drafts of this process. While it is locked, no draft can be created or published.
static DRAFTS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn drafts() -> MutexGuard<'static, Vec<PathBuf>> {
    // A panic cannot leave a list of paths in an inconsistent state.
    DRAFTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// While this exists, no draft can be created or published.
pub struct Abandoned {
    _drafts: MutexGuard<'static, Vec<PathBuf>>,
}

/// Removes all drafts of this process, which is about to end.
pub fn abandon() -> Abandoned {
    let drafts = drafts();
    for draft in drafts.iter() {
        // An error cannot be reported any more. The next run removes what remains.
        let _ = fs::remove_file(draft);
    }
    Abandoned { _drafts: drafts }
}

/// A temporary file next to its target.
pub struct Draft {
    /// `None` after publication.
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

    /// Gives the file its name after its bytes are on the disk.
    ///
    /// # Errors
    /// An error of the system, or [`super::OutputError`] if another file that cg did not write has
    /// appeared in the meantime. The draft is then removed.
    pub fn publish(self) -> io::Result<()> {
        Self::publish_all([self])
    }

    /// Publishes files that belong together. All of them are checked and stored on the disk before
    /// the first one gets its name.
    ///
    /// # Errors
    /// As for [`Self::publish`].
    pub fn publish_all(drafts: impl IntoIterator<Item = Self>) -> io::Result<()> {
        let mut all: Vec<Self> = drafts.into_iter().collect();
        for draft in &all {
            draft.target.replaces().map_err(io::Error::other)?;
            if let Some(file) = &draft.file {
                keep_mode(file.as_file(), &draft.resolved)?;
                file.as_file().sync_data()?;
            }
        }
        // Declared after the drafts and therefore dropped before them, because their drop locks it
        // again.
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

/// The beginning of the names of all drafts of a file.
fn beginning(target: &Path) -> String {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    format!(".{}.", name.chars().take(NAME_CHARS).collect::<String>())
}

/// Creates the draft, readable by no more users than the file that it will replace.
fn begin(target: &Path, before: Option<&Metadata>) -> io::Result<NamedTempFile> {
    target.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    let name = format!("{}{}-", beginning(target), std::process::id());
    let mut builder = Builder::new();
    builder.prefix(&name).suffix(END);
    for _ in 0..TRIES {
        let file = builder.make_in(folder(target), |path| create(path, before))?;
        // The lock is held until the file is closed, however the process ends. On systems without
        // locks, only the process number tells to which process the draft belongs.
        let sweeping = matches!(file.as_file().try_lock(), Err(fs::TryLockError::WouldBlock));
        if !sweeping && file.path().exists() {
            return Ok(file);
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

/// Creates a new file with the permissions of the file before or, if there is none, those that the
/// umask of the process allows. The error is that of the system without a path: the message names
/// the requested file, not its draft.
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

/// Gives a draft the mode of the file that it will replace, and its owner if the system permits it.
fn keep_mode(draft: &File, target: &Path) -> io::Result<()> {
    let Ok(about) = fs::metadata(target) else { return Ok(()) };
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        let now = draft.metadata()?;
        if (now.uid(), now.gid()) != (about.uid(), about.gid()) {
            // Only the administrator may change the owner.
            let _ = fchown(draft, Some(about.uid()), Some(about.gid()));
        }
    }
    draft.set_permissions(about.permissions())
}

/// Removes the drafts of `target` that ended processes have left.
pub(super) fn sweep(target: &Path) {
    let beginning = beginning(target);
    // Drafts that cannot be listed or removed do no harm.
    let Ok(entries) = fs::read_dir(folder(target)) else { return };
    for entry in entries.flatten() {
        let (name, path) = (entry.file_name(), entry.path());
        let process = name.to_str().and_then(|name| process(name.strip_prefix(&beginning)?));
        let is_left = process.is_some_and(|process| {
            // In a container, another program may have had the same process number.
            if process == std::process::id() { !drafts().contains(&path) } else { !lives(process) }
        });
        if is_left {
            remove_if_left(&path);
        }
    }
}

/// The process number in `PROCESS-RANDOM.part`.
fn process(rest: &str) -> Option<u32> {
    let (process, random) = rest.strip_suffix(END)?.split_once('-')?;
    random.chars().all(char::is_alphanumeric).then_some(process)?.parse().ok()
}

/// Whether a process with this number exists. It may be another one that reuses the number.
fn lives(process: u32) -> bool {
    let Ok(about) = fs::read_to_string(format!("/proc/{process}/stat")) else {
        // Without a list of processes, only the lock decides.
        return false;
    };
    // The state follows the name in parentheses. Z is a process that has ended.
    about.rsplit_once(") ").is_none_or(|(_, state)| !state.starts_with('Z'))
}

/// Removes a draft unless it is locked. The draft of a running writer is locked, also if the writer
/// runs in another container.
fn remove_if_left(draft: &Path) {
    let is_file = fs::symlink_metadata(draft).is_ok_and(|about| about.is_file());
    let Some(file) = is_file.then(|| File::open(draft).ok()).flatten() else { return };
    if !matches!(file.try_lock(), Err(fs::TryLockError::WouldBlock)) {
        let _ = fs::remove_file(draft);
    }
}

impl Target {
    /// A draft, and the file to write to. There is no draft if the path leads to something that is
    /// not a regular file and must not be replaced, such as `/dev/stdout` or a pipe.
    ///
    /// # Errors
    /// An error of the system, or [`OutputError`] if something else exists there now.
    pub fn open(&self) -> io::Result<(Option<Draft>, File)> {
        match self.replaces().map_err(io::Error::other)? {
            Some(resolved) => {
                let (draft, file) = Draft::create(self.clone(), resolved)?;
                Ok((Some(draft), file))
            }
            None => Ok((None, fs::OpenOptions::new().write(true).open(&self.path)?)),
        }
    }

    /// Writes `text` to a draft next to the target, with one line feed at its end.
    /// [`Draft::publish`] gives the file its name.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn write(&self, text: &str) -> Result<Option<Draft>, OutputError> {
        self.write_bytes(format!("{}\n", text.trim_end()).as_bytes())
    }

    /// The same with bytes as they are.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn write_bytes(&self, bytes: &[u8]) -> Result<Option<Draft>, OutputError> {
        let write = || -> io::Result<Option<Draft>> {
            let (draft, mut file) = self.open()?;
            io::Write::write_all(&mut file, bytes)?;
            Ok(draft)
        };
        write().map_err(|source| self.failed(source))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The system's error number is more useful than its text, for example for a full disk or a
    /// missing folder.
    #[test]
    fn an_error_is_the_systems_own_without_the_name_of_the_draft() {
        let folder = tempfile::tempdir().unwrap();
        let error = begin(&folder.path().join("missing/out.csv"), None).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::NotFound);
        assert!(error.raw_os_error().is_some(), "{error}");
        assert!(!error.to_string().contains(".part"), "{error}");
    }
}
