//! A small writer of SVG, and its picture as PNG.
//!
//! Charts are written as SVG text here rather than through a plotting package: log-log charts
//! need minor ticks, dashed slopes that stay dashed at any zoom, superscripts, and coordinates
//! finer than a pixel.

use super::raster::Raster;
use resvg::{tiny_skia, usvg};
use std::fmt::Write as _;
use std::sync::Arc;

/// Families tried in turn by a viewer; the first is the one that PNG files are set in.
const FONT_FAMILY: &str = "Ubuntu, 'Segoe UI', 'Helvetica Neue', Arial, sans-serif";

/// How a line is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Stroke {
    /// Colour, `#rrggbb`.
    pub colour: &'static str,
    /// Width in user units.
    pub width: f64,
    /// SVG dash pattern; empty for a solid line.
    pub dash: &'static str,
}

impl Stroke {
    /// A solid line.
    pub const fn solid(colour: &'static str, width: f64) -> Self {
        Self { colour, width, dash: "" }
    }
}

/// How a piece of text is set.
#[derive(Debug, Clone, Copy)]
pub struct Type {
    /// Font size in user units.
    pub size: f64,
    /// Colour, `#rrggbb`.
    pub colour: &'static str,
    /// `start`, `middle` or `end`.
    pub anchor: &'static str,
    /// Whether the text runs upwards.
    pub upwards: bool,
}

/// Shapes that tell series apart in grey.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// Open circle.
    Circle,
    /// Filled square.
    Square,
    /// Filled triangle.
    Triangle,
    /// Filled diamond.
    Diamond,
    /// Diagonal cross.
    Cross,
}

/// A drawing under construction. Rasters lie below everything else.
#[derive(Debug, Clone)]
pub struct Svg {
    width: f64,
    height: f64,
    title: String,
    body: String,
    images: Vec<(Rect, Raster)>,
}

/// A rectangle: left, top, width, height; y grows downwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rect {
    /// Left edge.
    pub x: f64,
    /// Top edge.
    pub y: f64,
    /// Width.
    pub w: f64,
    /// Height.
    pub h: f64,
}

