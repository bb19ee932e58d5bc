//! What every plan promises.

use shadow_math::plan::{CameraPlan, LightPlan, PixelRays, ViewPlan};
use shadow_scene::FramePlan;

fn assert_finite(numbers: &[f32], what: &str) {
    assert!(numbers.iter().all(|number| number.is_finite()), "{what}: {numbers:?}");
}

fn assert_finite_rays(rays: &PixelRays) {
    let PixelRays { origin, origin_dx, origin_dy, direction, direction_dx, direction_dy } = *rays;
    assert_finite(&[origin, origin_dx, origin_dy, direction, direction_dx, direction_dy].concat(), "rays");
}

pub(crate) fn assert_finite_camera(plan: &CameraPlan) {
    let CameraPlan { clip_x, clip_y, clip_z, clip_w, rays, ambient, exposure, .. } = *plan;
    assert_finite(&[clip_x, clip_y, clip_z, clip_w].concat(), "the camera's matrix");
    assert_finite_rays(&rays);
    assert_finite(&[ambient[0], ambient[1], ambient[2], exposure], "exposure");
    assert!(exposure > 0.0 && ambient.iter().all(|&channel| channel >= 0.0), "{ambient:?}, {exposure}");
}

pub(crate) fn assert_finite_light(plan: &LightPlan) {
    let LightPlan { position, intensity, inverse_range, axis, cone_scale, cone_offset, bias_metres, slope_scale, .. } = *plan;
    assert_finite(&[position, intensity, axis].concat(), "position, intensity and axis");
    assert_finite(&[inverse_range, cone_scale, cone_offset, bias_metres, slope_scale], "numbers of a light");
    assert!(intensity.iter().all(|&channel| channel >= 0.0) && inverse_range >= 0.0 && cone_scale >= 0.0, "{plan:?}");
    assert!(bias_metres >= 0.0 && slope_scale >= 0.0, "{plan:?}");
}

pub(crate) fn assert_finite_view(plan: &ViewPlan) {
    assert_finite(&[plan.clip_x, plan.clip_y, plan.clip_z, plan.clip_w].concat(), "a view's matrix");
    assert_finite(&[plan.world_from_texel_x, plan.world_from_texel_y, plan.world_from_depth].concat(), "its inverse");
    assert_finite_rays(&plan.rays);
    assert_finite(&[plan.texel_scale, plan.texel_offset].concat(), "texels from NDC");
    assert_finite(&[plan.rounding_texels, plan.rounding_depth].concat(), "bounds on rounding");
    assert_finite(&[plan.depth_factor, plan.w_per_metre], "how depth grows");
    assert_finite(&[plan.depth_range, plan.texel_metres].concat(), "depth range and texels");
    let [near, far] = plan.depth_range;
    assert!(near < far, "the near plane at {near} m, the far plane at {far} m");
    assert!(plan.w_per_metre == 0.0 || near > 0.0, "a perspective view's near plane is at {near} m");
    assert!(plan.texel_metres.iter().all(|&metres| metres > 0.0), "{:?}", plan.texel_metres);
    assert!(plan.depth_factor > 0.0, "{}", plan.depth_factor);
    let rounding = [plan.rounding_texels, plan.rounding_depth].concat();
    assert!(rounding.iter().all(|&bound| bound >= 0.0), "{rounding:?}");
}

pub(crate) fn assert_finite_plan(plan: &FramePlan) {
    assert_finite_camera(&plan.camera);
    plan.lights.iter().for_each(assert_finite_light);
    plan.views.iter().for_each(assert_finite_view);
    assert!(plan.ev.is_finite());
}
