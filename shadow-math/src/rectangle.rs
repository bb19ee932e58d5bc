//! Stub.
use glam::DVec2;
/// R
#[derive(Clone, Copy, Debug)]
pub struct Rectangle {
    /// c
    pub center: DVec2,
    /// a
    pub axis: DVec2,
    /// h
    pub half: DVec2,
}
/// h
pub fn convex_hull(points: &[DVec2], hull: &mut [DVec2]) -> usize {
    hull[..points.len()].copy_from_slice(points);
    points.len()
}
/// s
pub fn smallest_rectangle(hull: &[DVec2]) -> Rectangle {
    let mut best = (f64::INFINITY, Rectangle { center: DVec2::ZERO, axis: DVec2::X, half: DVec2::ZERO });
    for a in hull {
        for b in hull {
            let axis = (*b - *a).normalize_or(DVec2::X);
            let f = |d: DVec2| hull.iter().map(|p| d.dot(*p)).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            let (x, y) = (f(axis), f(axis.perp()));
            let area = (x.1 - x.0) * (y.1 - y.0);
            if area < best.0 {
                best = (area, Rectangle { center: DVec2::ZERO, axis, half: DVec2::ZERO });
            }
        }
    }
    best.1
}
