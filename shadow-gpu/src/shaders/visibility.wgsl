// The receiver's side: mirrors shadow-math/src/visibility.rs, and cube_face_of of shadow-math/src/fit/cube.rs.

struct Receiver {
    point: vec3f,
    normal: vec3f,
    pixel: vec2u,
    steps: PixelSteps,
}

const NO_VIEW: u32 = 0xffffffffu;

const NO_FOOTPRINT = Footprint(vec2f(0.0, 0.0), vec2f(0.0, 0.0));

fn known_lookup(visibility: f32) -> Lookup {
    return Lookup(NO_VIEW, visibility, vec2f(0.0, 0.0), 0.0, 0.0, vec2f(1.0, 0.0), NO_FOOTPRINT, vec2f(0.0, 0.0), 0.0);
}

fn footprint_side(view: u32, step: vec3f, x: f32, y: f32, w: f32) -> vec2f {
    let along_w = row_times_vector(views[view].clip_w, step);
    let moved_x = (row_times_vector(views[view].clip_x, step) - x * along_w) / w;
    let moved_y = (row_times_vector(views[view].clip_y, step) - y * along_w) / w;
    return vec2f(moved_x * views[view].texel_scale.x, moved_y * views[view].texel_scale.y);
}

fn footprint(light: u32, view: u32, receiver: Receiver, w: f32) -> Footprint {
    if filter_kind(light) != FILTER_FOOTPRINT {
        return NO_FOOTPRINT;
    }
    let x = row_times_point(views[view].clip_x, receiver.point) / w;
    let y = row_times_point(views[view].clip_y, receiver.point) / w;
    return Footprint(
        footprint_side(view, receiver.steps.x, x, y, w),
        footprint_side(view, receiver.steps.y, x, y, w),
    );
}

fn cube_face_of(v: vec3f) -> u32 {
    let ax = abs(v.x);
    let ay = abs(v.y);
    let az = abs(v.z);
    if ax >= ay && ax >= az {
        return select(0u, 1u, v.x < 0.0);
    }
    if ay >= az {
        return 2u + select(0u, 1u, v.y < 0.0);
    }
    return 4u + select(0u, 1u, v.z < 0.0);
}

fn lookup(light: u32, receiver: Receiver) -> Lookup {
    let toward = toward_light(light, receiver.point);
    if !(dot3(receiver.normal, toward) > 0.0) {
        return known_lookup(0.0);
    }
    if lights[light].view_count == 0u {
        return known_lookup(1.0);
    }
    var view = lights[light].first_view;
    if lights[light].split == SPLIT_CUBE {
        view += cube_face_of(-toward);
    }
    let receiver_w = row_times_point(views[view].clip_w, receiver.point);
    if receiver_w <= 0.0 {
        return known_lookup(1.0);
    }
    let normal = unit_normal(receiver.normal);
    let sides = footprint(light, view, receiver, receiver_w);
    let needed = needed_depth(light, view, receiver.point, receiver.normal, receiver_w, sides);
    let offset = normal_offset(light, view, receiver.point, normal, needed, receiver_w);
    var bias = linear_bias(view, receiver_w, depth_bias(light, view, needed, receiver_w));
    if offset > 0.0 {
        bias = 0.0;
    }
    var slope = vec2f(0.0, 0.0);
    var slope_limit = 0.0;
    if (bias_kind(light) & BIAS_RECEIVER_PLANE) != 0u {
        slope = depth_gradient(view, receiver.point, receiver.normal);
        if depth_kind(view) == DEPTH_REVERSED {
            slope = -slope;
        }
        slope_limit = plane_limit(light, view, receiver_w);
    }
    let point = receiver.point + normal * (offset + normal_step(light, view, receiver.point, normal, receiver_w));
    let w = row_times_point(views[view].clip_w, point);
    let x = row_times_point(views[view].clip_x, point) / w;
    let y = row_times_point(views[view].clip_y, point) / w;
    let z = receiver_depth(view, row_times_point(views[view].clip_z, point) / w, w);
    let limits = depth_limits(view);
    let texel_scale = views[view].texel_scale;
    let texel_offset = views[view].texel_offset;
    let texel_shift = lights[light].texel_shift;
    let texel = vec2f(
        x * texel_scale.x + texel_offset.x + texel_shift,
        y * texel_scale.y + texel_offset.y + texel_shift,
    );
    let rect = vec4f(views[view].rect);
    let inside = texel.x >= rect.x
        && texel.y >= rect.y
        && texel.x < rect.x + rect.z
        && texel.y < rect.y + rect.w;
    if !inside || z < limits.x {
        return known_lookup(1.0);
    }
    var turn = vec2f(1.0, 0.0);
    if filter_kind(light) == FILTER_DISC {
        turn = turn_of_pixel(receiver.pixel);
    }
    return Lookup(view, 0.0, texel, min(z, limits.y), bias, turn, sides, slope, slope_limit);
}

fn visibility(light: u32, receiver: Receiver) -> f32 {
    var found = lookup(light, receiver);
    if found.view == NO_VIEW {
        return found.known;
    }
    if (bias_kind(light) & BIAS_RECEIVER_GRADIENT) != 0u {
        found.bias += stored_gradient(found.view, light, found.texel);
    }
    return filtered_test(light, found);
}
