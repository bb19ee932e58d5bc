//! Do shadows stand still? Small motions of the camera and the lights, and what changes at the same points of surfaces.

use glam::{DQuat, DVec3, Quat};
use serde::Serialize;
use shadow_cpu::{
    measure::{Judge, Moment, Stability},
    resolve::ShadowMaps,
    trace::{SurfacePoint, Tracer},
};
use shadow_math::{Camera, LightKind, Projection, Receiver, visibility::choose_views};
use shadow_scene::{FramePlan, NO_TRIANGLE, Pixels, Request, Scene, SceneLight};

use super::Technique;
use crate::{backend::OpenBackend, console::Console, error::CliError, resolve::Job};

/// About as many points are watched: a share of a thousandth is then still twenty of them.
const POINTS: usize = 20_000;
/// How far the camera moves, in texels of the first light's maps, as wide as they are in the median.
const MOVE_TEXELS: f64 = 0.3;
/// How far the camera turns, in radians: 0.1 degrees.
const TURN: f64 = 0.1 * core::f64::consts::PI / 180.0;
/// By what share the camera's angle of view, or its width, shrinks.
const ZOOM: f64 = 0.01;
/// How far a directional light turns, in radians: 0.05 degrees, twelve seconds of the sun's way.
const LIGHT_TURN: f32 = 0.05 * core::f32::consts::PI / 180.0;
/// How far another light moves, as a share of the scene's radius.
const LIGHT_MOVE: f32 = 1e-3;

/// Shares of points whose visibility changes for no reason, from 0 to 1.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct StabilityReport {
    /// While the camera moves by a part of a texel.
    #[serde(rename = "move")]
    moved: f64,
    /// While it turns.
    turn: f64,
    /// While it zooms.
    zoom: f64,
    /// While the lights move.
    light: f64,
    /// The share of points that ask other maps after the camera has moved or turned than before, and are not counted above: between cascades, or faces of a cube.
    other_maps: f64,
}

impl StabilityReport {
    /// The shares with the names of the motions.
    pub(super) fn named(&self) -> [(&'static str, f64); Motions::COUNT] {
        [("move", self.moved), ("turn", self.turn), ("zoom", self.zoom), ("light", self.light)]
    }

    /// The largest share while the camera moves.
    pub(super) fn worst_of_camera(&self) -> f64 {
        self.moved.max(self.turn).max(self.zoom)
    }
}

/// What is watched, and the motions.
pub(super) struct Motions<'a> {
    job: &'a Job,
    tracer: &'a Tracer<'a>,
    points: Vec<SurfacePoint>,
    /// The scene under lights that have moved.
    relit: Scene,
}

impl<'a> Motions<'a> {
    /// How many motions there are.
    pub(super) const COUNT: usize = 4;

    /// Watches points of the surfaces that the judge sees.
    pub(super) fn new(job: &'a Job, judge: &Judge<'_>, tracer: &'a Tracer<'a>) -> Self {
        let seen = judge.seen();
        let width = seen.view.width();
        let shown: Vec<usize> = (0..seen.hits.len()).filter(|&pixel| seen.hits[pixel].triangle != NO_TRIANGLE).collect();
        let step = shown.len().div_ceil(POINTS).max(1);
        let point = |&pixel: &usize| {
            let ray = seen.view.ray(pixel as u32 % width, pixel as u32 / width);
            tracer.surface_point(&seen.hits[pixel], ray)
        };
        let points = shown.iter().step_by(step).map(point).collect();
        let radius = job.scene.bounds().radius();
        let lights = job.scene.lights().iter().map(|light| moved(light, radius)).collect();
        Self { job, tracer, points, relit: job.scene.clone().with_lights(lights) }
    }

