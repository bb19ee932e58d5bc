// Biases of the caster: mirrors shadow-math/src/caster.rs.

const CASTER_PLAIN: u32 = 0u;
const CASTER_POLYGON_OFFSET: u32 = 1u;
const CASTER_OGRE_2006: u32 = 2u;
const CASTER_OGRE_2006_CORRECTED: u32 = 3u;

const MAX_CASTER_SLOPE: f32 = 1e30;

fn caster_offset(view: u32, v0: vec3f, v1: vec3f, v2: vec3f) -> f32 {
    let normal = cross3(v1 - v0, v2 - v0);
    let gradient = depth_gradient(view, v0, normal);
    let across = min(abs(gradient.x), MAX_CASTER_SLOPE);
    let down = min(abs(gradient.y), MAX_CASTER_SLOPE);
    var slope = max(across, down);
    if views[view].caster_kind == CASTER_OGRE_2006_CORRECTED {
        slope = across + down;
    }
    var unit = 1.0;
    if views[view].caster_kind == CASTER_POLYGON_OFFSET {
        let largest = max(max(corner_depth(view, v0), corner_depth(view, v1)), corner_depth(view, v2));
        unit = depth_unit(view, largest);
    }
    var offset = min(slope * views[view].caster_slope + unit * views[view].caster_units, views[view].caster_limit);
    if views[view].drawn_scale > 0.0 {
        offset = offset / views[view].drawn_scale;
    }
    return offset;
}

fn corner_depth(view: u32, corner: vec3f) -> f32 {
    let z = row_times_point(views[view].clip_z, corner);
    let w = row_times_point(views[view].clip_w, corner);
    if w <= 0.0 {
        return 0.0;
    }
    return min(max(z / w, 0.0), 1.0);
}

fn depth_unit(view: u32, depth: f32) -> f32 {
    let exponent = 0x7f800000u;
    let last_bit = 1.1920929e-7;
    let steps = views[view].depth_steps;
    if steps > 0.0 {
        return 1.0 / steps;
    }
    return bitcast<f32>(bitcast<u32>(depth) & exponent) * last_bit;
}

fn pushed_depth(view: u32, drawn: f32, offset: f32) -> f32 {
    let depth = min(max(drawn, 0.0), 1.0);
    if depth_kind(view) == DEPTH_REVERSED {
        return max(depth - offset, 0.0);
    }
    let rest = views[view].caster_asymptote - depth;
    return min(depth + offset + rest * rest * views[view].caster_push, 1.0);
}

fn texel_ray(view: u32, x: f32, y: f32) -> Ray {
    var ray = pixel_ray(views[view].rays, x, y);
    if views[view].is_warped != 0u && views[view].w_per_metre == 0.0 {
        ray.origin = ray.origin / (views[view].rays.origin.w + views[view].rays.origin_dx.w * x + views[view].rays.origin_dy.w * y);
    }
    return ray;
}
