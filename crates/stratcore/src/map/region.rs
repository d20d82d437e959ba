//! Which pixels, and the tiles they are worked on and stored in.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A rectangle of pixels: x0 ≤ x < x1, y0 ≤ y < y1; (0, 0) is the top-left of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "[u32; 4]", from = "[u32; 4]")]
pub struct Region {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

/// A region in words that is none.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RegionError {
    /// Not four whole numbers.
    #[error(
        "{0}: not a region; write four whole numbers X0,Y0,X1,Y1: the first column and row, and \
         those after the last, counted from 0,0 at the top-left"
    )]
    Unreadable(String),
    /// No pixel inside, or pixels outside the picture.
    #[error(
        "{region}: holds no pixels or leaves the picture, which is {} × {}; X0 < X1 ≤ {} and \
         Y0 < Y1 ≤ {}",
        size[0], size[1], size[0], size[1]
    )]
    Outside {
        /// The region.
        region: Region,
        /// Width and height of the picture.
        size: [u32; 2],
    },
}

impl Region {
    /// All pixels of a picture.
    pub fn whole([width, height]: [u32; 2]) -> Self {
        Self { x0: 0, y0: 0, x1: width, y1: height }
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.x1 - self.x0, self.y1 - self.y0]
    }

    /// Number of pixels.
    pub fn n_pixels(&self) -> u64 {
        let [width, height] = self.size();
        u64::from(width) * u64::from(height)
    }

    /// The pixels, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let Self { x0, y0, x1, y1 } = *self;
        (y0..y1).flat_map(move |y| (x0..x1).map(move |x| [x, y]))
    }

    /// Refuses a region without pixels, or beyond a picture of this size.
    ///
    /// # Errors
    /// [`RegionError::Outside`].
    pub fn check(&self, size: [u32; 2]) -> Result<(), RegionError> {
        let Self { x0, y0, x1, y1 } = *self;
        let is_inside = x0 < x1 && x1 <= size[0] && y0 < y1 && y1 <= size[1];
        if is_inside { Ok(()) } else { Err(RegionError::Outside { region: *self, size }) }
    }
}

impl From<Region> for [u32; 4] {
    fn from(region: Region) -> Self {
        let Region { x0, y0, x1, y1 } = region;
        [x0, y0, x1, y1]
    }
}

impl From<[u32; 4]> for Region {
    fn from([x0, y0, x1, y1]: [u32; 4]) -> Self {
        Self { x0, y0, x1, y1 }
    }
}

impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { x0, y0, x1, y1 } = self;
        write!(f, "{x0},{y0},{x1},{y1}")
    }
}

impl FromStr for Region {
    type Err = RegionError;

    /// Reads `x0,y0,x1,y1`.
    fn from_str(text: &str) -> Result<Self, RegionError> {
        let numbers: Result<Vec<u32>, _> = text.split(',').map(|n| n.trim().parse()).collect();
        match numbers.as_deref() {
            Ok(&[x0, y0, x1, y1]) => Ok(Self { x0, y0, x1, y1 }),
            _ => Err(RegionError::Unreadable(text.to_owned())),
        }
    }
}

/// A region cut into squares, row by row from its top-left; those at the right and the bottom
/// are clipped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tiling {
    /// What is cut.
    pub region: Region,
    /// Pixels along the side of a tile, at least 1.
    pub side: u32,
}

impl Tiling {
    /// Tiles in a row.
    pub fn columns(&self) -> usize {
        self.region.size()[0].div_ceil(self.side) as usize
    }

    /// Number of tiles.
    pub fn n_tiles(&self) -> usize {
        self.columns() * self.region.size()[1].div_ceil(self.side) as usize
    }

    /// The pixels of tile `index`, below [`Tiling::n_tiles`].
    pub fn tile(&self, index: usize) -> Region {
        let Self { region, side } = *self;
        let (column, row) = (index % self.columns(), index / self.columns());
        let [x0, y0] = [region.x0 + column as u32 * side, region.y0 + row as u32 * side];
        Region {
            x0,
            y0,
            x1: region.x1.min(x0.saturating_add(side)),
            y1: region.y1.min(y0.saturating_add(side)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn tiles_cover_every_pixel_once() {
        for (region, side) in [([3, 1, 72, 40], 32), ([0, 0, 32, 32], 32), ([5, 5, 6, 6], 7)] {
            let region = Region::from(region);
            let tiling = Tiling { region, side };
            let mut seen = HashSet::new();
            for tile in (0..tiling.n_tiles()).map(|i| tiling.tile(i)) {
                tile.check([region.x1, region.y1]).unwrap();
                assert!(tile.pixels().all(|pixel| seen.insert(pixel)));
            }
            assert_eq!(seen, region.pixels().collect());
            assert_eq!(seen.len() as u64, region.n_pixels());
        }
    }

    #[test]
    fn regions_are_read_or_refused_with_the_way_out() {
        let region: Region = "1, 2,30,40".parse().unwrap();
        assert_eq!(region, Region { x0: 1, y0: 2, x1: 30, y1: 40 });
        assert_eq!(region.check([30, 40]), Ok(()));
        assert!(region.check([29, 40]).unwrap_err().to_string().contains("29 × 40"));
        assert!(Region::from([4, 4, 4, 9]).check([10, 10]).is_err());
        assert!(Region::from([5, 4, 4, 9]).check([10, 10]).is_err());
        for text in ["", "1,2,3", "1,2,3,4,5", "-1,0,2,2", "a,b,c,d"] {
            assert!(text.parse::<Region>().unwrap_err().to_string().contains("X0,Y0,X1,Y1"));
        }
    }
}
