//! One view of a plan: a light's camera, rounded to the plan's precision.

use glam::{DMat4, DVec2, DVec3, DVec4};

use super::data::{PixelRays, ViewPlan};
use crate::{
    bounds::Aabb,
    caster::{CASTER_OGRE_2006, CASTER_OGRE_2006_CORRECTED, CASTER_PLAIN, CASTER_POLYGON_OFFSET},
    depth::{DEPTH_LINEAR, DEPTH_REVERSED, DEPTH_Z_OVER_W, LAYER_FIRST, LAYER_MIDPOINT, LAYER_SECOND},
    fit::{FitOutcome, ViewFit},
    rounding::RoundingBound,
    settings::{Bias, Ogre2006, PolygonOffset, ShadowSettings, Store},
    spaces::{texel_from_clip, texel_from_ndc},
};

/// Rounds a light's camera to the plan's precision.
///
/// A view in which nothing is seen has an empty rectangle: it is not drawn, and has no layer.
pub(super) fn plan_view(view: &ViewFit, bounds: Aabb, settings: &ShadowSettings, layer: u32) -> ViewPlan {
    let (size, store) = (view.size, settings.store);
    let depth_kind = match store {
        Store::Reversed32 => DEPTH_REVERSED,
        // An orthographic view's w is 1 everywhere, and its z / w is the distance.
        Store::Linear if view.depth_scale.w_per_metre > 0.0 => DEPTH_LINEAR,
        _ => DEPTH_Z_OVER_W,
    };
    let is_reversed = depth_kind != DEPTH_Z_OVER_W;
    let forward = view;
    let view = &if is_reversed { forward.reversed() } else { *forward };
    let clip_from_world = view.clip_from_world();
    let extent = DVec2::splat(f64::from(size));
    let (texel_scale, texel_offset) = texel_from_ndc(DVec2::ZERO, extent);
    let world_from_texel = (texel_from_clip(DVec2::ZERO, extent) * clip_from_world).inverse();
    let rounding = RoundingBound::of_view(view, bounds.abs_max(), size).of_store(store, view, is_reversed);
    let rounding = rounding.of_pancake(store, forward, bounds.abs_max(), is_reversed);
    // Where drawing begins, in the view's own depth.
    let near_depth = if is_reversed { 1.0 - view.caster_depth[0] } else { view.caster_depth[0] };
    let [nearest, farthest] = view.caster_depth;
    let [drawn_scale, drawn_offset] =
        if view.is_pancaked() { [farthest - nearest, if is_reversed { 1.0 - farthest } else { nearest }] } else { [0.0; 2] };
    let (near, far) = (view.range.near, view.range.far);
    let is_linear = depth_kind == DEPTH_LINEAR;
    let range = far - near;
    let of_linear = |number: f64| if is_linear { number as f32 } else { 0.0 };
    let [clip_x, clip_y, clip_z, clip_w] = rows(clip_from_world);

    ViewPlan {
        clip_x,
        clip_y,
        clip_z,
        clip_w,
        world_from_texel_x: rounded(world_from_texel.x_axis),
        world_from_texel_y: rounded(world_from_texel.y_axis),
        world_from_depth: rounded(world_from_texel.z_axis),
        rays: texel_rays(view, world_from_texel, near_depth),
        texel_scale: texel_scale.as_vec2().to_array(),
        texel_offset: texel_offset.as_vec2().to_array(),
        rounding_texels: [rounding.texels as f32, rounding.texels_over_w as f32],
        rounding_depth: [rounding.depth as f32, rounding.depth_over_w as f32],
        depth_factor: view.depth_scale.factor as f32,
        w_per_metre: view.depth_scale.w_per_metre as f32,
        depth_range: [view.range.near as f32, view.range.far as f32],
        texel_metres: view.texel_metres.map(|metres| metres as f32),
        layer,
        depth_kind,
        depth_layer: match store {
            Store::Second => LAYER_SECOND,
            Store::Midpoint => LAYER_MIDPOINT,
            _ => LAYER_FIRST,
        },
        depth_steps: store.steps(),
        range_over_near: of_linear(range / near),
        rounding_metres: of_linear(rounding.metres),
        linear_scale: of_linear(1.0 / range),
        linear_offset: of_linear(-near / range),
        snap_texels: half_step(settings.subpixel_bits),
        is_warped: u32::from(view.is_warped),
        fit_outcome: view.outcome.code(),
        drawn_scale: drawn_scale as f32,
        drawn_z: if view.is_pancaked() { rounded(forward.drawn_row(is_reversed)) } else { clip_z },
        drawn_offset: drawn_offset as f32,
        farthest_w: view.farthest_w.min(f64::from(f32::MAX)) as f32,
        distance: if view.is_warped { rounded(view.distance_row()) } else { clip_w },
        half_space: rounded(view.half_space),
        rect: if view.outcome == FitOutcome::NothingVisible { [0; 4] } else { [0, 0, size, size] },
        ..caster_of(settings.bias, view)
    }
}