    /// The median width of a texel of the first light's maps where the points are that ask them, in metres; 0 if none does.
    fn texel_metres(&self, plan: &FramePlan) -> f64 {
        let Some(light) = plan.lights.first() else { return 0.0 };
        let width = |point: &SurfacePoint| {
            let receiver = Receiver::new(point.position.as_vec3(), point.normal.as_vec3());
            let view = plan.views.get(choose_views(light, &plan.views, &receiver).first as usize)?;
            Some(view.texel_width_at(point.position)).filter(|width| width.is_finite() && *width > 0.0)
        };
        let mut widths: Vec<f64> = self.points.iter().filter_map(width).collect();
        widths.sort_unstable_by(f64::total_cmp);
        widths.get(widths.len() / 2).copied().unwrap_or(0.0)
    }

    /// What changes under a technique whose frame `plan` is, motion by motion.
    pub(super) fn stability(
        &self,
        backend: &OpenBackend<'_>,
        technique: &Technique,
        plan: &FramePlan,
        ev: Option<f32>,
        console: &Console,
    ) -> Result<StabilityReport, CliError> {
        let Job { scene, camera, .. } = self.job;
        let maps = draw_maps(backend, plan, console)?;
        let before = Moment { plan, maps: &maps, lights: scene.lights() };
        let score = |scene: &Scene, camera: &Camera| {
            let (width, height) = (plan.camera.width, plan.camera.height);
            let moved = technique
                .shadowing
                .plan(scene, camera, (width, height), ev)
                .map_err(|source| CliError::Technique { name: technique.name.clone(), source: Box::new(source) })?;
            let maps = draw_maps(backend, &moved, console)?;
            let after = Moment { plan: &moved, maps: &maps, lights: scene.lights() };
            console.step();
            Ok::<_, CliError>(Stability::between(self.tracer, &self.points, &before, &after))
        };
        let step = MOVE_TEXELS * self.texel_metres(plan);
        // Across and along the view, so that no axis stays as it was.
        let sideways = camera.orientation * DVec3::new(0.8, 0.0, 0.6);
        let moved = score(scene, &Camera { eye: camera.eye + sideways * step, ..*camera })?;
        let turn = score(scene, &Camera { orientation: camera.orientation * DQuat::from_rotation_y(TURN), ..*camera })?;
        Ok(StabilityReport {
            moved: moved.score(),
            turn: turn.score(),
            zoom: score(scene, &Camera { projection: zoomed(camera.projection), ..*camera })?.score(),
            light: score(&self.relit, camera)?.score(),
            other_maps: moved.share_of_other_maps().max(turn.share_of_other_maps()),
        })
    }
}

fn zoomed(projection: Projection) -> Projection {
    match projection {
        Projection::Perspective { vertical_fov, near, far } => {
            Projection::Perspective { vertical_fov: vertical_fov * (1.0 - ZOOM), near, far }
        }
        Projection::Orthographic { half_height, near, far } => {
            Projection::Orthographic { half_height: half_height * (1.0 - ZOOM), near, far }
        }
    }
}

/// A light that has moved a little, in a scene of this radius in metres.
fn moved(light: &SceneLight, radius: f32) -> SceneLight {
    let mut moved = light.clone();
    match &mut moved.light.kind {
        LightKind::Directional { direction } => {
            *direction = Quat::from_axis_angle(direction.any_orthogonal_vector().normalize_or_zero(), LIGHT_TURN) * *direction;
        }
        LightKind::Spot { position, .. } | LightKind::Point { position, .. } => position.x += LIGHT_MOVE * radius,
    }
    moved
}

/// The maps of a plan, drawn by a backend.
fn draw_maps(backend: &OpenBackend<'_>, plan: &FramePlan, console: &Console) -> Result<ShadowMaps, CliError> {
    let request = Request { shadow_maps: true, ..Request::default() };
    let (frame, _) = backend.render(plan, request, console)?;
    let layers = frame.layers.into_iter().filter_map(|layer| match layer.pixels {
        Pixels::Float(depths) => Some(depths.into()),
        _ => None,
    });
    Ok(ShadowMaps { size: plan.map_size, layers: layers.collect() })
}
