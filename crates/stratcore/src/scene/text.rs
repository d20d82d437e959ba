//! Texts of scenes, as files give them.

use super::SceneError;
use crate::input::{MAX_DOCUMENT, MAX_LINE, Open, read_whole};
use std::borrow::Cow;
use std::io::{self, BufRead, Read};
use std::path::Path;

pub(super) fn shown(path: &Path) -> String {
    path.display().to_string()
}

fn unreadable(path: &Path) -> impl Fn(io::Error) -> SceneError + use<'_> {
    move |e| SceneError::Unreadable { path: shown(path), fault: e.to_string() }
}

/// A whole document; bytes that are no UTF-8 (old comments and names) become replacement
/// characters.
pub(super) fn document(open: Open<'_>, path: &Path) -> Result<String, SceneError> {
    let bytes = open(path).and_then(|reader| read_whole(reader, MAX_DOCUMENT));
    Ok(String::from_utf8_lossy(&bytes.map_err(unreadable(path))?).into_owned())
}

/// A text of any length, line by line; bytes that are no UTF-8 become replacement characters.
pub(super) struct Lines<'a> {
    path: &'a Path,
    reader: Box<dyn BufRead>,
    number: usize,
    buffer: Vec<u8>,
}

impl<'a> Lines<'a> {
    pub fn open(open: Open<'_>, path: &'a Path) -> Result<Self, SceneError> {
        Self::new(open(path), path)
    }

    /// Of a file that was opened, or not.
    pub fn new(opened: io::Result<Box<dyn BufRead>>, path: &'a Path) -> Result<Self, SceneError> {
        let reader = opened.map_err(unreadable(path))?;
        Ok(Self { path, reader, number: 0, buffer: Vec::new() })
    }

    /// The next line, without its end, and its number, from 1.
    pub fn next_line(&mut self) -> Result<Option<(usize, Cow<'_, str>)>, SceneError> {
        self.buffer.clear();
        self.number += 1;
        let mut limited = (&mut self.reader).take(MAX_LINE + 1);
        let read = limited.read_until(b'\n', &mut self.buffer).map_err(unreadable(self.path))?;
        match read {
            0 => Ok(None),
            _ if read as u64 > MAX_LINE => {
                Err(SceneError::LongLine { path: shown(self.path), line: self.number })
            }
            _ => {
                let line = self.buffer.strip_suffix(b"\n").unwrap_or(&self.buffer);
                Ok(Some((self.number, String::from_utf8_lossy(line))))
            }
        }
    }
}
