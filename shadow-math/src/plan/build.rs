//! Computes a plan in double precision and rounds it once.

use glam::{DVec2, DVec3};

use super::data::{
    BIAS_AUTOMATIC, BIAS_BACK_FACES, BIAS_CONSTANT, BIAS_NORMAL_OFFSET, BIAS_OGRE_2006, BIAS_POLYGON_OFFSET,
    BIAS_RECEIVER_GRADIENT, BIAS_RECEIVER_PLANE, BIAS_SLOPE, COMPOSE_ADDITIVE, CameraPlan, LIGHT_DIRECTIONAL, LIGHT_POINT,
    LIGHT_SPOT, LightPlan, PixelRays, TERMINATOR_HARD, TERMINATOR_SOFT, ViewPlan,
};
use super::{
    check::check_settings,
    error::PlanError,
    view::{pixel_rays, rows},
    views::{plan_views, view_count},
};
use crate::{
    camera::Camera,
    exposure::Exposure,
    filter::kernel::set_filter,
    fit::Subject,
    light::{Light, LightKind},
    settings::{Bias, BiasParts, MAX_NORMAL_TEXELS, Ogre2006, PolygonOffset, ReceiverGradient, ShadowSettings, Terminator},
    spaces::ClipDepth,
};

/// How the camera takes a picture of `width` by `height` pixels with `light_count` lights.
///
/// # Errors
///
/// [`PlanError::Camera`], [`PlanError::PictureSize`] and [`PlanError::CameraOverflow`].
pub fn plan_camera(
    camera: &Camera,
    width: u32,
    height: u32,
    exposure: Exposure,
    light_count: u32,
) -> Result<CameraPlan, PlanError> {
    camera.validate()?;
    if width == 0 || height == 0 {
        return Err(PlanError::PictureSize { width, height });
    }
    let size = DVec2::new(f64::from(width), f64::from(height));
    let aspect = size.x / size.y;
    let clip_from_world = camera.clip_from_view(aspect, ClipDepth::Reversed) * camera.view_from_world();
    let [clip_x, clip_y, clip_z, clip_w] = rows(clip_from_world);
    // The rays come from the pose itself: an infinite far plane has no inverse that could be unprojected.
    let half_extent = camera.half_extent(aspect);
    let perspective = matches!(camera.projection, crate::Projection::Perspective { .. });
    let plan = CameraPlan {
        clip_x,
        clip_y,
        clip_z,
        clip_w,
        rays: pixel_rays(
            camera.eye,
            camera.orientation * DVec3::X,
            camera.orientation * DVec3::Y,
            half_extent,
            size,
            perspective,
        ),
        ambient: exposure.ambient.to_array(),
        exposure: exposure.scale,
        width,
        height,
        light_count,
        first_light: 0,
        shadow_color: [1.0; 3],
        composition: COMPOSE_ADDITIVE,
    };
    let CameraPlan { clip_x, clip_y, clip_z, clip_w, ambient, exposure, .. } = plan;
    let is_finite = are_finite(&[&clip_x, &clip_y, &clip_z, &clip_w, &ambient, &[exposure]]) && has_finite_rays(&plan.rays);
    if is_finite { Ok(plan) } else { Err(PlanError::CameraOverflow) }
}

/// The plan of a light and of its views, which are written to the beginning of `views`.
///
/// `subject` says what casts shadows, what is drawn and who looks at it, all relative to the scene's origin. `first_view` is the index that the first view will have in the frame, and `first_layer` the map array's
/// first layer that is free: each view that anything is seen in takes one.
///
/// # Errors
///
/// Every [`PlanError`] but those of the camera.
pub fn plan_light(
    light: &Light,
    subject: &Subject<'_>,
    settings: &ShadowSettings,
    [first_view, first_layer]: [u32; 2],
    views: &mut [ViewPlan],
) -> Result<LightPlan, PlanError> {
    light.validate()?;
    check_settings(settings)?;
    if subject.bounds.is_empty() {
        return Err(PlanError::EmptyBounds);
    }
    let count = view_count(light, settings)?;
    let given = views.len();
    let views = views.get_mut(..count).ok_or(PlanError::Views { needed: count, given })?;
    let mut plan = plan_unshadowed_light(light, settings, first_view)?;
    plan.view_count = count as u32;
    plan_views(&mut plan, light, subject, settings, first_layer, views)?;
    let is_usable =
        views[..plan.view_count as usize].iter().all(is_usable_view) && are_finite(&[&plan.view_distance, &[plan.shadow_far]]);
    if is_usable { Ok(plan) } else { Err(PlanError::LightOverflow) }
}

