// Depth bias: mirrors shadow-math/src/bias.rs.

const MAX_DEPTH_BIAS: f32 = 1.0;
const OFFSET_SLOPE: f32 = 24.0;
const GRADIENT_MARGIN: f32 = 1.00006103515625;
const GRADIENT_ROUNDING: f32 = 0.00006103515625;

fn metres_to_depth(view: u32, w: f32, axis_distance: f32, metres: f32) -> f32 {
    let distance_before = axis_distance - views[view].w_per_metre * metres;
    if distance_before <= 0.0 {
        return MAX_DEPTH_BIAS;
    }
    return views[view].depth_factor * metres / (w * distance_before);
}

fn needed_depth(light: u32, view: u32, point: vec3f, normal: vec3f, w: f32, footprint: Footprint) -> f32 {
    let gradient = depth_gradient(view, point, normal);
    // A constant factor comes before the variable ones: shader compilers move it there.
    let slope = (abs(gradient.x) + abs(gradient.y)) * GRADIENT_MARGIN;
    let rounding_texels = views[view].rounding_texels;
    let rounding_depth = views[view].rounding_depth;
    var reach = support(light, gradient, footprint);
    // Taps that are compared with the receiver's plane need nothing for where they lie but what the plane's own gradient is off.
    if (bias_kind(light) & BIAS_RECEIVER_PLANE) != 0u {
        reach *= GRADIENT_ROUNDING;
    } else {
        reach *= lights[light].slope_scale;
    }
    let texels = reach + (views[view].snap_texels + rounding_texels.x + rounding_texels.y / w);
    var rounding = rounding_depth.x + rounding_depth.y / w;
    if depth_kind(view) == DEPTH_LINEAR {
        rounding = rounding + metres_to_depth(view, w, w, views[view].rounding_metres);
    }
    return slope * texels + rounding;
}

fn depth_bias(light: u32, view: u32, needed: f32, w: f32, axis_distance: f32) -> f32 {
    var bias = 0.0;
    if (bias_kind(light) & BIAS_CONSTANT) != 0u {
        bias = metres_to_depth(view, w, axis_distance, lights[light].bias_metres);
    }
    if (bias_kind(light) & (BIAS_SLOPE | BIAS_AUTOMATIC | BIAS_RECEIVER_PLANE)) != 0u {
        bias = bias + needed;
    }
    return min(bias, MAX_DEPTH_BIAS);
}

fn normal_offset(light: u32, view: u32, point: vec3f, normal: vec3f, needed: f32, w: f32) -> f32 {
    if bias_kind(light) != BIAS_AUTOMATIC || !(needed < max(MAX_DEPTH_BIAS, views[view].drawn_scale)) {
        return 0.0;
    }
    let toward = toward_light(light, point);
    let height = dot3(normal, toward);
    let is_steep = dot3(toward, toward) > (OFFSET_SLOPE * OFFSET_SLOPE + 1.0) * (height * height);
    let needed_at_height = needed * height;
    let along = dot3(normal, views[view].clip_w.xyz);
    let rest = views[view].depth_factor - needed_at_height * along;
    // Nothing is left of the factor where no step along the normal would be enough: the depth bias then is.
    if is_steep && rest > 0.0 {
        return needed_at_height * w / rest;
    }
    return 0.0;
}

fn normal_step(light: u32, view: u32, point: vec3f, normal: vec3f, w: f32) -> f32 {
    if (bias_kind(light) & BIAS_NORMAL_OFFSET) == 0u {
        return 0.0;
    }
    let cosine = dot3(normal, normalized(toward_light(light, point)));
    let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    return lights[light].normal_texels * texel_width(light, view, point, w) * sine;
}

fn texel_width(light: u32, view: u32, point: vec3f, w: f32) -> f32 {
    if is_warped(view) == 0u {
        return max(views[view].texel_metres.x, views[view].texel_metres.y) * w;
    }
    let toward = normalized(toward_light(light, point));
    let across_x = across(column_step(views[view].world_from_texel_x, point), toward);
    let across_y = across(column_step(views[view].world_from_texel_y, point), toward);
    return max(across_x, across_y) * w;
}

fn column_step(column: vec4f, point: vec3f) -> vec3f {
    return vec3f(column.x - point.x * column.w, column.y - point.y * column.w, column.z - point.z * column.w);
}

fn across(v: vec3f, unit: vec3f) -> f32 {
    let rest = v - unit * dot3(v, unit);
    return sqrt(rest.x * rest.x + rest.y * rest.y + rest.z * rest.z);
}

fn plane_limit(light: u32, view: u32, w: f32, axis_distance: f32) -> f32 {
    return metres_to_depth(view, w, axis_distance, lights[light].plane_metres);
}
