//! A picture of linear radiance as a PNG or an OpenEXR file.

pub mod exr;

use anyhow::{Context, Result, bail};
use std::io::{BufWriter, Cursor, Seek, Write};
use std::ops::Range;
use std::path::Path;
use stratcore::scene::Rgb;

/// File formats, named by their extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// 8-bit sRGB; radiance above 1 is white.
    Png,
    /// 32-bit linear R, G, B.
    Exr,
}

impl Format {
    /// The format that a file's name asks for.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().map(|e| e.to_ascii_lowercase());
        match extension.as_ref().and_then(|e| e.to_str()) {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => bail!("cannot write {}: name a file that ends in .png or .exr", path.display()),
        }
    }

    /// The file's bytes. `rgb` is row-major from the top-left; `comments` go into the standard
    /// attribute of that name of an EXR.
    pub fn encode(self, size: [u32; 2], rgb: &[Rgb], comments: &str) -> Result<Vec<u8>> {
        let mut file = Cursor::new(Vec::new());
        let at = |row: u32| row as usize * size[0] as usize;
        self.write(&mut file, size, comments, |rows| {
            Ok(rgb[at(rows.start)..at(rows.end)].to_vec())
        })?;
        Ok(file.into_inner())
    }

    /// Writes the file, asking `lines` for some lines at a time, in order from the top: memory
    /// does not grow with the picture.
    pub fn write(
        self,
        out: impl Write + Seek,
        size: [u32; 2],
        comments: &str,
        lines: impl FnMut(Range<u32>) -> Result<Vec<Rgb>>,
    ) -> Result<()> {
        match self {
            Self::Png => write_png(out, size, lines),
            Self::Exr => write_rgb(out, size, comments, lines),
        }
    }
}

/// The lines of a picture in bands of some hundred thousand pixels, each a multiple of `step`
/// lines but for the last.
fn bands([width, height]: [u32; 2], step: u32) -> impl Iterator<Item = Range<u32>> {
    const PIXELS: u32 = 1 << 18;
    let lines = (PIXELS / width.max(1) / step).max(1).saturating_mul(step);
    (0..height).step_by(lines as usize).map(move |top| top..height.min(top.saturating_add(lines)))
}

fn write_png(
    out: impl Write,
    size: [u32; 2],
    mut lines: impl FnMut(Range<u32>) -> Result<Vec<Rgb>>,
) -> Result<()> {
    const FAULT: &str = "cannot write the PNG";
    let mut encoder = png::Encoder::new(BufWriter::new(out), size[0], size[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Fast);
    let mut file = encoder.write_header().context(FAULT)?;
    let mut stream = file.stream_writer().context(FAULT)?;
    for band in bands(size, 1) {
        let bytes: Vec<u8> = lines(band)?.iter().flatten().map(|x| srgb_byte(*x)).collect();
        stream.write_all(&bytes).context(FAULT)?;
    }
    stream.finish().context(FAULT)?;
    file.finish().context(FAULT)
}

fn write_rgb(
    out: impl Write + Seek,
    size: [u32; 2],
    comments: &str,
    mut lines: impl FnMut(Range<u32>) -> Result<Vec<Rgb>>,
) -> Result<()> {
    let planes = |rows: Range<u32>| -> Result<Vec<f32>> {
        let rgb = lines(rows)?;
        let blue_first = |line: &[Rgb]| -> Vec<f32> {
            [2, 1, 0].iter().flat_map(|&c| line.iter().map(move |rgb| rgb[c] as f32)).collect()
        };
        Ok(rgb.chunks_exact(size[0] as usize).flat_map(blue_first).collect())
    };
    exr::write_lines(out, size, &["B", "G", "R"], comments, planes)
}

/// The transfer curve of IEC 61966-2-1 (sRGB), rounded to 8 bits.
pub fn srgb_byte(linear: f64) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::exr::prelude::{ReadChannels, ReadLayers, Text};

    #[test]
    fn srgb_meets_its_published_points() {
        assert_eq!(srgb_byte(0.0), 0);
        assert_eq!(srgb_byte(1.0), 255);
        assert_eq!(srgb_byte(7.0), 255);
        assert_eq!(srgb_byte(-1.0), 0);
        assert_eq!(srgb_byte(f64::NAN), 0);
        // Half of the light is byte 188; byte 119 is 18 % grey rounded up from 117.6 of 0.18.
        assert_eq!(srgb_byte(0.5), 188);
        assert_eq!(srgb_byte(0.18), 118);
    }

    #[test]
    fn both_formats_give_back_what_they_were_given() {
        let size = [3, 2];
        let rgb: Vec<Rgb> = (0..6).map(|i| [f64::from(i) * 0.25, 1e-3, 1e4]).collect();

        let png = Format::Png.encode(size, &rgb, "").unwrap();
        let read = image::load_from_memory(&png).unwrap().into_rgb8();
        assert_eq!((read.width(), read.height()), (3, 2));
        assert_eq!(read.get_pixel(1, 1).0, [255, srgb_byte(1e-3), 255]);
        assert_eq!(read.get_pixel(2, 0).0[0], 188);

        let exr = Format::Exr.encode(size, &rgb, "seed 7").unwrap();
        let read = ::exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(exr))
            .unwrap();
        let names: Vec<_> =
            read.layer_data.channel_data.list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names, ["B", "G", "R"]);
        let red = &read.layer_data.channel_data.list[2].sample_data;
        assert_eq!(red.value_by_flat_index(5).to_f32(), 1.25);
        assert_eq!(read.layer_data.attributes.comments, Text::new_or_none("seed 7"));
    }

    #[test]
    fn an_unknown_format_names_those_that_exist() {
        for name in ["a.jpg", "png", "a.", "dir/"] {
            let error = Format::of(Path::new(name)).unwrap_err().to_string();
            assert!(error.contains(".png or .exr"), "{error}");
        }
        assert_eq!(Format::of(Path::new("A.PNG")).unwrap(), Format::Png);
    }
}
