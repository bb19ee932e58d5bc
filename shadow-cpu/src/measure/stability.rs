//! Do shadows stand still while the camera moves?
//!
//! The same points of surfaces are asked before and after a move for their visibility under the plan and maps of each moment. Where the truth
//! changes as well, a change is right; the score is the share of the others that change so much that it can be seen.

use glam::Vec3;
use rayon::prelude::*;
use shadow_math::{
    Receiver,
    plan::CameraPlan,
    vector::row_times_point,
    visibility::{MapAccess, choose_views, visibility},
};
use shadow_scene::{FramePlan, SceneLight};

use crate::trace::{SurfacePoint, Tracer};

/// The least change that a picture of 8 bits can show. Less is what single precision makes of a bilinear weight: a hundred-thousandth, where a map is moved by whole texels.
const VISIBLE: f32 = 1.0 / 255.0;

/// Whether a camera sees the place of a point.
fn is_in_view(camera: &CameraPlan, point: Vec3) -> bool {
    let w = row_times_point(camera.clip_w, point);
    w > 0.0 && row_times_point(camera.clip_x, point).abs() <= w && row_times_point(camera.clip_y, point).abs() <= w
}

/// The plan, maps and lights of one moment. The scene's geometry is the same at all of them.
#[derive(Debug)]
pub struct Moment<'a, M> {
    /// The plan.
    pub plan: &'a FramePlan,
    /// The maps that were drawn by it.
    pub maps: &'a M,
    /// The lights that it was made for.
    pub lights: &'a [SceneLight],
}

/// How many points' visibilities change for no reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stability {
    /// Points times lights for which the truth is the same at both moments.
    pub compared: u64,
    /// Of these, those whose visibility changes by more than a step of an 8-bit picture.
    pub changed: u64,
    /// Points times lights that ask other maps at one moment than at the other: between cascades, or between the faces of a cube. They are not compared.
    pub other_maps: u64,
    /// Points that one of the two moments' cameras does not see: fits owe them nothing, and they are not compared.
    pub out_of_view: u64,
}

impl Stability {
    /// What changes at `points` from one moment to another, light by light.
    ///
    /// # Panics
    ///
    /// If the moments differ in their numbers of lights.
    #[must_use]
    pub fn between<M: MapAccess + Sync>(
        tracer: &Tracer<'_>,
        points: &[SurfacePoint],
        before: &Moment<'_, M>,
        after: &Moment<'_, M>,
    ) -> Self {
        assert_eq!(before.lights.len(), after.lights.len(), "both moments have the same lights");
        /// Points whose rays are sent by one thread.
        const CHUNK: usize = 1024;
        let chunks = points.par_chunks(CHUNK).map(|points| {
            let mut rays = tracer.rays();
            let mut stability = Self::default();
            for point in points {
                let receiver = Receiver::new(point.position.as_vec3(), point.normal.as_vec3());
                if ![before, after].into_iter().all(|moment| is_in_view(&moment.plan.camera, receiver.point)) {
                    stability.out_of_view += 1;
                    continue;
                }
                for light in 0..before.lights.len() {
                    let chosen = |moment: &Moment<'_, M>| {
                        let plan = &moment.plan.lights[light];
                        let choice = choose_views(plan, &moment.plan.views, &receiver);
                        (choice.first.wrapping_sub(plan.first_view), choice.second.wrapping_sub(plan.first_view))
                    };
                    if chosen(before) != chosen(after) {
                        stability.other_maps += 1;
                        continue;
                    }
                    let seen = |moment: &Moment<'_, M>| {
                        visibility(&moment.plan.lights[light], &moment.plan.views, moment.maps, &receiver)
                    };
                    if rays.sees_center(point, &before.lights[light]) == rays.sees_center(point, &after.lights[light]) {
                        stability.compared += 1;
                        stability.changed += u64::from((seen(before) - seen(after)).abs() > VISIBLE);
                    }
                }
            }
            stability
        });
        let sum = |a: Self, b: Self| Self {
            compared: a.compared + b.compared,
            changed: a.changed + b.changed,
            other_maps: a.other_maps + b.other_maps,
            out_of_view: a.out_of_view + b.out_of_view,
        };
        tracer.install(|| chunks.reduce(Self::default, sum))
    }

    /// The share of points times lights in view that ask other maps. 0 where there is none.
    #[must_use]
    pub fn share_of_other_maps(self) -> f64 {
        let asked = self.compared + self.other_maps;
        if asked == 0 { 0.0 } else { self.other_maps as f64 / asked as f64 }
    }

    /// The share of what was compared that changes: 0 stands still. 0 where nothing was compared.
    #[must_use]
    pub fn score(self) -> f64 {
        if self.compared == 0 { 0.0 } else { self.changed as f64 / self.compared as f64 }
    }
}
