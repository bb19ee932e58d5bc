//! Ray tracing: what the shadows should be.
//!
//! A [`Tracer`] answers two questions about a scene, in double precision: which triangle does a ray meet first, and is there anything
//! between two points? From these come the picture that the camera sees and the visibility of each light. No plan, no bias and no
//! filter is known here, so that a mistake in those cannot hide in the truth.
//!
//! ```
//! use shadow_cpu::trace::{CameraView, Tracer};
//! use shadow_scene::builtin;
//!
//! let scene = builtin::box_on_plane();
//! let tracer = Tracer::new(&scene, 0)?;
//! let view = CameraView::new(&scene.cameras()[0].camera, 64, 36);
//! let mut rays = tracer.rays();
//! let seen = rays.closest_seen(view.ray(32, 30)).expect("the plane fills the lower part of the picture");
//! let point = tracer.surface_point(&seen, view.ray(32, 30));
//! assert!(rays.sees_center(&point, &scene.lights()[0]), "in front of the box the plane is lit");
//! # Ok::<(), shadow_cpu::CpuError>(())
//! ```
//!
//! # What is seen, and what hides
//!
//! - Rays from the camera pass the back faces of single-sided materials; for rays toward lights every triangle has two sides.
//! - Where an alpha-tested material has a hole, neither kind of ray meets it. Blended materials are opaque.
//! - A triangle without an area is not there. Two triangles at the same distance are decided for the lower index.
//! - A surface whose geometric normal, turned to the viewer, does not face a light is not lit by it, and no ray is sent.
//! - From inside a closed body its walls are seen where their material is double-sided, and nothing of them where it is not; a light inside a closed body
//!   lights nothing outside, since casters are never culled. A surface on which a light lies does not hide it.
//! - A scene without triangles is background: nothing is seen, and everything is lit.

mod ray;
mod structure;
mod triangle;
mod walk;
mod near;
mod surface;
mod light;
pub mod confidence;
mod camera;
mod picture;
#[cfg(test)]
mod tests;

use glam::DVec3;
use rayon::{ThreadPool, ThreadPoolBuilder};
use shadow_math::material::{FLAG_DOUBLE_SIDED, FLAG_MASK};
use shadow_scene::{Pass, Scene, SceneLight, Surfaces};

pub(crate) use self::near::AROUND;
pub use self::{
    camera::CameraView,
    near::Clearance,
    picture::{Sampling, Seen, SeenLights},
    ray::{Hit, Ray},
    surface::SurfacePoint,
};
use self::{
    light::{Figure, ray_from_center, ray_to_center, stratified},
    near::is_nearly_met,
    structure::Structure,
    walk::{Waiting, Walk},
};
use crate::{kernel::dispatch, renderer::CpuError};

/// A scene that rays can be sent through, and the threads that send them.
#[derive(Debug)]
pub struct Tracer<'a> {
    scene: &'a Scene,
    structure: Structure,
    /// The surfaces, where any of them has holes or lets the camera through.
    surfaces: Surfaces,
    /// The index of the first triangle whose material is alpha-tested.
    first_masked: u32,
    /// Whether every triangle casts shadows.
    is_all_cast: bool,
    threads: ThreadPool,
}

/// Rays of one thread: they share the memory in which boxes wait.
#[derive(Debug)]
pub struct Rays<'a> {
    tracer: &'a Tracer<'a>,
    stack: Vec<Waiting>,
    sent: u64,
}

impl<'a> Tracer<'a> {
    /// Builds the tree of boxes around a scene, and starts `threads` threads, 0 for one a core.
    ///
    /// # Errors
    ///
    /// [`CpuError::Threads`].
    pub fn new(scene: &'a Scene, threads: usize) -> Result<Self, CpuError> {
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|index| format!("shadow-trace {index}"))
            .build()
            .map_err(|source| CpuError::Threads { threads, source })?;
        let first_masked = scene.pass_triangles(Pass::MaskSingleSided).start;
        let structure = Structure::new(scene);
        let is_all_cast = Pass::ALL.into_iter().all(|pass| pass.casts_shadows() || scene.pass_triangles(pass).is_empty());
        Ok(Self { scene, structure, surfaces: Surfaces::of(scene), first_masked, is_all_cast, threads: pool })
    }

    /// Rays for one thread.
    #[must_use]
    pub fn rays(&self) -> Rays<'_> {
        Rays { tracer: self, stack: Vec::with_capacity(self.structure.stack_size), sent: 0 }
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// How many threads there are.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.threads.current_num_threads()
    }

    /// Runs work on the tracer's threads.
    pub(crate) fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.threads.install(work)
    }

    /// How many of the scene's triangles can be met: all but those without an area.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.structure.triangle_count
    }

    /// The corners of a triangle, exactly as the scene has them.
    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.scene.triangles()[triangle as usize].map(|corner| self.scene.vertices().positions[corner as usize].as_dvec3())
    }

    /// The point of a surface that a ray met, with its geometric normal turned to where the ray came from.
    ///
    /// # Panics
    ///
    /// If the hit is not of this scene.
    #[must_use]
    pub fn surface_point(&self, hit: &Hit, ray: Ray) -> SurfacePoint {
        SurfacePoint::of_triangle(hit.triangle, self.corners(hit.triangle), hit.u, hit.v, ray.direction())
    }

    /// Whether a triangle is there where a ray meets it: not in the holes of an alpha-tested material.
    #[inline]
    fn is_there(&self, hit: &Hit) -> bool {
        if hit.triangle < self.first_masked {
            return true;
        }
        let material = self.surfaces.material(self.scene, hit.triangle);
        let color = || self.surfaces.color(self.scene, hit.triangle, hit.u as f32, hit.v as f32);
        material.flags & FLAG_MASK == 0 || color().w >= material.alpha_cutoff
    }

    /// Whether a triangle hides what lies behind it from lights.
    #[inline]
    fn hides(&self, hit: &Hit) -> bool {
        self.is_there(hit) && (self.is_all_cast || self.scene.casts_shadow(hit.triangle))
    }

    /// Whether the camera sees a triangle from the side that a ray meets.
    #[inline]
    fn is_seen(&self, hit: &Hit) -> bool {
        let is_two_sided = || self.surfaces.material(self.scene, hit.triangle).flags & FLAG_DOUBLE_SIDED != 0;
        (!hit.is_back || is_two_sided()) && self.is_there(hit)
    }
}

