//! What a camera's pass tells the plan: the points that are seen, and the largest plane among them.

use std::collections::HashMap;

use shadow_math::{
    glam::{DVec4, Vec3},
    plan::CameraPlan,
    triangle::pixel_ray,
};

use crate::{NO_TRIANGLE, Scene};

/// What a camera sees, for plans that follow it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Feedback {
    /// The points of the surfaces behind its pixels, in metres relative to the scene's origin; pixels that show nothing have none.
    pub samples: Vec<Vec3>,
    /// The plane that the most pixels show, as `(normal, offset)` with `normal . point + offset = 0` and a unit normal; `None` where nothing is seen.
    pub plane: Option<DVec4>,
    /// Whether a camera's pass was looked at. One that sees nothing has no samples either, and fits then follow its frustum, where nothing is to be shadowed.
    pub is_seen: bool,
}

impl Feedback {
    /// What `camera` sees, from its triangle layer.
    ///
    /// Triangles are of one plane if their normals, and their distances from the origin over the scene's size, are the same when rounded to 1024 steps; the plane is that of the
    /// one of them that most pixels show, the first of several.
    ///
    /// # Panics
    ///
    /// If the layer has other pixels than the camera's picture, or triangles that the scene does not have.
    #[must_use]
    pub fn of(scene: &Scene, camera: &CameraPlan, triangles: &[u32]) -> Self {
        assert_eq!(triangles.len(), camera.width as usize * camera.height as usize, "the layer must have the picture's size");
        let mut samples = Vec::with_capacity(triangles.len());
        let mut shown: HashMap<u32, u64> = HashMap::new();
        for (pixel, &triangle) in triangles.iter().enumerate().filter(|(_, triangle)| **triangle != NO_TRIANGLE) {
            let (x, y) = (pixel % camera.width as usize, pixel / camera.width as usize);
            let ray = pixel_ray(&camera.rays, x as f32 + 0.5, y as f32 + 0.5);
            samples.push(scene.point(triangle, ray).point);
            *shown.entry(triangle).or_default() += 1;
        }
        Self { samples, plane: largest_plane(scene, shown), is_seen: true }
    }
}

/// The plane of most pixels; `shown` says how many show each triangle.
fn largest_plane(scene: &Scene, shown: HashMap<u32, u64>) -> Option<DVec4> {
    /// How many steps a normal's coordinate has from 0 to 1, and the scene's size.
    const STEPS: f64 = 1024.0;
    let size = f64::from(scene.bounds().radius()).max(f64::MIN_POSITIVE);
    let mut shown: Vec<(u32, u64)> = shown.into_iter().collect();
    // The order of a map is none: the most shown come first, and of equals the first in the scene.
    shown.sort_unstable_by_key(|&(triangle, pixels)| (core::cmp::Reverse(pixels), triangle));
    let mut planes: HashMap<[i64; 4], (DVec4, u64)> = HashMap::new();
    for &(triangle, pixels) in &shown {
        let Some(plane) = plane_of(scene, triangle) else { continue };
        let key = [plane.x * STEPS, plane.y * STEPS, plane.z * STEPS, plane.w / size * STEPS].map(|x| x.round() as i64);
        planes.entry(key).or_insert((plane, 0)).1 += pixels;
    }
    let by_size = |a: &(DVec4, u64), b: &(DVec4, u64)| {
        a.1.cmp(&b.1).then_with(|| b.0.to_array().partial_cmp(&a.0.to_array()).unwrap_or(core::cmp::Ordering::Equal))
    };
    planes.into_values().max_by(by_size).map(|(plane, _)| plane)
}

/// The plane of a triangle, with the normal's largest coordinate above 0, so that both sides have one; `None` for one without area.
fn plane_of(scene: &Scene, triangle: u32) -> Option<DVec4> {
    let [a, b, c] = scene.triangles()[triangle as usize].map(|vertex| scene.vertices().positions[vertex as usize].as_dvec3());
    let normal = (b - a).cross(c - a).try_normalize()?;
    let largest = normal.to_array().into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let normal = if largest < 0.0 { -normal } else { normal };
    Some(normal.extend(-normal.dot((a + b + c) / 3.0)))
}
