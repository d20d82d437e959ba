//! The pinhole camera.

use super::MAX_COORDINATE;
use crate::rng::StreamKey;
use glam::DVec3;

/// A pinhole camera with square-on pixels; pixel (0, 0) is the top-left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Where the eye is.
    pub eye: DVec3,
    /// The point in the middle of the picture.
    pub look_at: DVec3,
    /// Any vector that points up in the picture.
    pub up: DVec3,
    /// Vertical field of view in degrees, between 0 and 180.
    pub fov_y: f64,
    /// Pixels: width, height.
    pub resolution: [u32; 2],
}

/// A camera that shows nothing, and how to mend it.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraFault {
    /// A coordinate that is not finite, or too large to be meant.
    #[error("camera {name} is {value:?}; coordinates are numbers within ±1e15")]
    Coordinate {
        /// The vector.
        name: &'static str,
        /// Its value.
        value: [f64; 3],
    },
    /// No direction of view.
    #[error("camera eye and look_at are the same point {eye:?}; move one of them")]
    NoDirection {
        /// Both.
        eye: [f64; 3],
    },
    /// No orientation of the picture.
    #[error("camera up {up:?} is zero or parallel to the view; choose another, such as [0, 0, 1]")]
    NoUp {
        /// The vector.
        up: [f64; 3],
    },
    /// A field of view that no plane can show.
    #[error("camera fov_y is {fov_y} degrees; it lies between 0 and 180")]
    FieldOfView {
        /// Degrees.
        fov_y: f64,
    },
    /// No pixels, or more than random streams can address.
    #[error("camera resolution is {resolution:?}; each side has 1 to 2^20 pixels")]
    Resolution {
        /// Width, height.
        resolution: [u32; 2],
    },
}

/// The rays of one pixel: offset (u, v) in [0, 1)², v down, looks along `d0 + u du + v dv`.
/// Not normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelFrame {
    /// Direction of the pixel's top-left corner.
    pub d0: DVec3,
    /// Change of direction across the pixel.
    pub du: DVec3,
    /// Change of direction down the pixel.
    pub dv: DVec3,
}

impl PixelFrame {
    /// Direction at an offset.
    #[inline]
    pub fn direction(&self, u: f64, v: f64) -> DVec3 {
        self.d0 + self.du * u + self.dv * v
    }

    /// The square of side `2 radius` pixels about the same centre.
    pub fn widened(&self, radius: f64) -> Self {
        let Self { d0, du, dv } = *self;
        let side = 2.0 * radius;
        Self { d0: d0 + (du + dv) * (0.5 - radius), du: du * side, dv: dv * side }
    }
}

impl Camera {
    /// Whether the camera shows anything: every ray of every pixel is then a finite direction
    /// other than zero.
    ///
    /// # Errors
    /// [`CameraFault`] says what is wrong and how to mend it.
    pub fn check(&self) -> Result<(), CameraFault> {
        for (name, v) in [("eye", self.eye), ("look_at", self.look_at), ("up", self.up)] {
            if !v.to_array().iter().all(|x| x.abs() <= MAX_COORDINATE) {
                return Err(CameraFault::Coordinate { name, value: v.to_array() });
            }
        }
        let forward = (self.look_at - self.eye).try_normalize();
        let Some(forward) = forward else {
            return Err(CameraFault::NoDirection { eye: self.eye.to_array() });
        };
        // Below this angle the frame would be mostly rounding.
        let sine = self.up.try_normalize().map_or(0.0, |up| forward.cross(up).length());
        if sine < 1e-9 {
            return Err(CameraFault::NoUp { up: self.up.to_array() });
        }
        // Beyond these the tangent leaves the range in which rays can be told apart.
        if !(1e-9..=180.0 - 1e-9).contains(&self.fov_y) {
            return Err(CameraFault::FieldOfView { fov_y: self.fov_y });
        }
        let [w, h] = self.resolution;
        let sides = 1..=StreamKey::MAX_PIXEL;
        if !sides.contains(&w) || !sides.contains(&h) {
            return Err(CameraFault::Resolution { resolution: self.resolution });
        }
        Ok(())
    }

    /// Orthonormal frame: forward, right, up.
    pub fn frame(&self) -> [DVec3; 3] {
        let forward = (self.look_at - self.eye).normalize();
        let right = forward.cross(self.up).normalize();
        [forward, right, right.cross(forward)]
    }

    /// The rays of pixel (x, y). With f, r, u the camera's frame: pixel offset (a, b) looks along
    /// f + (2(x+a)/W - 1) tan(fov/2) (W/H) r + (1 - 2(y+b)/H) tan(fov/2) u.
    pub fn pixel(&self, [x, y]: [u32; 2]) -> PixelFrame {
        let [forward, right, up] = self.frame();
        let [w, h] = self.resolution.map(f64::from);
        let tan = (self.fov_y.to_radians() / 2.0).tan();
        let (right, up) = (right * (tan * w / h), up * tan);
        PixelFrame {
            d0: forward
                + right * (2.0 * f64::from(x) / w - 1.0)
                + up * (1.0 - 2.0 * f64::from(y) / h),
            du: right * (2.0 / w),
            dv: up * (-2.0 / h),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            eye: DVec3::new(0.0, 1.6, 0.0),
            look_at: DVec3::new(0.0, -0.5, 10.0),
            up: DVec3::Y,
            fov_y: 45.0,
            resolution: [320, 200],
        }
    }

    #[test]
    fn the_middle_of_the_picture_looks_at_the_target() {
        let camera = camera();
        let middle = camera.pixel([160, 100]).direction(0.0, 0.0).normalize();
        assert!(middle.distance((camera.look_at - camera.eye).normalize()) < 1e-15);
    }

    #[test]
    fn the_edges_of_the_picture_span_the_field_of_view() {
        let camera = camera();
        let [forward, right, up] = camera.frame();
        let tan = (camera.fov_y.to_radians() / 2.0).tan();
        let top_left = camera.pixel([0, 0]).direction(0.0, 0.0);
        let bottom_right = camera.pixel([319, 199]).direction(1.0, 1.0);
        let corner = |x: f64, y: f64| forward + right * (x * tan * 1.6) + up * (y * tan);
        assert!(top_left.distance(corner(-1.0, 1.0)) < 1e-15);
        assert!(bottom_right.distance(corner(1.0, -1.0)) < 1e-14);
        // Forward is +z and up is +y, so right is -x.
        assert!(top_left.x > 0.0 && bottom_right.x < 0.0);
    }

    #[test]
    fn neighbouring_pixels_meet() {
        let camera = camera();
        let right_edge = camera.pixel([41, 17]).direction(1.0, 0.3);
        let left_edge = camera.pixel([42, 17]).direction(0.0, 0.3);
        assert!(right_edge.distance(left_edge) < 1e-15);
    }
}
