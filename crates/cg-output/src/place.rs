//! Detection of paths that lead to the same file.

use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};

/// Maximum number of consecutive links, as in the operating system.
const LINKS: usize = 40;

/// An existing file, or the place where a file will be created.
#[derive(Debug)]
pub struct Place {
    resolved: PathBuf,
    /// Device and inode, which are equal for all names of one file.
    node: Option<(u64, u64)>,
}

impl PartialEq for Place {
    fn eq(&self, other: &Self) -> bool {
        self.resolved == other.resolved || (self.node.is_some() && self.node == other.node)
    }
}

impl Place {
    /// The place of a path; `None` for devices and pipes, which cannot be replaced.
    pub fn of(path: &Path) -> Option<Self> {
        let about = fs::metadata(path);
        if about.as_ref().is_ok_and(|about| !about.is_file()) {
            return None;
        }
        Some(Self { resolved: resolved(path), node: about.ok().as_ref().and_then(node) })
    }
}

#[cfg(unix)]
#[allow(clippy::unnecessary_wraps)] // as elsewhere
fn node(about: &Metadata) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    Some((about.dev(), about.ino()))
}

#[cfg(not(unix))]
fn node(_: &Metadata) -> Option<(u64, u64)> {
    None
}

/// Whether this is a block device.
#[cfg(unix)]
pub(crate) fn is_disk(about: &Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_block_device(&about.file_type())
}

#[cfg(not(unix))]
pub(crate) fn is_disk(_: &Metadata) -> bool {
    false
}

/// Whether the path names an open stream, no matter where the stream leads.
pub(crate) fn is_stream(path: &Path) -> bool {
    ["/dev/stdout", "/dev/stderr", "/dev/fd", "/proc"].iter().any(|name| path.starts_with(name))
}

/// The folder of a path.
pub(crate) fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder.as_os_str().is_empty() => Path::new("."),
        Some(folder) => folder,
        None => path,
    }
}

/// The path without links. The file need not exist.
pub(crate) fn resolved(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    for _ in 0..LINKS {
        if let Ok(whole) = fs::canonicalize(&path) {
            return whole;
        }
        // A link to a file that does not exist yet.
        let Ok(to) = fs::read_link(&path) else { break };
        path = folder(&path).join(to);
    }
    match (fs::canonicalize(folder(&path)), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => std::path::absolute(&path).unwrap_or(path),
    }
}
