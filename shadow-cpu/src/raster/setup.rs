//! A triangle's edge functions and depth plane.

use super::{DepthPlaneRule, RasterRules, transform::WindowVertex};

/// A triangle ready to be sampled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleSetup {
    /// The index of the triangle.
    pub(crate) id: u32,
    /// The first and last columns and rows of pixel centres in its bounding box.
    pub(crate) min_x: u16,
    pub(crate) max_x: u16,
    pub(crate) min_y: u16,
    pub(crate) max_y: u16,
    /// A sample at pixel (x, y) is inside if `edge_c - edge_a * x + edge_b * y >= 0` for all three edges: whole pixels, the top-left rule
    /// included.
    pub(crate) edge_a: [i32; 3],
    pub(crate) edge_b: [i32; 3],
    pub(crate) edge_c: [i64; 3],
    /// Depth at the centre of pixel (0, 0), and its change per pixel.
    pub(crate) z: f32,
    pub(crate) dz_dx: f32,
    pub(crate) dz_dy: f32,
}

/// Which way a triangle may face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Culling {
    /// Either way.
    None,
    /// Only counter-clockwise on the screen.
    Back,
}

/// The limits of what is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

/// Sets a triangle up; `None` if it covers no sample, has no area on the grid, or is culled.
#[inline(always)]
pub(crate) fn setup_triangle(
    id: u32,
    v0: &WindowVertex,
    v1: &WindowVertex,
    v2: &WindowVertex,
    culling: Culling,
    extent: Extent,
    rules: &RasterRules,
) -> Option<TriangleSetup> {
    // The bounding box in whole pixels comes first: most triangles of a dense mesh miss every pixel centre.
    let bits = rules.subpixel_bits;
    let round_up = (1 << bits) - 1;
    let min_x = (v0.grid_x.min(v1.grid_x).min(v2.grid_x) + round_up) >> bits;
    let max_x = v0.grid_x.max(v1.grid_x).max(v2.grid_x) >> bits;
    let min_y = (v0.grid_y.min(v1.grid_y).min(v2.grid_y) + round_up) >> bits;
    let max_y = v0.grid_y.max(v1.grid_y).max(v2.grid_y) >> bits;
    let (min_x, max_x) = (min_x.max(0), max_x.min(extent.width as i32 - 1));
    let (min_y, max_y) = (min_y.max(0), max_y.min(extent.height as i32 - 1));
    if min_x > max_x || min_y > max_y {
        return None;
    }

    let area = i64::from(v0.grid_x - v1.grid_x) * i64::from(v2.grid_y - v0.grid_y)
        - i64::from(v2.grid_x - v0.grid_x) * i64::from(v0.grid_y - v1.grid_y);
    if area == 0 || (area < 0 && culling == Culling::Back) {
        return None;
    }
    let (v1, v2) = if area < 0 { (v2, v1) } else { (v1, v2) };

    let mut edge_a = [0; 3];
    let mut edge_b = [0; 3];
    let mut edge_c = [0; 3];
    for (edge, (from, to)) in [(v0, v1), (v1, v2), (v2, v0)].into_iter().enumerate() {
        let a = from.grid_y - to.grid_y;
        let b = from.grid_x - to.grid_x;
        let mut c = i64::from(a) * i64::from(from.grid_x) - i64::from(b) * i64::from(from.grid_y);
        // The top-left rule: samples exactly on such an edge are inside.
        if a < 0 || (a == 0 && b >= 0) {
            c += 1;
        }
        edge_a[edge] = a;
        edge_b[edge] = b;
        // c > 0 in steps of the grid's square, and (c - 1) >> bits >= 0 in whole pixels, are the same test.
        edge_c[edge] = (c - 1) >> bits;
    }

    let [p0, p1, p2] = [v0, v1, v2].map(|v| match rules.depth_plane {
        DepthPlaneRule::Unsnapped => (v.x, v.y),
        DepthPlaneRule::Snapped => {
            (v.grid_x as f32 / rules.subpixel_scale() + 0.5, v.grid_y as f32 / rules.subpixel_scale() + 0.5)
        }
    });
    let (dx01, dy01) = (p0.0 - p1.0, p0.1 - p1.1);
    let (dx20, dy20) = (p2.0 - p0.0, p2.1 - p0.1);
    let inverse_area = 1.0 / (dx01 * dy20 - dy01 * dx20);
    let dz01 = v0.z - v1.z;
    let dz20 = v2.z - v0.z;
    let dz_dx = dz01 * (dy20 * inverse_area) - dz20 * (dy01 * inverse_area);
    let dz_dy = dz20 * (dx01 * inverse_area) - dz01 * (dx20 * inverse_area);
    let z = v0.z - (dz_dx * (p0.0 - 0.5) + dz_dy * (p0.1 - 0.5));

    Some(TriangleSetup {
        id,
        min_x: min_x as u16,
        max_x: max_x as u16,
        min_y: min_y as u16,
        max_y: max_y as u16,
        edge_a,
        edge_b,
        edge_c,
        z,
        dz_dx,
        dz_dy,
    })
}
