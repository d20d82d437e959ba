//! What a pixel integrates over besides its square: the axes of distribution ray tracing
//! (R. L. Cook, T. Porter, L. Carpenter, *Distributed Ray Tracing*, SIGGRAPH 1984).

use super::Rgb;
use glam::{DVec3, dvec3};
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// The features of a scene that add dimensions, or branches, to every pixel. All absent by
/// default.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Distribution {
    /// A lens instead of a pinhole: +2 dimensions.
    pub lens: Option<Lens>,
    /// Lights with an area: +2 dimensions each.
    pub lights: Vec<AreaLight>,
    /// What moves while the shutter is open: +1 dimension.
    pub motion: Option<Motion>,
    /// Mirrors and glass followed one after another; no dimension. 0 shades them as if they
    /// were neither.
    pub specular_depth: u32,
    /// Diffuse reflections followed: +2 dimensions each.
    pub bounces: u32,
}

impl Distribution {
    /// The most mirrors and panes that are followed: glass doubles the rays each time.
    pub const MAX_SPECULAR_DEPTH: u32 = 8;
    /// The most diffuse reflections that are followed.
    pub const MAX_BOUNCES: u32 = 8;
    /// The most area lights.
    pub const MAX_LIGHTS: usize = 256;

    /// Whether the pixel's square is all there is to integrate over.
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }

    /// Dimensions of a pixel's integral.
    pub fn dim(&self) -> usize {
        let lens = if self.lens.is_some() { 2 } else { 0 };
        let time = usize::from(self.motion.is_some());
        2 + lens + 2 * self.lights.len() + time + 2 * self.bounces as usize
    }

    /// Irradiance over π at a point from one point of each area light, chosen by two of the
    /// `coordinates` each. `cosine` gets a light's number and the way to it, and gives the
    /// surface's cosine, 0 where the light does not reach.
    #[inline(always)]
    pub(crate) fn irradiance(
        &self,
        point: DVec3,
        coordinates: &[f64],
        mut cosine: impl FnMut(usize, DVec3) -> f64,
    ) -> Rgb {
        let mut sum = [0.0; 3];
        let choices = self.lights.iter().zip(coordinates.chunks_exact(2));
        for (number, (light, at)) in choices.enumerate() {
            let Some(sample) = light.sample(point, at[0], at[1]) else { continue };
            let gain = sample.weight * cosine(number, sample.to_light);
            sum = std::array::from_fn(|i| sum[i] + gain * light.radiance[i]);
        }
        sum
    }

    /// Names of the axes of a pixel's integral, in the order of a point's coordinates. Time is
    /// the last, so that what takes two coordinates has two that samplers pad together.
    pub fn axes(&self) -> Vec<String> {
        let pair = |name: &str| [format!("{name}_u"), format!("{name}_v")];
        let numbered = |name: &str, number: usize, of: usize| match of {
            1 => pair(name),
            _ => pair(&format!("{name}_{}", number + 1)),
        };
        let mut axes = vec!["pixel_x".to_owned(), "pixel_y".to_owned()];
        axes.extend(self.lens.iter().flat_map(|_| pair("lens")));
        let lights = self.lights.len();
        axes.extend((0..lights).flat_map(|i| numbered("light", i, lights)));
        let bounces = self.bounces as usize;
        axes.extend((0..bounces).flat_map(|i| numbered("bounce", i, bounces)));
        axes.extend(self.motion.iter().map(|_| "time".to_owned()));
        axes
    }
}

/// A thin lens: what lies in the plane at `focus_distance` is sharp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Radius of the aperture, in units of the scene; above 0.
    pub radius: f64,
    /// Distance of the plane of focus from the eye, along the view.
    pub focus_distance: f64,
    /// Its shape.
    pub aperture: Aperture,
}

/// Shape of a lens's opening, inscribed in the circle of its radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Aperture {
    /// A full circle.
    Disk,
    /// A regular polygon.
    Blades {
        /// Number of corners, at least 3.
        blades: u32,
        /// Angle of the first corner against the picture's horizontal, in degrees.
        rotation: f64,
    },
}

