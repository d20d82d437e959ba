//! Where results go: standard output, and files that appear whole or not at all.

use anyhow::{Context, Result, bail};
use serde::Serialize;
use std::fs::{self, File};
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

/// A file that gets its name when it is complete. Creating it early finds an unwritable place
/// before the work is done; dropping it leaves no trace.
pub struct AtomicFile {
    path: PathBuf,
    temporary: PathBuf,
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
        let Some(name) = path.file_name().filter(|_| !path.is_dir()) else {
            bail!("cannot write {shown}: it is a folder; name a file");
        };
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        hidden.push(ending);
        let temporary = path.with_file_name(hidden);
        let file = File::create(&temporary).with_context(|| {
            format!("cannot write {shown}; choose a folder that exists and can be written to")
        })?;
        Ok(Self { path: path.to_owned(), temporary, file })
    }

    /// Fills the file and gives it its name, in place of any older one.
    pub fn commit(mut self, contents: &[u8]) -> Result<()> {
        self.file
            .write_all(contents)
            .with_context(|| format!("cannot write {}", self.path.display()))?;
        self.commit_written()
    }

    /// The file, to be written bit by bit before [`AtomicFile::commit_written`].
    pub fn file(&self) -> &File {
        &self.file
    }

    /// Gives the file its name with what was written to it, in place of any older one.
    pub fn commit_written(self) -> Result<()> {
        self.file
            .sync_all()
            .and_then(|()| fs::rename(&self.temporary, &self.path))
            .with_context(|| format!("cannot write {}", self.path.display()))
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        // Gone already after `commit`.
        let _ = fs::remove_file(&self.temporary);
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
