// What a map's texel remembers: mirrors shadow-math/src/depth.rs.

const DEPTH_Z_OVER_W: u32 = 0u;
const DEPTH_REVERSED: u32 = 1u;
const DEPTH_LINEAR: u32 = 2u;

const LAYER_FIRST: u32 = 0u;
const LAYER_SECOND: u32 = 1u;
const LAYER_MIDPOINT: u32 = 2u;

fn encoded_depth(view: u32, drawn: f32) -> f32 {
    var depth = drawn;
    if views[view].drawn_scale > 0.0 {
        depth = min(max(drawn * views[view].drawn_scale + views[view].drawn_offset, 0.0), 1.0);
        // Where nothing is drawn there is nothing, wherever the far plane lies.
        if depth_kind(view) == DEPTH_Z_OVER_W {
            if drawn >= 1.0 {
                depth = 1.0;
            }
        } else if drawn <= 0.0 {
            depth = 0.0;
        }
    }
    if depth_kind(view) == DEPTH_LINEAR {
        depth = (1.0 - depth) / (1.0 + depth * views[view].range_over_near);
    }
    let steps = views[view].depth_steps;
    if steps > 0.0 {
        depth = nearest_whole(depth * steps) / steps;
    }
    return depth;
}

// WGSL's own function rounds as the mirrored one does; its way, by a sum and a difference, a compiler may undo.
fn nearest_whole(x: f32) -> f32 {
    return round(x);
}

fn comparable_depth(view: u32, stored: f32) -> f32 {
    if depth_kind(view) == DEPTH_REVERSED {
        return -stored;
    }
    return stored;
}

fn receiver_depth(view: u32, z: f32, w: f32) -> f32 {
    if depth_kind(view) == DEPTH_REVERSED {
        return -z;
    }
    if depth_kind(view) == DEPTH_LINEAR {
        return w * views[view].linear_scale + views[view].linear_offset;
    }
    return z;
}

fn depth_limits(view: u32) -> vec2f {
    if depth_kind(view) == DEPTH_REVERSED {
        return vec2f(-1.0, 0.0);
    }
    return vec2f(0.0, 1.0);
}

fn linear_bias(view: u32, w: f32, bias: f32) -> f32 {
    if depth_kind(view) != DEPTH_LINEAR || bias >= 1.0 {
        return bias;
    }
    return w * w * bias / (views[view].depth_factor + w * bias) * views[view].linear_scale;
}

fn depth_of_two(view: u32, first: f32, second: f32) -> f32 {
    if views[view].depth_layer == LAYER_MIDPOINT {
        return (first + second) * 0.5;
    }
    return second;
}