impl Lens {
    /// The point of the aperture, right and up from its middle, for (u, v) in [0, 1)²; uniform
    /// over its area.
    pub fn point(&self, u: f64, v: f64) -> [f64; 2] {
        let [x, y] = match self.aperture {
            Aperture::Disk => disk(u, v),
            Aperture::Blades { blades, rotation } => polygon(blades, rotation, u, v),
        };
        [x * self.radius, y * self.radius]
    }
}

/// The concentric map of the unit square to the unit disk: it keeps areas and, nearly, shapes
/// (P. Shirley, K. Chiu, *A Low Distortion Map Between Disk and Square*, Journal of Graphics
/// Tools 2(3), 1997).
pub(crate) fn disk(u: f64, v: f64) -> [f64; 2] {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0; 2];
    }
    let (radius, angle) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * (b / a)) } else { (b, FRAC_PI_4 * (2.0 - a / b)) };
    let (sin, cos) = angle.sin_cos();
    [radius * cos, radius * sin]
}

/// A fan of triangles about the middle: u chooses the triangle and the direction in it, v the
/// distance.
fn polygon(blades: u32, rotation: f64, u: f64, v: f64) -> [f64; 2] {
    let along = u * f64::from(blades);
    let corner = |i: f64| {
        let angle = rotation.to_radians() + i * TAU / f64::from(blades);
        [angle.cos(), angle.sin()]
    };
    let (a, b, t) = (corner(along.floor()), corner(along.floor() + 1.0), along.fract());
    let radius = v.sqrt();
    std::array::from_fn(|i| radius * (a[i] + t * (b[i] - a[i])))
}

/// A light with an area that sends `radiance` in all directions from both sides.
///
/// It lights surfaces, and is itself seen only where it is a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct AreaLight {
    /// Where it is.
    pub shape: LightShape,
    /// What it sends.
    pub radiance: Rgb,
}

/// Shape of an area light.
#[derive(Debug, Clone, PartialEq)]
pub enum LightShape {
    /// A parallelogram.
    Rectangle {
        /// One corner.
        corner: DVec3,
        /// The two sides that meet there.
        edges: [DVec3; 2],
    },
    /// A flat disk.
    Disk {
        /// Its middle.
        centre: DVec3,
        /// Two perpendicular radii.
        radii: [DVec3; 2],
    },
    /// A sphere; only the cap that a point can see is sampled.
    Sphere {
        /// Its middle.
        centre: DVec3,
        /// Its radius.
        radius: f64,
    },
    /// Triangles of an emissive material.
    Mesh {
        /// The material that the triangles have.
        material: u32,
        /// The triangles, each with the share of area up to and including it; the last is 1.
        triangles: Vec<(f64, [DVec3; 3])>,
        /// Area of all.
        area: f64,
    },
}

/// Share of the way to a sample of a light on which something may stand before it: the light
/// itself does not stand in its own way.
pub(crate) const SHORT_OF_THE_LIGHT: f64 = 1.0 - 1e-9;

/// One sample of a light as a surface point sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LightSample {
    /// From the point to the light; the light is met at the vector's end.
    pub to_light: DVec3,
    /// Irradiance over π on a surface that faces the sample, per unit of radiance.
    pub weight: f64,
}

impl AreaLight {
    /// The share of the light that (u, v) in [0, 1)² stands for, seen from `point`; none where
    /// it sends nothing there.
    #[inline]
    pub(crate) fn sample(&self, point: DVec3, u: f64, v: f64) -> Option<LightSample> {
        let (on_light, area_normal) = match &self.shape {
            LightShape::Rectangle { corner, edges: [a, b] } => {
                (corner + a * u + b * v, a.cross(*b))
            }
            LightShape::Disk { centre, radii: [a, b] } => {
                let [x, y] = disk(u, v);
                (centre + a * x + b * y, a.cross(*b) * PI)
            }
            LightShape::Sphere { centre, radius } => return cap(point, *centre, *radius, u, v),
            LightShape::Mesh { triangles, area, .. } => {
                let (corners, u) = pick(triangles, u)?;
                let [a, b, c] = corners;
                // Uniform over the triangle, and continuous in (u, v).
                let root = u.sqrt();
                let normal = (b - a).cross(c - a).normalize_or_zero();
                (a * (1.0 - root) + (b * (1.0 - v) + c * v) * root, normal * *area)
            }
        };
        let to_light = on_light - point;
        let distance_squared = to_light.length_squared();
        let weight =
            (area_normal.dot(to_light)).abs() / (distance_squared * distance_squared.sqrt() * PI);
        (weight > 0.0 && weight.is_finite()).then_some(LightSample { to_light, weight })
    }
}