/// The plan of a light from which nothing is shadowed: it has no views, and lights whatever faces it.
///
/// # Errors
///
/// What is wrong with the light, the filter or the bias.
pub fn plan_unshadowed_light(light: &Light, settings: &ShadowSettings, first_view: u32) -> Result<LightPlan, PlanError> {
    light.validate()?;
    let mut plan = LightPlan {
        intensity: (light.color * light.intensity).to_array(),
        cone_offset: 1.0,
        shadow_far: f32::MAX,
        split_far: [[f32::MAX; 4]; 2],
        first_view,
        texel_shift: settings.texels.shift(),
        terminator: match settings.terminator {
            Terminator::Hard => TERMINATOR_HARD,
            Terminator::Soft => TERMINATOR_SOFT,
        },
        ..LightPlan::default()
    };
    set_filter(&mut plan, settings.filter, settings.filter_radius)?;
    set_bias(&mut plan, settings.bias)?;
    match light.kind {
        LightKind::Directional { direction } => {
            plan.kind = LIGHT_DIRECTIONAL;
            plan.position = (-direction.as_dvec3().normalize()).as_vec3().to_array();
        }
        LightKind::Spot { position, direction, inner, outer, range } => {
            plan.kind = LIGHT_SPOT;
            plan.position = position.to_array();
            plan.axis = direction.as_dvec3().normalize().as_vec3().to_array();
            plan.inverse_range = range.map_or(0.0, |range| 1.0 / range);
            (plan.cone_scale, plan.cone_offset) = cone_falloff(inner, outer);
        }
        LightKind::Point { position, range } => {
            plan.kind = LIGHT_POINT;
            plan.position = position.to_array();
            plan.inverse_range = range.map_or(0.0, |range| 1.0 / range);
        }
    }
    if is_usable_light(&plan) { Ok(plan) } else { Err(PlanError::LightOverflow) }
}

/// Whether rounding to f32 left every number finite.
fn are_finite(numbers: &[&[f32]]) -> bool {
    numbers.iter().copied().flatten().all(|number| number.is_finite())
}

/// Whether the rays have finite numbers.
fn has_finite_rays(rays: &PixelRays) -> bool {
    let PixelRays { origin, origin_dx, origin_dy, direction, direction_dx, direction_dy } = rays;
    are_finite(&[origin, origin_dx, origin_dy, direction, direction_dx, direction_dy])
}

/// Whether a light's plan has finite numbers.
fn is_usable_light(plan: &LightPlan) -> bool {
    let LightPlan { position, intensity, inverse_range, axis, cone_scale, cone_offset, .. } = plan;
    are_finite(&[position, intensity, axis, &[*inverse_range, *cone_scale, *cone_offset]])
}

/// Whether a view's plan has finite numbers, and lengths that rounding to f32 did not make 0 or equal.
fn is_usable_view(plan: &ViewPlan) -> bool {
    let [near, far] = plan.depth_range;
    let is_deep = near < far && (plan.w_per_metre == 0.0 || near > 0.0);
    let matrices = [plan.clip_x, plan.clip_y, plan.clip_z, plan.clip_w, plan.drawn_z, plan.distance, plan.half_space];
    let inverse = [plan.world_from_texel_x, plan.world_from_texel_y, plan.world_from_depth];
    let floats = [
        plan.drawn_scale,
        plan.drawn_offset,
        plan.depth_factor,
        plan.range_over_near,
        plan.linear_scale,
        plan.linear_offset,
        plan.caster_push,
        plan.rounding_metres,
    ];
    let pairs = [plan.rounding_texels, plan.rounding_depth, plan.depth_range, plan.texel_metres];
    is_deep
        && plan.depth_factor > 0.0
        && plan.texel_metres.iter().all(|&metres| metres > 0.0)
        && are_finite(&[matrices.as_flattened(), inverse.as_flattened(), pairs.as_flattened(), &floats])
        && has_finite_rays(&plan.rays)
}

