//! OpenEXR files of 32-bit channels, written a few lines or tiles at a time.

use anyhow::{Result, anyhow};
use exr::block::chunk::Chunk;
use exr::block::writer::{ChunkWriter, ChunksWriter};
use exr::block::{BlockIndex, UncompressedBlock};
use exr::meta::attribute::{ChannelDescription, LineOrder, SampleType, Text};
use exr::meta::header::{Header, LayerAttributes};
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::{Compression, Vec2};
use std::io::{BufWriter, Cursor, Seek, Write};
use std::ops::Range;
use stratcore::study::collect;

/// A header of 32-bit channels by name, in the order in which a file holds them: sorted.
/// `comments` go into the standard attribute of that name: attributes of our own would be
/// written in the order of a hash map, another in every run.
pub fn header<'a>(
    [width, height]: [u32; 2],
    names: impl Iterator<Item = &'a str>,
    comments: &str,
) -> Header {
    let channels = names.map(|name| ChannelDescription::named(name, SampleType::F32)).collect();
    Header::new(Text::default(), (width as usize, height as usize), channels).with_attributes(
        LayerAttributes {
            software_name: Text::new_or_none(concat!("stratcli ", env!("CARGO_PKG_VERSION"))),
            comments: Text::new_or_none(comments),
            ..LayerAttributes::default()
        },
    )
}

/// Writes a file of one part, whose chunks `chunks` makes.
///
/// # Errors
/// What `chunks` returns, as it is; those of writing.
pub fn write<W: Write + Seek>(
    out: W,
    header: Header,
    chunks: impl FnOnce(&MetaData, &mut ChunkWriter<BufWriter<W>>) -> Result<()>,
) -> Result<()> {
    let mut fault = None;
    let headers = [header].into_iter().collect();
    let written = exr::block::write(BufWriter::new(out), headers, true, |meta, writer| {
        chunks(&meta, writer).map_err(|error| {
            fault = Some(error);
            exr::error::Error::Aborted
        })
    });
    match fault {
        Some(error) => Err(error),
        None => written.map_err(fault_of),
    }
}

/// A chunk of a file: for each line, each channel's values, as bytes of this machine's order.
pub fn compress(meta: &MetaData, index: BlockIndex, data: Vec<u8>) -> Result<Chunk> {
    UncompressedBlock { index, data }.compress_to_chunk(&meta.headers).map_err(fault_of)
}

/// Writes a chunk, whose place is counted from the top left.
pub fn write_chunk(writer: &mut impl ChunksWriter, place: usize, chunk: Chunk) -> Result<()> {
    writer.write_chunk(place, chunk).map_err(fault_of)
}

/// The error of the system where there was one: this library's words repeat it.
fn fault_of(error: exr::error::Error) -> anyhow::Error {
    match error {
        exr::error::Error::Io(error) => error.into(),
        other => anyhow!("cannot make an OpenEXR file: {other}"),
    }
}

/// Writes channels whose names are sorted, asking `lines` for some lines at a time, in order
/// from the top: of each line, each channel's values.
///
/// # Errors
/// What `lines` returns; those of writing.
pub fn write_lines(
    out: impl Write + Seek,
    size: [u32; 2],
    names: &[&str],
    comments: &str,
    mut lines: impl FnMut(Range<u32>) -> Result<Vec<f32>>,
) -> Result<()> {
    /// Lines in a chunk of the compression.
    const STEP: u32 = 16;
    let header = header(size, names.iter().copied(), comments).with_encoding(
        Compression::ZIP16,
        BlockDescription::ScanLines,
        LineOrder::Increasing,
    );
    let width = size[0] as usize;
    write(out, header, |meta, writer| {
        for band in super::bands(size, STEP) {
            let top = band.start;
            let values = lines(band)?;
            let blocks = values.chunks(STEP as usize * names.len() * width).enumerate().collect();
            let chunk = |(i, values): (usize, &[f32])| {
                let index = BlockIndex {
                    layer: 0,
                    pixel_position: Vec2(0, top as usize + i * STEP as usize),
                    pixel_size: Vec2(width, values.len() / (names.len() * width)),
                    level: Vec2(0, 0),
                };
                let data = values.iter().flat_map(|value| value.to_ne_bytes()).collect();
                compress(meta, index, data)
            };
            let chunks = collect(blocks, chunk)?;
            for (i, chunk) in (top as usize / STEP as usize..).zip(chunks) {
                write_chunk(writer, i, chunk)?;
            }
        }
        Ok(())
    })
}

/// The bytes of a file of named channels, row-major from the top-left.
pub fn encode(
    size: [u32; 2],
    mut channels: Vec<(String, Vec<f32>)>,
    comments: &str,
) -> Result<Vec<u8>> {
    channels.sort_by(|a, b| a.0.cmp(&b.0));
    let names: Vec<&str> = channels.iter().map(|(name, _)| name.as_str()).collect();
    let width = size[0] as usize;
    let line = |row: u32| {
        let at = row as usize * width;
        channels.iter().flat_map(move |(_, values)| &values[at..at + width]).copied()
    };
    let mut file = Cursor::new(Vec::new());
    write_lines(&mut file, size, &names, comments, |rows| Ok(rows.flat_map(line).collect()))?;
    Ok(file.into_inner())
}
