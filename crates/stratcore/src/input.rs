//! Files that are read: regular ones alone, and no more of one than it may hold.
//!
//! Whatever a user's file says of itself, memory follows what it holds. The limits are here, so
//! that they are in one place; METHOD.md, *Reliability*, lists them.

use std::fs::{self, File, Metadata};
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

/// Most bytes of a file that is read whole as TOML or JSON: scenes, studies, summaries of maps.
pub const MAX_DOCUMENT: u64 = 16 << 20;

/// Most bytes of any other file that is read whole: point sets, pictures.
pub const MAX_DATA: u64 = 1 << 30;

/// Most bytes of one line of an OBJ or MTL file: a polygon of some million corners.
pub const MAX_LINE: u64 = 16 << 20;

/// Opens a regular file for reading. Anything else may never end, or never begin: a device, a
/// pipe that nobody writes to.
///
/// # Errors
/// Those of the system; [`io::ErrorKind::Unsupported`] for what is no regular file.
pub fn open(path: &Path) -> io::Result<File> {
    // Looked at before it is opened, since opening a pipe waits for its other end; and after, in
    // case it was another file by then.
    refuse_irregular(&fs::metadata(path)?)?;
    let file = File::open(path)?;
    refuse_irregular(&file.metadata()?)?;
    Ok(file)
}

/// The whole of a regular file that has at most `most` bytes.
///
/// # Errors
/// Those of [`open`]; [`io::ErrorKind::FileTooLarge`].
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    // Files of the system's own may hold more than their length says.
    if file.metadata()?.len() > most { Err(too_large(most)) } else { read_whole(file, most) }
}

/// The same as text.
///
/// # Errors
/// Those of [`read`]; [`io::ErrorKind::InvalidData`] where it is no UTF-8.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    let bytes = read(path, most)?;
    String::from_utf8(bytes).map_err(|_| {
        io::Error::new(io::ErrorKind::InvalidData, "it is no text: its bytes are not UTF-8")
    })
}

/// All that a reader has, at most `most` bytes.
pub(crate) fn read_whole(reader: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large(most)) } else { Ok(bytes) }
}

fn too_large(most: u64) -> io::Error {
    let fault = format!("it is larger than {most} bytes, the most that such a file may have");
    io::Error::new(io::ErrorKind::FileTooLarge, fault)
}

/// A way to open files by their paths: [`from_disk`], or another in tests.
pub type Open<'a> = &'a dyn Fn(&Path) -> io::Result<Box<dyn BufRead>>;

/// Opens the regular file at a path.
///
/// # Errors
/// Those of [`open`].
pub fn from_disk(path: &Path) -> io::Result<Box<dyn BufRead>> {
    Ok(Box::new(BufReader::new(open(path)?)))
}

/// Refuses what is no regular file, of what the system says of it.
///
/// # Errors
/// [`io::ErrorKind::Unsupported`].
pub(crate) fn refuse_irregular(found: &Metadata) -> io::Result<()> {
    if found.is_file() {
        return Ok(());
    }
    let fault = match found.is_dir() {
        true => "it is a folder",
        false => "it is no regular file, and a device or a pipe may never end: save it to a file",
    };
    Err(io::Error::new(io::ErrorKind::Unsupported, fault))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_its_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        fs::write(&path, "12345").unwrap();
        assert_eq!(read(&path, 5).unwrap(), b"12345");
        assert_eq!(read(&path, 4).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
        fs::write(&path, b"\xff").unwrap();
        assert_eq!(read_text(&path, 5).unwrap_err().kind(), io::ErrorKind::InvalidData);
        // A hole of a tebibyte takes neither disk nor memory.
        File::create(&path).unwrap().set_len(1 << 40).unwrap();
        assert_eq!(read(&path, 100).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
    }

    #[test]
    fn what_is_no_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(open(folder.path()).unwrap_err().to_string().contains("folder"));
        assert_eq!(
            open(&folder.path().join("absent")).unwrap_err().kind(),
            io::ErrorKind::NotFound
        );
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_pipes_are_refused_unopened() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
        assert!(made.success());
        // Opening the pipe would wait for ever.
        for path in [pipe.as_path(), Path::new("/dev/zero")] {
            assert!(open(path).unwrap_err().to_string().contains("no regular file"));
        }
    }
}