/// Half a step of a grid with so many bits, in texels.
fn half_step(subpixel_bits: u32) -> f32 {
    0.5 / (1_u32 << subpixel_bits) as f32
}

/// A plan with nothing but how casters are drawn deeper.
fn caster_of(bias: Bias, view: &ViewFit) -> ViewPlan {
    let plain = ViewPlan { caster_kind: CASTER_PLAIN, ..ViewPlan::default() };
    let Bias::Parts(parts) = bias else { return plain };
    if let Some(PolygonOffset { slope, units, clamp }) = parts.polygon_offset {
        let caster_limit = if clamp > 0.0 { clamp.min(1.0) } else { 1.0 };
        return ViewPlan { caster_kind: CASTER_POLYGON_OFFSET, caster_slope: slope, caster_units: units, caster_limit, ..plain };
    }
    let Some(Ogre2006 { metres, is_corrected }) = parts.ogre_2006 else { return plain };
    let (factor, metres) = (view.depth_scale.factor, f64::from(metres));
    let is_perspective = view.depth_scale.w_per_metre > 0.0;
    let (near, far) = (view.range.near, view.range.far);
    // A push goes by depth as it is drawn: see `drawn_scale`.
    let [nearest, farthest] = view.caster_depth;
    let scale = farthest - nearest;
    ViewPlan {
        caster_kind: if is_corrected { CASTER_OGRE_2006_CORRECTED } else { CASTER_OGRE_2006 },
        // The shader steps by half a texel in a depth twice as large as ours, and halves the larger slope twice.
        caster_slope: if is_corrected { 1.0 } else { 0.25 },
        caster_units: if is_perspective { 0.0 } else { (metres * factor) as f32 },
        caster_limit: 1.0,
        caster_asymptote: if is_perspective { ((far / (far - near) - nearest) / scale) as f32 } else { 0.0 },
        caster_push: if is_perspective { (metres / factor * scale) as f32 } else { 0.0 },
        ..plain
    }
}

/// The rays of light through the texels of a view, in the order of [`PixelRays`].
///
/// A texel's column of points is the image of a line through the light. Its point at `near_depth`, the depth of the near plane by which casters are drawn, is linear in the texel's coordinates, homogeneous: parallel light has that as its origin, to be divided by its fourth
/// component; light from a place has the vector from there to it, which is linear too, and as long as it is deep where nothing is warped.
fn texel_rays(view: &ViewFit, world_from_texel: DMat4, near_depth: f64) -> PixelRays {
    let light = view.light();
    let [dx, dy] = [world_from_texel.x_axis, world_from_texel.y_axis];
    let corner = world_from_texel.w_axis + world_from_texel.z_axis * near_depth;
    let padded = |v: DVec3| rounded(v.extend(0.0));
    if view.depth_scale.w_per_metre > 0.0 {
        // The vector from the light to a homogeneous point, times the point's own w.
        let position = light.truncate() / light.w;
        let from_light = |point: DVec4| padded(point.truncate() - position * point.w);
        return PixelRays {
            origin: padded(position),
            direction: from_light(corner),
            direction_dx: from_light(dx),
            direction_dy: from_light(dy),
            ..PixelRays::default()
        };
    }
    PixelRays {
        origin: rounded(corner),
        origin_dx: rounded(dx),
        origin_dy: rounded(dy),
        direction: padded(-light.truncate()),
        ..PixelRays::default()
    }
}

/// The rays of a view from its pose: `right` and `up` are unit vectors, `half_extent` half the width and height of the image in
/// metres (at a distance of 1 m if `perspective`), `size` its extent in pixels.
pub(super) fn pixel_rays(eye: DVec3, right: DVec3, up: DVec3, half_extent: DVec2, size: DVec2, perspective: bool) -> PixelRays {
    let forward = up.cross(right);
    let dx = right * (2.0 * half_extent.x / size.x);
    // Rows count downward.
    let dy = -up * (2.0 * half_extent.y / size.y);
    let corner = up * half_extent.y - right * half_extent.x;
    let pad = |v: DVec3| v.as_vec3().extend(0.0).to_array();
    let zero = pad(DVec3::ZERO);
    if perspective {
        PixelRays {
            origin: pad(eye),
            origin_dx: zero,
            origin_dy: zero,
            direction: pad(forward + corner),
            direction_dx: pad(dx),
            direction_dy: pad(dy),
        }
    } else {
        PixelRays {
            origin: pad(eye + corner),
            origin_dx: pad(dx),
            origin_dy: pad(dy),
            direction: pad(forward),
            direction_dx: zero,
            direction_dy: zero,
        }
    }
}

/// The rows of a matrix, rounded.
pub(super) fn rows(matrix: DMat4) -> [[f32; 4]; 4] {
    let transposed = matrix.transpose();
    [transposed.x_axis, transposed.y_axis, transposed.z_axis, transposed.w_axis].map(rounded)
}

/// Rounds each component to the nearest f32.
pub(super) fn rounded(v: DVec4) -> [f32; 4] {
    v.as_vec4().to_array()
}
