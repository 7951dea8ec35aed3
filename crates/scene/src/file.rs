//! Reads and writes files at arbitrary paths: reads with a size limit, writes a whole file or nothing.

use std::ffi::OsStr;
use std::fmt;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use tempfile::Builder;

/// The reason why a file is not read.
#[derive(Debug)]
pub enum Refusal {
    /// The error of the operating system, or an error that names the kind of the file.
    Io(io::Error),
    /// The file is larger than the limit. The number is its size in bytes, as far as it is known.
    TooLarge(u64),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Refusal::Io(error) => error.fmt(f),
            Refusal::TooLarge(bytes) => write!(f, "it is too large: it has {bytes} bytes or more"),
        }
    }
}

/// All bytes of a regular file of at most `most` bytes. Reading a pipe or a device could block forever.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, Refusal> {
    // Opening a pipe blocks until it has a writer, so the type of the file is checked before.
    regular(&fs::metadata(path).map_err(Refusal::Io)?, most)?;
    let file = File::open(path).map_err(Refusal::Io)?;
    let metadata = file.metadata().map_err(Refusal::Io)?;
    regular(&metadata, most)?;
    // The kernel generates some files while they are read. They have length 0, count as regular and can block forever.
    if metadata.len() == 0 {
        return Ok(Vec::new());
    }
    let mut bytes = Vec::new();
    // The file can grow while it is read.
    let mut limited = file.take(most + 1);
    limited.read_to_end(&mut bytes).map_err(Refusal::Io)?;
    match bytes.len() as u64 {
        length if length > most => Err(Refusal::TooLarge(length)),
        _ => Ok(bytes),
    }
}

fn regular(metadata: &fs::Metadata, most: u64) -> Result<(), Refusal> {
    if !metadata.is_file() {
        let what =
            "it is not a regular file: give the path of a file, not of a folder, pipe or device";
        return Err(Refusal::Io(io::Error::other(what)));
    }
    if metadata.len() > most {
        return Err(Refusal::TooLarge(metadata.len()));
    }
    Ok(())
}

/// Writes a whole file: first to a temporary file beside it, which is then renamed, so that a full disk or a crash
/// leaves the old file unchanged. A file that is not regular, such as a device, is written in place.
///
/// A symbolic link stays, and the file to which it points is replaced. The permissions of an old file are kept.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let target = match fs::canonicalize(path) {
        Ok(target) => target,
        Err(error) if error.kind() == io::ErrorKind::NotFound => path.to_owned(),
        Err(error) => return Err(error),
    };
    let old = fs::metadata(&target).ok();
    if old.as_ref().is_some_and(|old| !old.is_file()) {
        let mut device = File::options().write(true).open(&target)?;
        device.write_all(bytes)?;
        return device.flush();
    }
    // A rename would ignore the write protection of a read-only file.
    if old.is_some() {
        File::options().write(true).open(&target)?;
    }
    let name = target.file_name().unwrap_or(OsStr::new("file"));
    let mut prefix = OsStr::new(".").to_owned();
    // The length of file names is limited.
    prefix.push(if name.len() < 100 {
        name
    } else {
        OsStr::new("file")
    });
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut beside = builder.tempfile_in(folder(&target))?;
    if let Some(old) = old {
        beside.as_file().set_permissions(old.permissions())?;
    }
    beside.write_all(bytes)?;
    beside.flush()?;
    beside.as_file().sync_all()?;
    beside.persist(&target).map_err(|error| error.error)?;
    Ok(())
}

fn folder(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}
