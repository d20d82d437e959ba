//! Power spectra of point sets and of pictures.
//!
//! A [`Spectrum`] is a periodogram, or the mean of several, at integer frequencies. It is scaled
//! so that the mean over independent random points, or over a picture of independent noise, is
//! 1 at every frequency but zero, which is left out (NaN).

mod picture;
mod points;
mod radial;

pub use picture::of_picture;
pub use points::of_points;
pub use radial::Ring;

/// Power at integer frequencies, zero in the middle.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Frequencies along x and y.
    size: [usize; 2],
    /// One step of frequency along x and y: 1 for points, in cycles per unit square; 1/width
    /// and 1/height for a picture, in cycles per pixel.
    step: [f64; 2],
    /// Power, row by row from the lowest frequency along y, each row from the lowest along x.
    power: Vec<f64>,
    /// Periodograms that it is the mean of.
    periodograms: u32,
}

impl Spectrum {
    /// Frequencies along x and y; number 0 stands at `size / 2`, rounded down.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Power, row by row from the lowest frequency along y; NaN at frequency zero.
    pub fn power(&self) -> &[f64] {
        &self.power
    }

    /// Periodograms that it is the mean of.
    pub fn periodograms(&self) -> u32 {
        self.periodograms
    }

    /// Power at a frequency in steps along x and y; none outside of what was measured.
    pub fn at(&self, [x, y]: [i64; 2]) -> Option<f64> {
        let index = |k: i64, size: usize| {
            usize::try_from(k + size as i64 / 2).ok().filter(|index| *index < size)
        };
        let [x, y] = [index(x, self.size[0])?, index(y, self.size[1])?];
        Some(self.power[y * self.size[0] + x])
    }

    /// The mean of spectra of one size, weighted by their periodograms, added in order; none
    /// for none, or for sizes that differ.
    pub fn mean(spectra: impl IntoIterator<Item = Self>) -> Option<Self> {
        let mut spectra = spectra.into_iter();
        let mut sum = spectra.next()?;
        let weight = |spectrum: &Self| f64::from(spectrum.periodograms);
        let first = weight(&sum);
        sum.power.iter_mut().for_each(|power| *power *= first);
        for other in spectra {
            if (other.size, other.step) != (sum.size, sum.step) {
                return None;
            }
            sum.periodograms += other.periodograms;
            let weight = weight(&other);
            for (sum, power) in sum.power.iter_mut().zip(&other.power) {
                *sum += weight * power;
            }
        }
        let total = weight(&sum);
        sum.power.iter_mut().for_each(|power| *power /= total);
        Some(sum)
    }
}
