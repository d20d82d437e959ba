//! Small RGB pictures and their PNG form.

use crate::picture::srgb_byte;
use stratcore::scene::{Channel, Rgb};

/// An 8-bit sRGB picture, row by row from the top-left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Raster {
    /// Width and height.
    pub size: [u32; 2],
    /// Pixels, `width * height` of them.
    pub rgb: Vec<[u8; 3]>,
}

impl Raster {
    /// One colour all over.
    pub fn filled(size: [u32; 2], colour: [u8; 3]) -> Self {
        Self { size, rgb: vec![colour; size[0] as usize * size[1] as usize] }
    }

    /// Linear RGB, encoded as sRGB and clipped to what a screen shows.
    pub fn from_linear(size: [u32; 2], linear: &[Rgb]) -> Self {
        Self { size, rgb: linear.iter().map(|rgb| rgb.map(srgb_byte)).collect() }
    }

    /// Copies `other`, magnified to the nearest pixel, into left, top, width, height; what falls
    /// outside is dropped.
    pub fn paste(&mut self, other: &Self, [left, top, width, height]: [u32; 4]) {
        for y in 0..height.min(self.size[1].saturating_sub(top)) {
            for x in 0..width.min(self.size[0].saturating_sub(left)) {
                let from = |at: u32, side: u32, to: u32| {
                    (u64::from(at) * u64::from(side) / u64::from(to)) as usize
                };
                let source = from(y, other.size[1], height) * other.size[0] as usize
                    + from(x, other.size[0], width);
                let target = (top + y) as usize * self.size[0] as usize + (left + x) as usize;
                self.rgb[target] = other.rgb[source];
            }
        }
    }

    /// As a PNG file.
    pub fn png(&self) -> Vec<u8> {
        use image::ImageEncoder as _;
        let mut file = Vec::new();
        let [w, h] = self.size;
        // Writing to memory fails only when the pixels do not fill the size, which `rgb` does.
        let _ = image::codecs::png::PngEncoder::new(&mut file).write_image(
            self.rgb.as_flattened(),
            w,
            h,
            image::ExtendedColorType::Rgb8,
        );
        file
    }

    /// As the address of an image that a page carries in itself.
    pub fn data_uri(&self) -> String {
        data_uri(&self.png())
    }
}

/// A PNG file as the address of an image that a page carries in itself.
pub fn data_uri(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64(png))
}

/// Base 64 of RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word =
            chunk.iter().fold(0u32, |word, &b| word << 8 | u32::from(b)) << (8 * (3 - chunk.len()));
        for i in 0..4 {
            let sextet = (word >> (18 - 6 * i)) as usize & 63;
            text.push(if i <= chunk.len() { ALPHABET[sextet] as char } else { '=' });
        }
    }
    text
}

/// Linear colours with their luminance stretched from nearly black to nearly white and their
/// hues kept, so that dark pictures and those of little contrast show their edges too.
pub fn stretched(linear: &[Rgb]) -> Vec<Rgb> {
    let luminances = || linear.iter().map(|rgb| Channel::Luminance.of(*rgb));
    let [low, high] =
        luminances().fold([f64::INFINITY, 0.0f64], |[lo, hi], v| [lo.min(v), hi.max(v)]);
    let stretch = |v: f64| 0.03 + 0.72 * (v - low) / (high - low).max(f64::MIN_POSITIVE);
    let stretched = linear.iter().zip(luminances()).map(|(rgb, luminance)| match luminance {
        0.0 => [stretch(0.0); 3],
        luminance => rgb.map(|v| v * stretch(luminance) / luminance),
    });
    stretched.collect()
}

/// The colour of t in [0, 1] on the scale of all false colours: viridis (van der Walt & Smith
/// 2015, CC0), interpolated between eight of its colours. Its last two ninths, up to yellow, are
/// left out: in grey they are the light grey that stands for exact pixels.
pub fn viridis(t: f64) -> [u8; 3] {
    const STOPS: [u32; 8] = [
        0x44_01_54, 0x48_28_78, 0x3e_49_89, 0x31_68_8e, 0x26_82_8e, 0x1f_9e_89, 0x35_b7_79,
        0x6e_ce_58,
    ];
    let at = t.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let low = (at as usize).min(STOPS.len() - 2);
    let mix = at - low as f64;
    [16, 8, 0].map(|shift| {
        let [a, b] = [STOPS[low], STOPS[low + 1]].map(|c| f64::from(c >> shift & 0xff));
        (a + (b - a) * mix).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_matches_the_vectors_of_rfc_4648() {
        let pairs =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        for (plain, coded) in pairs {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn a_png_reads_back_as_it_was() {
        let raster = Raster { size: [2, 1], rgb: vec![[1, 2, 3], [250, 0, 9]] };
        let read = image::load_from_memory(&raster.png()).unwrap().to_rgb8();
        assert_eq!(read.as_raw(), raster.rgb.as_flattened());
    }

    #[test]
    fn viridis_at_its_ends() {
        assert_eq!(viridis(0.0), [0x44, 0x01, 0x54]);
        assert_eq!(viridis(1.0), [0x6e, 0xce, 0x58]);
    }

    /// In grey the scale only brightens, and stays a tenth of all lightness (CIE L*) darker than
    /// what is exact.
    #[test]
    fn false_colours_are_in_order_in_grey() {
        let lightness = |rgb: [u8; 3]| {
            let linear = rgb.map(|byte| match f64::from(byte) / 255.0 {
                x if x <= 0.040_45 => x / 12.92,
                x => ((x + 0.055) / 1.055).powf(2.4),
            });
            116.0 * Channel::Luminance.of(linear).cbrt() - 16.0
        };
        let ramp: Vec<_> = (0..=64).map(|i| lightness(viridis(f64::from(i) / 64.0))).collect();
        assert!(ramp.windows(2).all(|pair| pair[1] > pair[0]), "{ramp:?}");
        assert!(lightness(super::super::picture::EXACT) > ramp[64] + 10.0);
    }

    #[test]
    fn pasting_magnifies_and_clips() {
        let mut canvas = Raster::filled([3, 2], [0; 3]);
        let pair = Raster { size: [2, 1], rgb: vec![[1; 3], [2; 3]] };
        canvas.paste(&pair, [1, 0, 4, 2]);
        assert_eq!(canvas.rgb.iter().map(|p| p[0]).collect::<Vec<_>>(), [0, 1, 1, 0, 1, 1]);
    }
}