impl Svg {
    /// An empty drawing; `title` is what a screen reader says.
    pub fn new(width: f64, height: f64, title: &str) -> Self {
        Self { width, height, title: title.to_owned(), body: String::new(), images: Vec::new() }
    }

    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        let _ = self.body.write_fmt(element); // writing to a String cannot fail
        self.body.push('\n');
    }

    /// A straight line.
    pub fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], stroke: Stroke) {
        self.path(&[[x1, y1], [x2, y2]], stroke);
    }

    /// A line through points.
    pub fn path(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        let mut d = String::new();
        for (i, [x, y]) in points.iter().enumerate() {
            let _ = write!(d, "{}{x:.2} {y:.2}", if i == 0 { "M" } else { "L" });
        }
        let Stroke { colour, width, dash } = stroke;
        let dash =
            if dash.is_empty() { String::new() } else { format!(r#" stroke-dasharray="{dash}""#) };
        self.push(format_args!(
            r#"<path d="{d}" fill="none" stroke="{colour}" stroke-width="{width}"{dash}/>"#
        ));
    }

    /// A filled rectangle.
    pub fn fill(&mut self, r: Rect, colour: &str, opacity: f64) {
        let Rect { x, y, w, h } = r;
        self.push(format_args!(
            r#"<rect x="{x:.2}" y="{y:.2}" width="{w:.2}" height="{h:.2}" fill="{colour}" fill-opacity="{opacity}"/>"#
        ));
    }

    /// The outline of a rectangle.
    pub fn outline(&mut self, r: Rect, stroke: Stroke) {
        let Rect { x, y, w, h } = r;
        self.path(
            &[[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y - stroke.width / 2.0]],
            stroke,
        );
    }

    /// A filled disc.
    pub fn disc(&mut self, [x, y]: [f64; 2], radius: f64, colour: &str) {
        self.push(format_args!(
            r#"<circle cx="{x:.2}" cy="{y:.2}" r="{radius:.2}" fill="{colour}"/>"#
        ));
    }

    /// A marker centred at a point.
    pub fn marker(&mut self, [x, y]: [f64; 2], marker: Marker, colour: &str) {
        let polygon = |points: &[[f64; 2]]| {
            points
                .iter()
                .map(|[a, b]| format!("{:.2},{:.2}", x + a, y + b))
                .collect::<Vec<_>>()
                .join(" ")
        };
        let filled = match marker {
            Marker::Circle => {
                return self.push(format_args!(
                    r##"<circle cx="{x:.2}" cy="{y:.2}" r="3.4" fill="#ffffff" stroke="{colour}" stroke-width="1.4"/>"##
                ));
            }
            Marker::Cross => {
                return self.push(format_args!(
                    r#"<path d="M{:.2} {:.2}l6.4 6.4m0 -6.4l-6.4 6.4" fill="none" stroke="{colour}" stroke-width="1.6"/>"#,
                    x - 3.2,
                    y - 3.2
                ));
            }
            Marker::Square => polygon(&[[-3.1, -3.1], [3.1, -3.1], [3.1, 3.1], [-3.1, 3.1]]),
            Marker::Triangle => polygon(&[[0.0, -4.2], [3.9, 2.8], [-3.9, 2.8]]),
            Marker::Diamond => polygon(&[[0.0, -4.4], [4.0, 0.0], [0.0, 4.4], [-4.0, 0.0]]),
        };
        self.push(format_args!(r#"<polygon points="{filled}" fill="{colour}"/>"#));
    }

    /// Text with its baseline at a point. `N^{-2}` raises what is in braces.
    pub fn text(&mut self, [x, y]: [f64; 2], set: Type, text: &str) {
        let Type { size, colour, anchor, upwards } = set;
        let turn = if upwards {
            format!(r#" transform="rotate(-90 {x:.2} {y:.2})""#)
        } else {
            String::new()
        };
        let mut spans = String::new();
        let mut raised = false;
        let mut drop = 0.0; // from a superscript back to the baseline
        for piece in text.split_inclusive(['{', '}']) {
            let (words, turned) = match piece.as_bytes().last() {
                Some(b'{') if piece.ends_with("^{") => (&piece[..piece.len() - 2], true),
                Some(b'}') if raised => (&piece[..piece.len() - 1], true),
                _ => (piece, false),
            };
            let words = escape(words);
            if raised {
                let (up, size) = (0.38 * size, 0.74 * size);
                let _ =
                    write!(spans, r#"<tspan dy="-{up:.2}" font-size="{size:.2}">{words}</tspan>"#);
                drop = up;
            } else if drop > 0.0 && !words.is_empty() {
                let _ = write!(spans, r#"<tspan dy="{drop:.2}">{words}</tspan>"#);
                drop = 0.0;
            } else {
                spans.push_str(&words);
            }
            raised ^= turned;
        }
        self.push(format_args!(
            r#"<text x="{x:.2}" y="{y:.2}" font-size="{size}" fill="{colour}" text-anchor="{anchor}"{turn}>{spans}</text>"#
        ));
    }

    /// A raster, its pixels magnified without smoothing.
    pub fn image(&mut self, r: Rect, raster: Raster) {
        self.images.push((r, raster));
    }

    /// The drawing as a file of its own.
    pub fn to_svg(&self) -> String {
        self.document(r#" xmlns="http://www.w3.org/2000/svg""#, &self.images())
    }

    /// The drawing as an element of an HTML page, which needs no name space.
    pub fn to_inline(&self) -> String {
        self.document("", &self.images())
    }

    fn images(&self) -> String {
        let mut text = r##"<rect width="100%" height="100%" fill="#ffffff"/>"##.to_owned() + "\n";
        for (Rect { x, y, w, h }, raster) in &self.images {
            let _ = writeln!(
                text,
                r#"<image x="{x:.2}" y="{y:.2}" width="{w:.2}" height="{h:.2}" preserveAspectRatio="none" style="image-rendering:pixelated" href="{}"/>"#,
                raster.data_uri()
            );
        }
        text
    }

    fn document(&self, name_space: &str, below: &str) -> String {
        let Self { width: w, height: h, .. } = self;
        format!(
            "<svg{name_space} viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\" role=\"img\" \
             font-family=\"{FONT_FAMILY}\">\n<title>{}</title>\n{below}{}</svg>\n",
            escape(&self.title),
            self.body
        )
    }

    /// The drawing as a PNG file, magnified by `scale`, set in the built-in font.
    ///
    /// # Errors
    /// In words, when the drawing is empty or too large to be rasterised.
    pub fn to_png(&self, scale: f64) -> Result<Vec<u8>, String> {
        let [w, h] = [self.width, self.height].map(|side| (side * scale).round() as u32);
        let mut layer =
            tiny_skia::Pixmap::new(w, h).ok_or_else(|| format!("cannot draw {w} x {h} pixels"))?;
        let mut options = usvg::Options::default();
        let font = Arc::new(epaint_default_fonts::UBUNTU_LIGHT);
        options.fontdb_mut().load_font_source(usvg::fontdb::Source::Binary(font));
        // Rasters are laid below by hand: resvg is built without decoders for them.
        let vectors = self.document(r#" xmlns="http://www.w3.org/2000/svg""#, "");
        let tree = usvg::Tree::from_str(&vectors, &options).map_err(|error| error.to_string())?;
        let transform = tiny_skia::Transform::from_scale(scale as f32, scale as f32);
        resvg::render(&tree, transform, &mut layer.as_mut());
        let mut picture = Raster::filled([w, h], [255; 3]);
        for (r, raster) in &self.images {
            picture.paste(raster, [r.x, r.y, r.w, r.h].map(|v| (v * scale).round() as u32));
        }
        // The layer's colours are already multiplied by their opacity.
        for (below, above) in picture.rgb.iter_mut().zip(layer.pixels()) {
            let rest = 255 - u32::from(above.alpha());
            let over =
                |b: u8, a: u8| (u32::from(a) + (u32::from(b) * rest + 127) / 255).min(255) as u8;
            *below = [
                over(below[0], above.red()),
                over(below[1], above.green()),
                over(below[2], above.blue()),
            ];
        }
        Ok(picture.png())
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Type = Type { size: 10.0, colour: "#000000", anchor: "start", upwards: false };

    #[test]
    fn text_is_escaped_and_superscripts_come_back_down() {
        let mut svg = Svg::new(100.0, 20.0, "a < b & c");
        svg.text([0.0, 10.0], PLAIN, "N^{-2} < 1 {kept}");
        let text = svg.to_svg();
        assert!(text.contains("<title>a &lt; b &amp; c</title>"), "{text}");
        assert!(text.contains(r#"<tspan dy="-3.80" font-size="7.40">-2</tspan>"#), "{text}");
        assert!(text.contains(r#"<tspan dy="3.80"> &lt; 1 {</tspan>kept}</text>"#), "{text}");
    }

    #[test]
    fn a_png_shows_rasters_below_lines_and_is_set_in_type() {
        let mut svg = Svg::new(40.0, 40.0, "test");
        svg.image(Rect { x: 0.0, y: 0.0, w: 20.0, h: 20.0 }, Raster::filled([1, 1], [0, 0, 255]));
        svg.line([0.0, 10.0], [20.0, 10.0], Stroke::solid("#ff0000", 4.0));
        svg.text([2.0, 38.0], PLAIN, "HHH");
        let png = image::load_from_memory(&svg.to_png(2.0).unwrap()).unwrap().to_rgb8();
        assert_eq!(png.dimensions(), (80, 80));
        assert_eq!(png.get_pixel(4, 4).0, [0, 0, 255]);
        assert_eq!(png.get_pixel(4, 20).0, [255, 0, 0]);
        assert_eq!(png.get_pixel(60, 20).0, [255; 3]);
        assert!((0..40).any(|x| png.get_pixel(x, 70).0[0] < 128), "no ink where the text stands");
    }
}
