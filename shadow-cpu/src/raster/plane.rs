//! Depth planes: how deep a triangle is at each pixel.

use std::ops::{Add, Div, Mul, Sub};

use super::{
    RasterRules,
    transform::{Viewpoint, WindowVertex},
};
use crate::kernel::MultiplyAdd;

/// Depth as a function of the pixel: `origin + dx x + dy y` at its centre. Of one triangle, or of eight.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DepthPlane<F = f32> {
    pub(crate) origin: F,
    pub(crate) dx: F,
    pub(crate) dy: F,
}

impl<F: Copy + Add<Output = F> + Sub<Output = F> + Mul<Output = F> + Div<Output = F>> DepthPlane<F> {
    /// The plane through three points of the window: x and y in pixels, z as depth. `one` and `half` are those of `F`.
    #[inline(always)]
    pub(super) fn through([p0, p1, p2]: [[F; 3]; 3], one: F, half: F) -> Self {
        let (dx01, dy01) = (p0[0] - p1[0], p0[1] - p1[1]);
        let (dx20, dy20) = (p2[0] - p0[0], p2[1] - p0[1]);
        let inverse_area = one / (dx01 * dy20 - dy01 * dx20);
        let dz01 = p0[2] - p1[2];
        let dz20 = p2[2] - p0[2];
        let dx = dz01 * (dy20 * inverse_area) - dz20 * (dy01 * inverse_area);
        let dy = dz20 * (dx01 * inverse_area) - dz01 * (dx20 * inverse_area);
        let origin = p0[2] - (dx * (p0[0] - half) + dy * (p0[1] - half));
        Self { origin, dx, dy }
    }
}

/// The depth plane of [`DepthPlaneRule::Snapped`](super::DepthPlaneRule::Snapped): `(z0 + dy (y - y0)) + dx (x - x0)` at the centre of a pixel, from one of the triangle's corners on.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CornerPlane {
    /// The corner, in pixels from the first pixel's centre, and its depth.
    pub(crate) x0: f32,
    pub(crate) y0: f32,
    pub(crate) z0: f32,
    pub(crate) dx: f32,
    pub(crate) dy: f32,
}

/// What [`DepthPlaneRule::Snapped`](super::DepthPlaneRule::Snapped) takes from a triangle before it is clipped.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WholeTriangle {
    pub(crate) plane: CornerPlane,
    /// Twice its signed area on the grid, as it is in f32: its sign is the way that every part of the triangle must wind, or is not drawn.
    pub(crate) area: f32,
}

impl WholeTriangle {
    /// The triangle with these corners in clip space, behind the eye or not, as they lie on the grid.
    ///
    /// Its plane is counted from the corner that is farthest by w, and of several from the one that SwiftShader comes to: it goes around the triangle once to the lowest and once to the farthest.
    #[inline(always)]
    pub(crate) fn new<M: MultiplyAdd>(corners: [[f32; 4]; 3], view: &Viewpoint, rules: &RasterRules) -> Self {
        let on_grid = |corners: [[f32; 4]; 3]| corners.map(|corner| view.window::<M>(corner, rules.grid()));
        let [x, y] = {
            let corners = on_grid(corners);
            [corners.map(|corner| corner.grid_x as f32), corners.map(|corner| corner.grid_y as f32)]
        };
        let area = (y[0] - y[2]) * x[1] + (y[2] - y[1]) * x[0] + (y[1] - y[0]) * x[2];
        // Seen through the eye a triangle winds the other way.
        let is_turned = corners.iter().filter(|corner| corner[3].is_sign_negative()).count() % 2 == 1;
        let corners = turned_to_least(corners, |[_, y, _, _]| y);
        let corners = turned_to_least(corners, |[_, _, _, w]| -w);
        let plane = CornerPlane::through(on_grid(corners), rules.subpixel_scale());
        Self { plane, area: if is_turned { -area } else { area } }
    }
}

impl CornerPlane {
    /// The plane through three vertices on a grid of so many steps a pixel, from the first of them on.
    #[inline(always)]
    fn through([v0, v1, v2]: [WindowVertex; 3], scale: f32) -> Self {
        // Corners behind the eye can lie anywhere.
        let pixels = |from: i32, to: i32| to.wrapping_sub(from) as f32 / scale;
        let (x1, y1) = (pixels(v0.grid_x, v1.grid_x), pixels(v0.grid_y, v1.grid_y));
        let (x2, y2) = (pixels(v0.grid_x, v2.grid_x), pixels(v0.grid_y, v2.grid_y));
        let (z1, z2) = (v1.z - v0.z, v2.z - v0.z);
        let inverse_area = 1.0 / (x1 * y2 - x2 * y1);
        Self {
            x0: v0.grid_x as f32 / scale,
            y0: v0.grid_y as f32 / scale,
            z0: v0.z,
            dx: (y2 * z1 - y1 * z2) * inverse_area,
            dy: (x1 * z2 - x2 * z1) * inverse_area,
        }
    }
}

/// A triangle from another corner on: by one if the second has the least of something, and by two more if the third has.
#[inline(always)]
fn turned_to_least(mut corners: [[f32; 4]; 3], value: impl Fn([f32; 4]) -> f32) -> [[f32; 4]; 3] {
    let values = corners.map(value);
    let least = values[0].min(values[1]).min(values[2]);
    let turns = usize::from(values[1] == least) + 2 * usize::from(values[2] == least);
    corners.rotate_left(turns % 3);
    corners
}
