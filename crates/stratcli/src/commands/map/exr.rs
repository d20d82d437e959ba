//! A map as OpenEXR: one part of 32-bit channels in tiles, those of the map.
//!
//! `R`, `G` and `B` come first, all three the mean of the studied channel: the mean of all
//! trials at the largest N of the first sampler. Then, for each sampler, `Rate.p`, `Rate.p_lo`,
//! `Rate.p_hi`, `Class.id` and `VarianceOfMean.N00256` …; where there are several samplers, each
//! group begins with its name: `jittered.Rate.p`. NaN is missing.

use super::csv::best_mean;
use crate::picture;
use anyhow::Result;
use exr::block::BlockIndex;
use exr::block::chunk::Chunk;
use exr::math::RoundingMode;
use exr::meta::attribute::{IntegerBounds, LevelMode, LineOrder, TileDescription};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::{Compression, Vec2};
use stratcore::map::{Identity, PixelReading, Region};
use stratcore::theory::Class;

/// What a channel shows of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Layer {
    Mean,
    Exponent,
    Low,
    High,
    Class,
    /// By the place of its N in the plan.
    Variance(usize),
}

/// The channels of a map, in the order in which a file holds them: by name.
pub struct ExrLayout(Vec<(String, usize, Layer)>);

impl ExrLayout {
    /// The channels for a plan.
    pub fn new(plan: &Identity) -> Self {
        let mut channels: Vec<_> =
            ["R", "G", "B"].map(|name| (name.to_owned(), 0, Layer::Mean)).into();
        for (i, sampler) in plan.samplers.iter().enumerate() {
            let prefix = match plan.samplers.len() {
                1 => String::new(),
                // Viewers group channels by what stands before a dot.
                _ => sampler.label().replace(['.', '/', '\\'], "_") + ".",
            };
            let mut add = |name: &str, layer| channels.push((format!("{prefix}{name}"), i, layer));
            add("Rate.p", Layer::Exponent);
            add("Rate.p_lo", Layer::Low);
            add("Rate.p_hi", Layer::High);
            add("Class.id", Layer::Class);
            for (row, n) in plan.counts.iter().enumerate() {
                add(&format!("VarianceOfMean.N{n:05}"), Layer::Variance(row));
            }
        }
        channels.sort_by(|a, b| a.0.cmp(&b.0));
        Self(channels)
    }

    /// The file's header.
    pub fn header(&self, plan: &Identity, comments: &str) -> Header {
        let [x, y] = [plan.region.x0, plan.region.y0].map(|corner| corner as i32);
        let [full_width, full_height] = plan.resolution.map(|side| side as usize);
        let tiles = TileDescription {
            tile_size: Vec2(plan.tile_side as usize, plan.tile_side as usize),
            level_mode: LevelMode::Singular,
            rounding_mode: RoundingMode::Down,
        };
        let names = self.0.iter().map(|(name, ..)| name.as_str());
        picture::exr::header(plan.region.size(), names, comments)
            .with_position(Vec2(x, y))
            .with_display_window(IntegerBounds::from_dimensions((full_width, full_height)))
            .with_encoding(
                // Variances are noise to a compressor: deflate saves little more, and takes
                // longer than all the rest of this pass.
                Compression::RLE,
                BlockDescription::Tiles(tiles),
                LineOrder::Increasing,
            )
    }

    /// A tile's pixels as a chunk of the file.
    pub fn chunk(
        &self,
        meta: &MetaData,
        plan: &Identity,
        tile: Region,
        readings: &[Vec<PixelReading>],
    ) -> Result<Chunk> {
        let [width, height] = tile.size().map(|side| side as usize);
        let at = [tile.x0 - plan.region.x0, tile.y0 - plan.region.y0].map(|side| side as usize);
        let mut data = Vec::with_capacity(4 * readings.len() * self.0.len());
        for line in readings.chunks_exact(width) {
            for &(_, sampler, layer) in &self.0 {
                for pixel in line {
                    let value = layer.of(plan, &pixel[sampler]) as f32;
                    data.extend(value.to_ne_bytes());
                }
            }
        }
        let index = BlockIndex {
            layer: 0,
            pixel_position: Vec2(at[0], at[1]),
            pixel_size: Vec2(width, height),
            level: Vec2(0, 0),
        };
        picture::exr::compress(meta, index, data)
    }
}

impl Layer {
    fn of(self, plan: &Identity, pixel: &PixelReading) -> f64 {
        let fit = pixel.reading.fit;
        let fitted = |value: fn(stratcore::fit::Fit) -> f64| fit.map_or(f64::NAN, value);
        match self {
            Self::Mean => best_mean(plan, pixel),
            Self::Exponent => fitted(|fit| fit.exponent),
            Self::Low => fitted(|fit| fit.ci95[0]),
            Self::High => fitted(|fit| fit.ci95[1]),
            Self::Class => pixel.reading.class.map_or(f64::NAN, class_id),
            Self::Variance(row) => pixel.moments[row].variance,
        }
    }
}

/// The number of a class in a picture.
fn class_id(class: Class) -> f64 {
    match class {
        Class::Exact => 0.0,
        Class::Smooth => 1.0,
        Class::Edge => 2.0,
        Class::Complex => 3.0,
    }
}
