// Depth bias: mirrors shadow-math/src/bias.rs.

const MAX_DEPTH_BIAS: f32 = 1.0;
const OFFSET_SLOPE: f32 = 24.0;
const GRADIENT_MARGIN: f32 = 1.00006103515625;
const GRADIENT_ROUNDING: f32 = 0.00006103515625;

fn metres_to_depth(view: u32, w: f32, metres: f32) -> f32 {
    let w_before = w - views[view].w_per_metre * metres;
    if w_before <= 0.0 {
        return MAX_DEPTH_BIAS;
    }
    return views[view].depth_factor * metres / (w * w_before);
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
        rounding = rounding + metres_to_depth(view, w, views[view].rounding_metres);
    }
    return slope * texels + rounding;
}

fn depth_bias(light: u32, view: u32, needed: f32, w: f32) -> f32 {
    var bias = 0.0;
    if (bias_kind(light) & BIAS_CONSTANT) != 0u {
        bias = metres_to_depth(view, w, lights[light].bias_metres);
    }
    if (bias_kind(light) & (BIAS_SLOPE | BIAS_AUTOMATIC | BIAS_RECEIVER_PLANE)) != 0u {
        bias = bias + needed;
    }
    return min(bias, MAX_DEPTH_BIAS);
}

fn normal_offset(light: u32, view: u32, point: vec3f, normal: vec3f, needed: f32, w: f32) -> f32 {
    if bias_kind(light) != BIAS_AUTOMATIC || !(needed < MAX_DEPTH_BIAS) {
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
    let texel = max(views[view].texel_metres.x, views[view].texel_metres.y) * w;
    return lights[light].normal_texels * texel * sine;
}

fn plane_limit(light: u32, view: u32, w: f32) -> f32 {
    return metres_to_depth(view, w, lights[light].plane_metres);
}
