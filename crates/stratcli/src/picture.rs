//! A picture of linear radiance as the bytes of a PNG or an OpenEXR file.

use anyhow::{Context, Result, bail};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    SpecificChannels, Text, Vec2, WritableImage,
};
use image::ImageEncoder;
use image::codecs::png::PngEncoder;
use std::io::Cursor;
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
        match self {
            Self::Png => png(size, rgb),
            Self::Exr => exr(size, rgb, comments),
        }
    }
}

fn png([width, height]: [u32; 2], rgb: &[Rgb]) -> Result<Vec<u8>> {
    let bytes: Vec<u8> = rgb.iter().flatten().map(|x| srgb_byte(*x)).collect();
    let mut file = Vec::new();
    PngEncoder::new(&mut file)
        .write_image(&bytes, width, height, image::ExtendedColorType::Rgb8)
        .context("cannot encode the PNG")?;
    Ok(file)
}

/// The transfer curve of IEC 61966-2-1 (sRGB), rounded to 8 bits.
pub fn srgb_byte(linear: f64) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}

fn exr([width, height]: [u32; 2], rgb: &[Rgb], comments: &str) -> Result<Vec<u8>> {
    let width = width as usize;
    let pixels = SpecificChannels::rgb(|Vec2(x, y): Vec2<usize>| {
        let [r, g, b] = rgb[y * width + x].map(|value| value as f32);
        (r, g, b)
    });
    let layer =
        Layer::new((width, height as usize), about(comments), Encoding::SMALL_LOSSLESS, pixels);
    let mut file = Cursor::new(Vec::new());
    // One thread: the writer's own pool would ignore --threads.
    Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(&mut file)
        .context("cannot encode the EXR")?;
    Ok(file.into_inner())
}

/// Attributes of our own would be written in the order of a hash map, another in every run.
fn about(comments: &str) -> LayerAttributes {
    LayerAttributes {
        software_name: Text::new_or_none(concat!("stratcli ", env!("CARGO_PKG_VERSION"))),
        comments: Text::new_or_none(comments),
        ..Default::default()
    }
}

/// An OpenEXR file of named float channels, row-major from the top-left. `comments` go into
/// the standard attribute of that name.
pub fn exr_channels(
    [width, height]: [u32; 2],
    channels: Vec<(String, Vec<f32>)>,
    comments: &str,
) -> Result<Vec<u8>> {
    let channels = channels
        .into_iter()
        .map(|(name, values)| AnyChannel::new(name.as_str(), FlatSamples::F32(values)))
        .collect();
    let size = (width as usize, height as usize);
    let layer =
        Layer::new(size, about(comments), Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
    let mut file = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(&mut file)
        .context("cannot encode the EXR")?;
    Ok(file.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{ReadChannels, ReadLayers};

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
        let read = exr::prelude::read()
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
