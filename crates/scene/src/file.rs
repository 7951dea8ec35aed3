//! Files from a path that may be anything: read with a limit, and written whole or not at all.

use std::ffi::OsStr;
use std::fmt;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use tempfile::Builder;

/// Why a file is not read.
#[derive(Debug)]
pub enum Refusal {
    /// The system's answer, or what the file is instead.
    Io(io::Error),
    /// It has more bytes than allowed: so many, as far as that is known.
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

/// All bytes of a regular file of at most `most` bytes. A pipe or a device could take for ever.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, Refusal> {
    // Opening a pipe waits for its writer, so the path is looked at before.
    regular(&fs::metadata(path).map_err(Refusal::Io)?, most)?;
    let file = File::open(path).map_err(Refusal::Io)?;
    let metadata = file.metadata().map_err(Refusal::Io)?;
    regular(&metadata, most)?;
    // What the kernel makes while it is read has no length, passes for a file, and may wait for ever.
    if metadata.len() == 0 {
        return Ok(Vec::new());
    }
    let mut bytes = Vec::new();
    // It may grow while it is read.
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

/// Writes a file whole: beside its place first, and then by a rename, so that a full disk or a crash
/// leaves the old file as it was. What is no regular file, such as a device, is written in place.
///
/// A link stays, and the file it leads to is replaced; an old file's permissions stay.
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
    // Renaming would get around the protection of a read-only file.
    if old.is_some() {
        File::options().write(true).open(&target)?;
    }
    let name = target.file_name().unwrap_or(OsStr::new("file"));
    let mut prefix = OsStr::new(".").to_owned();
    // Names of files have a limit of their own.
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
