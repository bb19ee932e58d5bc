//! What the camera sees, for plans that follow it.

use shadow_cpu::{CpuRenderer, RasterRules};
use shadow_math::{Camera, Cascades, Filter, Fit, FitFrom, ShadowSettings, Split, SplitScheme, settings::MIN_MAP_SIZE};
use shadow_scene::{Feedback, FramePlan, Scene};

use crate::{
    error::CliError,
    memory::{Limit, check_feedback},
};

/// What the camera sees, if fits or splits follow it: drawn on the processor.
///
/// Both renderers see the same triangles, so that it does not matter which draws them. `limit` is the memory that it may take with the scene of that name, where it was not counted before.
pub(crate) fn feedback(
    scene: &Scene,
    camera: &Camera,
    settings: &[ShadowSettings],
    (width, height): (u32, u32),
    limit: Option<(&str, Limit)>,
) -> Result<Feedback, CliError> {
    let follows = |settings: &ShadowSettings| {
        settings.fit_from == FitFrom::Samples
            || settings.fit == Fit::PlaneOptimal && settings.plane.is_none()
            || matches!(settings.split, Split::Cascades(Cascades { scheme: SplitScheme::Histogram, .. }))
    };
    if !settings.iter().any(follows) {
        return Ok(Feedback::default());
    }
    if let Some((name, limit)) = limit {
        check_feedback(name, scene, limit, (width, height))?;
    }
    let plain = ShadowSettings { map_size: MIN_MAP_SIZE, filter: Filter::Hard, ..ShadowSettings::default() };
    let plan = FramePlan::new(scene, camera, &plain, width, height, None)?;
    let renderer = CpuRenderer::new(0, RasterRules::default())?;
    let seen = renderer.camera(&renderer.prepare(scene), &plan)?;
    Ok(Feedback::of(scene, &plan.camera, &seen.triangles))
}