/// Writes the bias into a light's plan.
fn set_bias(plan: &mut LightPlan, bias: Bias) -> Result<(), PlanError> {
    let at_least_zero = |number: f32| number.is_finite() && number >= 0.0;
    let Bias::Parts(parts) = bias else {
        plan.bias = BIAS_AUTOMATIC;
        plan.slope_scale = 1.0;
        return Ok(());
    };
    let BiasParts { constant, slope, normal_offset, receiver_plane, receiver_gradient, polygon_offset, ogre_2006, back_faces } =
        parts;
    if let Some(PolygonOffset { slope, units, clamp }) = polygon_offset {
        if let Some(number) = [slope, units, clamp].into_iter().find(|&number| !at_least_zero(number)) {
            return Err(PlanError::PolygonOffset(number));
        }
        plan.bias |= BIAS_POLYGON_OFFSET;
    }
    if let Some(Ogre2006 { metres, .. }) = ogre_2006 {
        if polygon_offset.is_some() {
            return Err(PlanError::TwoCasterBiases);
        }
        if !at_least_zero(metres) {
            return Err(PlanError::BiasMetres(metres));
        }
        plan.bias |= BIAS_OGRE_2006;
    }
    if back_faces {
        plan.bias |= BIAS_BACK_FACES;
    }
    if let Some(metres) = constant {
        if !at_least_zero(metres) {
            return Err(PlanError::BiasMetres(metres));
        }
        plan.bias |= BIAS_CONSTANT;
        plan.bias_metres = metres;
    }
    if let Some(scale) = slope {
        if !at_least_zero(scale) {
            return Err(PlanError::SlopeScale(scale));
        }
        plan.bias |= BIAS_SLOPE;
        plan.slope_scale = scale;
    }
    if let Some(texels) = normal_offset {
        if !(at_least_zero(texels) && texels <= MAX_NORMAL_TEXELS) {
            return Err(PlanError::NormalTexels(texels));
        }
        plan.bias |= BIAS_NORMAL_OFFSET;
        plan.normal_texels = texels;
    }
    if let Some(metres) = receiver_plane {
        if slope.is_some() {
            return Err(PlanError::SlopeWithReceiverPlane);
        }
        if !(metres.is_finite() && metres > 0.0) {
            return Err(PlanError::PlaneMetres(metres));
        }
        plan.bias |= BIAS_RECEIVER_PLANE;
        plan.plane_metres = metres;
    }
    if let Some(ReceiverGradient { fixed, clamp, scale }) = receiver_gradient {
        if let Some(number) = [fixed, clamp, scale].into_iter().find(|&number| !at_least_zero(number)) {
            return Err(PlanError::ReceiverGradient(number));
        }
        plan.bias |= BIAS_RECEIVER_GRADIENT;
        (plan.gradient_fixed, plan.gradient_clamp, plan.gradient_scale) = (fixed, clamp, scale);
    }
    Ok(())
}

