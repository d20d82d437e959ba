//! Where results go: standard output, and files that appear whole or not at all.

use anyhow::{Context, Result, bail};
use serde::Serialize;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Version of the shape of every JSON document.
pub const SCHEMA: u32 = 1;

/// What every JSON document begins with.
#[derive(Serialize)]
pub struct Document<T> {
    schema: u32,
    version: &'static str,
    #[serde(flatten)]
    body: T,
}

/// Writes text to standard output.
pub fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes())
        .and_then(|()| out.flush())
        .context("cannot write to standard output")
}

/// One JSON document. A number that is not finite becomes null.
pub fn json(body: impl Serialize) -> Result<String> {
    let document = Document { schema: SCHEMA, version: env!("CARGO_PKG_VERSION"), body };
    Ok(serde_json::to_string_pretty(&document)? + "\n")
}

/// Writes one JSON document to standard output.
pub fn print_json(body: impl Serialize) -> Result<()> {
    print(&json(body)?)
}

/// One line of CSV; a cell with a comma, a quote or a line's end is quoted (RFC 4180).
pub fn csv_line(cells: &[String]) -> String {
    let cell = |cell: &String| match cell.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", cell.replace('"', "\"\"")),
        false => cell.clone(),
    };
    cells.iter().map(cell).collect::<Vec<_>>().join(",") + "\n"
}

/// Writes one line to standard error. Where nobody listens there, nobody is told.
pub fn note(text: &str) {
    let _ = writeln!(io::stderr(), "{}", on_one_line(text));
}

/// The text with every run of white space as one space, and without characters that would
/// command a terminal: a file's words may stand in it.
pub fn on_one_line(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    line.replace(char::is_control, "\u{fffd}")
}

/// Whether the reader of standard output went away, as `head` does: no fault of ours.
pub fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.downcast_ref::<io::Error>().is_some_and(|e| e.kind() == io::ErrorKind::BrokenPipe)
}

/// Makes a folder, unless it is there; `option` is the one that names it.
pub fn make_folder(path: &Path, option: &str) -> Result<()> {
    fs::create_dir_all(path).with_context(|| {
        format!("cannot make the folder {}; choose another with {option}", path.display())
    })
}

/// What to say where a file that was opened could not be filled.
pub fn unwritten(path: &Path) -> String {
    format!("cannot write {}; make room there, or choose another place", path.display())
}

/// A file that gets its name when it is complete. Creating it early finds an unwritable place
/// before the work is done; dropping it leaves no trace. A link stays a link to the new file; a
/// device or a pipe is written to as it is.
pub struct AtomicFile {
    path: PathBuf,
    /// None where there is nothing to replace: the file is a device or a pipe.
    temporary: Option<PathBuf>,
    file: File,
}

impl AtomicFile {
    /// Opens a temporary file beside `path`.
    pub fn create(path: &Path) -> Result<Self> {
        Self::create_as(path, &format!(".{}.tmp", std::process::id()))
    }

    /// The same for a caller who holds a lock on `path`: what a killed run left behind is
    /// written over.
    pub fn create_locked(path: &Path) -> Result<Self> {
        Self::create_as(path, ".tmp")
    }

    fn create_as(path: &Path, ending: &str) -> Result<Self> {
        let shown = path.display();
        let unwritable =
            || format!("cannot write {shown}; choose a folder that exists and can be written to");
        let found = path.metadata();
        if found.as_ref().is_ok_and(|found| !found.is_file() && !found.is_dir()) {
            let file = OpenOptions::new().write(true).open(path).with_context(unwritable)?;
            return Ok(Self { path: path.to_owned(), temporary: None, file });
        }
        let target = if path.is_symlink() { path.canonicalize().ok() } else { None };
        let target = target.unwrap_or_else(|| path.to_owned());
        let Some(name) = target.file_name().filter(|_| !target.is_dir()) else {
            bail!("cannot write {shown}: it is a folder; name a file");
        };
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        hidden.push(ending);
        let temporary = target.with_file_name(hidden);
        let file = File::create(&temporary).with_context(unwritable)?;
        Ok(Self { path: target, temporary: Some(temporary), file })
    }

    /// Fills the file and gives it its name, in place of any older one.
    pub fn commit(mut self, contents: &[u8]) -> Result<()> {
        self.file.write_all(contents).with_context(|| unwritten(&self.path))?;
        self.commit_written()
    }

    /// The file, to be written bit by bit before [`AtomicFile::commit_written`].
    pub fn file(&self) -> &File {
        &self.file
    }

    /// Waits until the disk has what was written; a device or a pipe has no disk.
    pub fn sync(&self) -> io::Result<()> {
        if self.temporary.is_some() { self.file.sync_data() } else { Ok(()) }
    }

    /// Gives the file its name with what was written to it, in place of any older one.
    pub fn commit_written(self) -> Result<()> {
        let Some(temporary) = &self.temporary else { return Ok(()) };
        self.file
            .sync_all()
            .and_then(|()| fs::rename(temporary, &self.path))
            .with_context(|| unwritten(&self.path))
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        // Gone already after `commit`.
        let _ = self.temporary.as_ref().map(fs::remove_file);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_appears_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.txt");
        let entries = || fs::read_dir(folder.path()).unwrap().count();

        let dropped = AtomicFile::create(&path).unwrap();
        assert!(!path.exists());
        drop(dropped);
        assert_eq!(entries(), 0);

        AtomicFile::create(&path).unwrap().commit(b"whole").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "whole");
        assert_eq!(entries(), 1);
    }

    /// As root, `-o /dev/null` must not replace the device.
    #[cfg(unix)]
    #[test]
    fn links_stay_links_and_pipes_stay_pipes() {
        use std::io::Read;
        use std::os::unix::fs::FileTypeExt;
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("real"), "old").unwrap();
        std::os::unix::fs::symlink("real", path("link")).unwrap();
        AtomicFile::create(&path("link")).unwrap().commit(b"new").unwrap();
        assert!(path("link").is_symlink());
        assert_eq!(fs::read_to_string(path("real")).unwrap(), "new");

        let made = std::process::Command::new("mkfifo").arg(path("pipe")).status();
        assert!(made.unwrap().success());
        let reader = std::thread::spawn({
            let pipe = path("pipe");
            move || {
                let mut text = String::new();
                File::open(pipe).unwrap().read_to_string(&mut text).map(|_| text)
            }
        });
        AtomicFile::create(&path("pipe")).unwrap().commit(b"through").unwrap();
        assert_eq!(reader.join().unwrap().unwrap(), "through");
        assert!(path("pipe").metadata().unwrap().file_type().is_fifo());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    }

    #[test]
    fn csv_quotes_what_it_must() {
        let cells = ["a", "file:x,y.csv", "say \"b\"", ""].map(str::to_owned);
        assert_eq!(csv_line(&cells), "a,\"file:x,y.csv\",\"say \"\"b\"\"\",\n");
    }

    #[test]
    fn a_place_that_cannot_be_written_is_named() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path().to_owned(), folder.path().join("no/such/out.png")] {
            let error = format!("{:#}", AtomicFile::create(&path).err().unwrap());
            assert!(error.contains(&path.display().to_string()), "{error}");
        }
    }
}
