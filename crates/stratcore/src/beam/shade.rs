//! What a facet sends to the eye, in f64 for single samples and in f32 for the kernels.

use crate::beam::affine::{Affine, CentredFrame, Quadratic};
use crate::beam::facet::Facet;
use crate::scene::{Channel, Light, Material, Rgb, Scene};
use crate::simd::{Facet32, Shading};
use glam::DVec3;

/// Radiance of one facet, in the studied channel: `unlit` always, and where the light reaches
/// it the lit term.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shade {
    pub unlit: f64,
    pub lit: Lit,
}

/// The part of radiance that a shadow takes away.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Lit {
    /// The same everywhere; 0 on a facet that the light is behind.
    Constant(f64),
    /// albedo · (n·D) / |D|, from a headlight: the affine function is factor · 1/t.
    Headlight { cosine: Affine, factor: f64 },
    /// factor · w³ / q^(3/2), q = |l w - D|², from a point light at l.
    Point { factor: f64, square: Quadratic },
}

impl Shade {
    /// `material` is the facet's.
    pub fn new(
        scene: &Scene,
        material: &Material,
        channel: Channel,
        facet: &Facet,
        centred: &CentredFrame,
    ) -> Self {
        let product = |light: Rgb| channel_product(channel, material, light);
        let unlit = channel.of(material.ke) + product(scene.ambient);
        let lit = match scene.light {
            Light::Off => Lit::Constant(0.0),
            Light::Headlight => {
                let albedo = product([1.0; 3]);
                let cosine = Affine::dot(-facet.normal, centred).scaled(albedo);
                Lit::Headlight { cosine, factor: albedo * facet.plane_distance }
            }
            Light::Directional { towards, irradiance } => {
                Lit::Constant(product(irradiance) * facet.normal.dot(towards).max(0.0))
            }
            Light::Point { position, intensity } => {
                let light = position - scene.camera.eye;
                let height = facet.normal.dot(light) + facet.plane_distance;
                if height > 0.0 {
                    let square = square_to_light(light, &facet.inverse_depth, centred);
                    Lit::Point { factor: product(intensity) * height, square }
                } else {
                    Lit::Constant(0.0)
                }
            }
        };
        Self { unlit, lit }
    }

    /// Radiance at a position, in the light or out of it.
    pub fn at(&self, s: f64, t: f64, inverse_depth: f64, length_squared: f64, lit: bool) -> f64 {
        let gain = match &self.lit {
            _ if !lit => 0.0,
            Lit::Constant(value) => *value,
            Lit::Headlight { cosine, .. } => cosine.at(s, t) / length_squared.sqrt(),
            Lit::Point { factor, square } => {
                factor * (inverse_depth / square.at(s, t).sqrt()).powi(3)
            }
        };
        self.unlit + gain
    }

    /// Whether radiance is nothing but a factor of 1/t over |D| that f32 holds, for inverse depths
    /// in `depth_unit`s.
    pub fn is_factor(&self, depth_unit: f64) -> bool {
        match &self.lit {
            Lit::Headlight { factor, .. } => {
                self.unlit == 0.0 && ((factor * depth_unit) as f32).is_finite()
            }
            Lit::Constant(_) | Lit::Point { .. } => false,
        }
    }

    /// Whether a shadow would make a difference.
    pub fn is_lit(&self) -> bool {
        !matches!(self.lit, Lit::Constant(value) if value == 0.0)
    }

    /// Whether a point light is so near to the facet's plane that f32 would lose its |l w - D|²,
    /// which it rounds by 1e-7 of the greatest: that spans more than a hundredfold in the pixel,
    /// and the light is nearer than half as far as the eye, whose |D|² is `length_squared`.
    /// Where w alone is small, at a horizon, nothing is lost.
    pub fn is_next_to_light(&self, length_squared: f64) -> bool {
        const MOST: f64 = 100.0;
        match &self.lit {
            Lit::Point { factor, square } if *factor != 0.0 => {
                let [least, greatest] = square.convex_range();
                let is_finite = least.is_finite() && greatest.is_finite();
                !is_finite || greatest > MOST * least && least < 0.25 * length_squared
            }
            _ => false,
        }
    }

    /// Fills the shading fields, relative to the pixel's ground value and for inverse depths in
    /// `depth_unit`s, a power of two.
    pub fn write(
        &self,
        shading: Shading,
        ground: f64,
        inverse_root: &Quadratic,
        depth_unit: f64,
        out: &mut Facet32,
    ) {
        out.shade[0] = (self.unlit - ground) as f32;
        match &self.lit {
            Lit::Constant(value) => {
                out.is_flat = true;
                // Takes any w to 0 under a point light: the facet is turned away from it.
                out.to_light[0] = 1.0;
                match shading {
                    Shading::Headlight | Shading::Polynomial | Shading::WideHeadlight => {
                        out.shade[0] = (self.unlit + value - ground) as f32;
                    }
                    Shading::Directional | Shading::Point => out.shade_gain[0] = *value as f32,
                }
            }
            Lit::Headlight { cosine, .. } if shading == Shading::WideHeadlight => {
                out.shade_gain = [cosine.c, cosine.s, cosine.t].map(|x| x as f32);
            }
            Lit::Headlight { cosine, factor } => {
                let mut radiance = inverse_root.times(cosine);
                radiance.c += self.unlit - ground;
                out.shade = coefficients(&radiance);
                out.is_flat = radiance.is_constant();
                if shading == Shading::Headlight {
                    out.shade_gain[0] = (factor * depth_unit) as f32;
                }
            }
            Lit::Point { factor, square } => {
                // In units of its middle value, so that the root and the cube stay in range.
                let unit = square.c.sqrt();
                out.to_light = coefficients(&square.scaled(unit.powi(-2)));
                out.shade_gain[0] = (factor * unit.powi(-3) * depth_unit.powi(3)) as f32;
            }
        }
    }
}

/// |l w - D|² over the pixel, w = 1/t on the facet.
fn square_to_light(light: DVec3, inverse_depth: &Affine, centred: &CentredFrame) -> Quadratic {
    let c = light * inverse_depth.c - centred.dc;
    let s = light * inverse_depth.s - centred.du;
    let t = light * inverse_depth.t - centred.dv;
    CentredFrame { dc: c, du: s, dv: t }.length_squared()
}

fn channel_product(channel: Channel, material: &Material, light: Rgb) -> f64 {
    channel.of(std::array::from_fn(|i| material.kd[i] * light[i]))
}

pub(crate) fn coefficients(q: &Quadratic) -> [f32; 6] {
    [q.c, q.s, q.t, q.ss, q.st, q.tt].map(|x| x as f32)
}