impl Rays<'_> {
    /// How many rays were sent.
    #[must_use]
    pub fn sent(&self) -> u64 {
        self.sent
    }

    /// The first triangle that a ray of the camera meets.
    pub fn closest_seen(&mut self, ray: Ray) -> Option<Hit> {
        let tracer = self.tracer;
        self.walk::<false>(ray, |hit| tracer.is_seen(hit))
    }

    /// The first triangle, of either side, that a ray meets.
    pub fn closest(&mut self, ray: Ray) -> Option<Hit> {
        let tracer = self.tracer;
        self.walk::<false>(ray, |hit| tracer.is_there(hit))
    }

    /// The first triangle, of either side, that a ray meets and that casts shadows.
    pub fn closest_caster(&mut self, ray: Ray) -> Option<Hit> {
        let tracer = self.tracer;
        self.walk::<false>(ray, |hit| tracer.hides(hit))
    }

    /// Whether a ray meets any triangle, of either side, that casts shadows.
    pub fn is_blocked(&mut self, ray: Ray) -> bool {
        let tracer = self.tracer;
        self.walk::<true>(ray, |hit| tracer.hides(hit)).is_some()
    }

    /// The corners of a triangle, exactly as the scene has them.
    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.tracer.corners(triangle)
    }

    /// Sends a ray.
    #[inline(always)]
    fn walk<const ANY: bool>(&mut self, ray: Ray, accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        self.sent += 1;
        dispatch(false, Walk::<_, ANY> { structure: &self.tracer.structure, stack: &mut self.stack, ray, accept })
    }

    /// Whether a triangle would hide the middle of a light from a point that faces it if the triangle's corners moved by up to `clearance` to the side.
    ///
    /// A triangle of which nothing rises above the point's own plane hides nothing of it.
    pub fn is_center_nearly_hidden(&mut self, point: &SurfacePoint, light: &SceneLight, clearance: Clearance) -> bool {
        self.sent += 1;
        let tracer = self.tracer;
        let rises = |corners: &[DVec3; 3]| corners.iter().any(|&corner| point.normal.dot(corner - point.position) > point.lift);
        ray_to_center(point, light)
            .is_some_and(|ray| is_nearly_met(&tracer.structure, &mut self.stack, ray, clearance, rises, |hit| tracer.hides(hit)))
    }

    /// Whether a triangle of a kind comes within `clearance` of the light's ray through a point, before the point or behind it.
    pub fn is_near_ray_from_center(
        &mut self,
        point: DVec3,
        light: &SceneLight,
        clearance: Clearance,
        is_of_kind: impl Fn(&[DVec3; 3]) -> bool,
    ) -> bool {
        self.sent += 1;
        let tracer = self.tracer;
        let ray = ray_from_center(point, light, tracer.scene.bounds());
        is_nearly_met(&tracer.structure, &mut self.stack, ray, clearance, is_of_kind, |hit| tracer.hides(hit))
    }

    /// Whether a surface faces the middle of a light.
    #[must_use]
    pub fn faces_center(point: &SurfacePoint, light: &SceneLight) -> bool {
        ray_to_center(point, light).is_some()
    }

    /// Whether the middle of a light is seen from a surface that faces it: the truth of a light without a size.
    pub fn sees_center(&mut self, point: &SurfacePoint, light: &SceneLight) -> bool {
        ray_to_center(point, light).is_some_and(|ray| !light.casts_shadows || !self.is_blocked(ray))
    }

    /// The nearest triangle between a surface and the middle of a light, and the ray that meets it; `None` where the surface does not face
    /// the light, or sees it.
    pub fn blocker_of_center(&mut self, point: &SurfacePoint, light: &SceneLight) -> Option<(Ray, Hit)> {
        let ray = ray_to_center(point, light)?;
        Some((ray, self.closest_caster(ray)?))
    }

    /// The surface that the light's ray through a point meets first, before the point or behind it: what a shadow map should hold there.
    pub fn first_from_center(&mut self, point: DVec3, light: &SceneLight) -> Option<SurfacePoint> {
        let ray = ray_from_center(point, light, self.tracer.scene.bounds());
        let hit = self.closest_caster(ray)?;
        Some(self.tracer.surface_point(&hit, ray))
    }

    /// How many samples of a light are seen from a surface; the light's shape says over what they are spread.
    ///
    /// The samples are stratified, and jittered by `seed`: the same seed gives the same samples. A light without a size is seen by all of
    /// them or by none, for which one ray is enough.
    pub fn samples_seen(&mut self, point: &SurfacePoint, light: &SceneLight, sampling: Sampling, seed: u64) -> u32 {
        let figure = Figure::new(point.position, light);
        if matches!(figure, Figure::Dot) {
            return if self.sees_center(point, light) { sampling.count() } else { 0 };
        }
        let mut seen = 0;
        for cell in 0..sampling.count() {
            if let Some(ray) = figure.ray(point, light, stratified(sampling.side, cell, seed))
                && (!light.casts_shadows || !self.is_blocked(ray))
            {
                seen += 1;
            }
        }
        seen
    }
}
