//! The pinhole camera.

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
    pub fn direction(&self, u: f64, v: f64) -> DVec3 {
        self.d0 + self.du * u + self.dv * v
    }
}

impl Camera {
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
