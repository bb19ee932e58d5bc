//! Do shadows stand still while the camera moves?
//!
//! The same points of surfaces are asked before and after a move for their visibility under the plan and maps of each moment. Where the truth
//! changes as well, a change is right; the score is the share of the others that change.

use rayon::prelude::*;
use shadow_math::{
    Receiver,
    visibility::{MapAccess, visibility},
};
use shadow_scene::{FramePlan, SceneLight};

use crate::trace::{SurfacePoint, Tracer};

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
    /// Of these, those whose visibility changes.
    pub changed: u64,
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
                for light in 0..before.lights.len() {
                    let seen = |moment: &Moment<'_, M>| {
                        visibility(&moment.plan.lights[light], &moment.plan.views, moment.maps, &receiver)
                    };
                    if rays.sees_center(point, &before.lights[light]) == rays.sees_center(point, &after.lights[light]) {
                        stability.compared += 1;
                        stability.changed += u64::from(seen(before) != seen(after));
                    }
                }
            }
            stability
        });
        let sum = |a: Self, b: Self| Self { compared: a.compared + b.compared, changed: a.changed + b.changed };
        tracer.install(|| chunks.reduce(Self::default, sum))
    }

    /// The share of what was compared that changes: 0 stands still. 0 where nothing was compared.
    #[must_use]
    pub fn score(self) -> f64 {
        if self.compared == 0 { 0.0 } else { self.changed as f64 / self.compared as f64 }
    }
}