/// The scale and offset of KHR_lights_punctual's angular falloff, "Inner and Outer Cone Angles".
fn cone_falloff(inner: f32, outer: f32) -> (f32, f32) {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    /// A floor under the difference of the cosines. The specification's sample code has 0.001 here, which would dim the whole of a cone
    /// narrower than 2.6 degrees; in f64 the quotient only has to stay a number that f32 holds.
    const MIN_COSINE_STEP: f64 = 1e-9;
    let (cos_inner, cos_outer) = (f64::from(inner).cos(), f64::from(outer).cos());
    let scale = 1.0 / (cos_inner - cos_outer).max(MIN_COSINE_STEP);
    (scale as f32, (-cos_outer * scale) as f32)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::{
        bounds::Aabb,
        plan::{MAX_VIEWS_PER_LIGHT, SPLIT_CUBE},
        settings::Split,
        spaces::texel_from_ndc,
    };

    fn scene() -> Aabb {
        Aabb::new(Vec3::splat(-4.0), Vec3::splat(4.0))
    }

    fn spot(outer: f32) -> Light {
        Light {
            kind: LightKind::Spot { position: Vec3::Y * 9.0, direction: Vec3::NEG_Y, inner: 0.1, outer, range: None },
            color: Vec3::ONE,
            intensity: 100.0,
        }
    }

    fn plan(light: &Light, settings: &ShadowSettings) -> Result<(LightPlan, [ViewPlan; MAX_VIEWS_PER_LIGHT]), PlanError> {
        let mut views = [ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
        Ok((plan_light(light, &Subject::unseen(&[scene()], scene()), settings, [0, 0], &mut views)?, views))
    }

    #[test]
    fn wide_spots_take_cube_faces() {
        let settings = ShadowSettings::default();
        assert_eq!(plan(&spot(70_f32.to_radians()), &settings).unwrap().0.view_count, 1);
        assert_eq!(plan(&spot(70.1_f32.to_radians()), &settings).unwrap().0.view_count, 6);
        let cube = ShadowSettings { split: Split::Cube, ..settings };
        assert_eq!(plan(&spot(0.5), &cube).unwrap().0.split, SPLIT_CUBE);
    }

    #[test]
    fn half_a_step_of_the_grid_is_left_to_it() {
        for (subpixel_bits, half_step) in [(4, 1.0 / 32.0), (8, 1.0 / 512.0)] {
            let settings = ShadowSettings { subpixel_bits, ..ShadowSettings::default() };
            let (_, views) = plan(&spot(0.5), &settings).expect("both grids can be planned for");
            assert_eq!(views[0].snap_texels, half_step);
        }
    }

    #[test]
    fn what_has_no_meaning_is_refused() {
        let sun = Light { kind: LightKind::Directional { direction: Vec3::NEG_Y }, color: Vec3::ONE, intensity: 1.0 };
        let settings = ShadowSettings::default();
        let refused = |light: &Light, settings: ShadowSettings| plan(light, &settings).unwrap_err();
        assert_eq!(refused(&sun, ShadowSettings { split: Split::Cube, ..settings }), PlanError::CubeAroundDirection);
        for subpixel_bits in [3, 9] {
            let error = PlanError::SubpixelBits(subpixel_bits);
            assert_eq!(refused(&sun, ShadowSettings { subpixel_bits, ..settings }), error);
        }
        assert_eq!(refused(&sun, ShadowSettings { map_size: 15, ..settings }), PlanError::MapSize(15));
        assert_eq!(refused(&sun, ShadowSettings { map_size: 16_385, ..settings }), PlanError::MapSize(16_385));
        let bias = Bias::constant(-1.0);
        assert_eq!(refused(&sun, ShadowSettings { bias, ..settings }), PlanError::BiasMetres(-1.0));
        let bias = Bias::slope(f32::INFINITY, 0.0);
        assert_eq!(refused(&sun, ShadowSettings { bias, ..settings }), PlanError::SlopeScale(f32::INFINITY));
        let parts = |parts| ShadowSettings { bias: Bias::Parts(parts), ..settings };
        let none = BiasParts::NONE;
        assert_eq!(refused(&sun, parts(BiasParts { normal_offset: Some(8.1), ..none })), PlanError::NormalTexels(8.1));
        assert_eq!(refused(&sun, parts(BiasParts { receiver_plane: Some(0.0), ..none })), PlanError::PlaneMetres(0.0));
        let both = BiasParts { receiver_plane: Some(1.0), slope: Some(1.0), ..none };
        assert_eq!(refused(&sun, parts(both)), PlanError::SlopeWithReceiverPlane);
        let gradient = ReceiverGradient { clamp: -0.5, ..ReceiverGradient::default() };
        let error = refused(&sun, parts(BiasParts { receiver_gradient: Some(gradient), ..none }));
        assert_eq!(error, PlanError::ReceiverGradient(-0.5));
        let mut few = [ViewPlan::default(); 5];
        let error = plan_light(&spot(1.5), &Subject::unseen(&[scene()], scene()), &settings, [0, 0], &mut few).unwrap_err();
        assert_eq!(error, PlanError::Views { needed: 6, given: 5 });
        let error = plan_light(&sun, &Subject::unseen(&[], Aabb::EMPTY), &settings, [0, 0], &mut few).unwrap_err();
        assert_eq!(error, PlanError::EmptyBounds);
    }

    #[test]
    fn what_single_precision_does_not_hold_is_refused() {
        let projection = crate::Projection::Perspective { vertical_fov: 0.8, near: 0.1, far: None };
        let narrow = crate::Projection::Perspective { vertical_fov: 1e-300, near: 0.1, far: None };
        for (eye, projection) in [(DVec3::X * 1e39, projection), (DVec3::X, narrow)] {
            let camera = Camera::look_at(eye, DVec3::ZERO, projection).expect("the eye is not the target");
            assert_eq!(plan_camera(&camera, 64, 36, Exposure::default(), 0), Err(PlanError::CameraOverflow), "{eye}");
        }
        for (position, range) in [(Vec3::splat(3e38), None), (Vec3::Y, Some(1e-44)), (Vec3::Y, Some(1e-39))] {
            let light = Light { kind: LightKind::Point { position, range }, color: Vec3::ONE, intensity: 1.0 };
            let error = plan(&light, &ShadowSettings::default()).unwrap_err();
            assert_eq!(error, PlanError::LightOverflow, "{position} {range:?}");
        }
    }

    #[test]
    fn a_directional_view_has_w_of_exactly_one() {
        let sun =
            Light { kind: LightKind::Directional { direction: Vec3::new(0.2, -1.0, 0.4) }, color: Vec3::ONE, intensity: 1.0 };
        let (_, views) = plan(&sun, &ShadowSettings::default()).unwrap();
        assert_eq!(views[0].clip_w, [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn rays_pass_through_the_points_that_project_to_their_pixels() {
        let camera = Camera::look_at(
            DVec3::new(1.0, 3.0, 7.0),
            DVec3::ZERO,
            crate::Projection::Perspective { vertical_fov: 0.8, near: 0.1, far: None },
        )
        .unwrap();
        let plan = plan_camera(&camera, 640, 360, Exposure::default(), 0).unwrap();
        let clip_from_world = camera.clip_from_view(640.0 / 360.0, ClipDepth::Reversed) * camera.view_from_world();
        let (scale, offset) = texel_from_ndc(DVec2::ZERO, DVec2::new(640.0, 360.0));
        for (x, y) in [(0.5, 0.5), (320.0, 180.0), (600.25, 12.5)] {
            let at = |a: [f32; 4], dx: [f32; 4], dy: [f32; 4]| {
                (Vec3::from_slice(&a) + x * Vec3::from_slice(&dx) + y * Vec3::from_slice(&dy)).as_dvec3()
            };
            let rays = plan.rays;
            let point =
                at(rays.origin, rays.origin_dx, rays.origin_dy) + 4.0 * at(rays.direction, rays.direction_dx, rays.direction_dy);
            let ndc = clip_from_world.project_point3(point);
            let pixel = ndc.truncate() * scale + offset;
            // f32 directions are off by 2^-24 of a metre at 1 m, which is below 1e-4 of these pixels.
            assert!((pixel - DVec2::new(f64::from(x), f64::from(y))).length() < 1e-3, "{pixel}");
        }
    }

    #[test]
    fn the_cones_falloff_is_one_inside_and_zero_outside() {
        let (scale, offset) = cone_falloff(0.3, 0.6);
        assert!((0.3_f32.cos() * scale + offset - 1.0).abs() < 1e-5);
        assert!((0.6_f32.cos() * scale + offset).abs() < 1e-5);
    }
}