impl AreaLight {
    /// A box that holds all of the light.
    pub(crate) fn bounds(&self) -> [DVec3; 2] {
        let of = |points: &mut dyn Iterator<Item = DVec3>| {
            points
                .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[lo, hi], p| [lo.min(p), hi.max(p)])
        };
        match &self.shape {
            LightShape::Rectangle { corner, edges: [a, b] } => {
                of(&mut [DVec3::ZERO, *a, *b, a + b].map(|p| corner + p).into_iter())
            }
            LightShape::Disk { centre, radii: [a, b] } => {
                let extent = (a * a + b * b).to_array().map(f64::sqrt);
                [centre - DVec3::from_array(extent), centre + DVec3::from_array(extent)]
            }
            LightShape::Sphere { centre, radius } => [centre - *radius, centre + *radius],
            LightShape::Mesh { triangles, .. } => {
                of(&mut triangles.iter().flat_map(|(_, corners)| *corners))
            }
        }
    }
}

/// The triangle that a share of the area falls into, and where in it, in [0, 1).
fn pick(triangles: &[(f64, [DVec3; 3])], share: f64) -> Option<([DVec3; 3], f64)> {
    let at = triangles.partition_point(|(up_to, _)| *up_to <= share);
    let (up_to, corners) = triangles.get(at)?;
    let from = at.checked_sub(1).map_or(0.0, |before| triangles[before].0);
    Some((*corners, ((share - from) / (up_to - from)).clamp(0.0, 1.0)))
}

/// Uniform over the solid angle of a sphere seen from outside (P. Shirley, C. Wang,
/// K. Zimmerman, *Monte Carlo Techniques for Direct Lighting Calculations*, ACM Transactions on
/// Graphics 15(1), 1996); from inside, over all directions.
fn cap(point: DVec3, centre: DVec3, radius: f64, u: f64, v: f64) -> Option<LightSample> {
    let to_centre = centre - point;
    let distance = to_centre.length();
    let axis = to_centre.try_normalize().unwrap_or(DVec3::Z);
    let sine_squared = (radius / distance).powi(2);
    // 1 - cos θmax, without the cancellation for a small sphere.
    let cap_height =
        if sine_squared < 1.0 { sine_squared / (1.0 + (1.0 - sine_squared).sqrt()) } else { 2.0 };
    let cosine = 1.0 - u * cap_height;
    let sine = (u * cap_height * (1.0 + cosine)).max(0.0).sqrt();
    let (sin, cos) = (v * TAU).sin_cos();
    let [a, b] = around(axis);
    let direction = axis * cosine + (a * cos + b * sin) * sine;
    // Where it meets the sphere: first from outside, last from inside.
    let middle = distance * cosine;
    let half = (radius * radius - (distance * sine).powi(2)).max(0.0).sqrt();
    let length = if sine_squared < 1.0 { middle - half } else { middle + half };
    // Solid angle over π.
    let weight = 2.0 * cap_height;
    (length > 0.0 && weight > 0.0).then_some(LightSample { to_light: direction * length, weight })
}

/// Two unit vectors that complete a unit vector to a right-handed frame (T. Duff et al.,
/// *Building an Orthonormal Basis, Revisited*, Journal of Computer Graphics Techniques 6(1),
/// 2017).
pub(crate) fn around(n: DVec3) -> [DVec3; 2] {
    let sign = 1f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [dvec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), dvec3(b, sign + n.y * n.y * a, -n.y)]
}

/// What moves while the shutter is open, evenly and along straight lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// How far the eye and its target move.
    pub camera: DVec3,
    /// How far each of the mesh's vertices moves.
    pub vertices: Vec<DVec3>,
}
