//! A layer of the model on the GPU, kept up to date row by row.

use crate::model::Layer;
use eframe::egui::{
    Color32, ColorImage, Context, Painter, Rect, TextureHandle, TextureOptions, Vec2, pos2, vec2,
};

/// Side of a tile: every GPU takes textures of this size.
const TILE: u32 = 1024;

/// Pixels that are converted in one frame: some milliseconds of work. A larger picture takes
/// several frames.
const MOST_PIXELS: u32 = 1 << 18;

/// A layer in tiles, its pixels magnified without smoothing.
#[derive(Default)]
pub struct TiledTexture<K> {
    tiles: Vec<Tile>,
    size: [u32; 2],
    /// The version in which each row was last uploaded.
    shown: Vec<u64>,
    /// What else the colours depend on.
    key: Option<K>,
}

struct Tile {
    at: [u32; 2],
    size: [u32; 2],
    texture: TextureHandle,
}

impl<K: PartialEq> TiledTexture<K> {
    /// Uploads the rows that have changed, all of them when `key` or the size has: as many as one
    /// frame has time for.
    pub fn update<T: Copy>(
        &mut self,
        ctx: &Context,
        layer: &Layer<T>,
        key: K,
        colour: impl Fn(&T) -> Color32,
    ) {
        let [width, height] = layer.size;
        if self.size != layer.size {
            self.rebuild(ctx, layer.size);
            self.key = None;
        }
        if self.key.as_ref() != Some(&key) {
            (self.key, self.shown) = (Some(key), vec![0; height as usize]);
        }
        let is_news = |row: &u32| layer.row_versions[*row as usize] > self.shown[*row as usize];
        let Some(first) = (0..height).find(is_news) else { return };
        let end = height.min(first + (MOST_PIXELS / width.max(1)).max(1));
        let Some(last) = (first..end).rev().find(is_news) else { return };
        if (end..height).any(|row| is_news(&row)) {
            ctx.request_repaint();
        }
        for row in first..=last {
            self.shown[row as usize] = layer.row_versions[row as usize];
        }
        for tile in &mut self.tiles {
            let [x, y] = tile.at;
            let top = first.max(y);
            let bottom = (last + 1).min(y + tile.size[1]);
            if top >= bottom {
                continue;
            }
            let row = |row: u32| {
                let start = row as usize * layer.size[0] as usize + x as usize;
                &layer.cells[start..start + tile.size[0] as usize]
            };
            let pixels = (top..bottom).flat_map(row).map(&colour).collect();
            let size = [tile.size[0] as usize, (bottom - top) as usize];
            let image = ColorImage::new(size, pixels);
            tile.texture.set_partial([0, (top - y) as usize], image, TextureOptions::NEAREST);
        }
    }

    fn rebuild(&mut self, ctx: &Context, size: [u32; 2]) {
        self.size = size;
        self.tiles.clear();
        for y in (0..size[1]).step_by(TILE as usize) {
            for x in (0..size[0]).step_by(TILE as usize) {
                let size = [TILE.min(size[0] - x), TILE.min(size[1] - y)];
                let blank = ColorImage::filled(size.map(|s| s as usize), Color32::TRANSPARENT);
                let texture = ctx.load_texture("layer", blank, TextureOptions::NEAREST);
                self.tiles.push(Tile { at: [x, y], size, texture });
            }
        }
    }

    /// Draws it with its top left corner at `origin` and `scale` points per pixel.
    pub fn paint(&self, painter: &Painter, origin: eframe::egui::Pos2, scale: f32, tint: Color32) {
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        let vec = |[x, y]: [u32; 2]| -> Vec2 { vec2(x as f32, y as f32) * scale };
        for tile in &self.tiles {
            let rect = Rect::from_min_size(origin + vec(tile.at), vec(tile.size));
            if rect.intersects(painter.clip_rect()) {
                painter.image(tile.texture.id(), rect, uv, tint);
            }
        }
    }
}
