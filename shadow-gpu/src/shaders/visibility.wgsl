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

struct Choice {
    first: u32,
    second: u32,
    share: f32,
    known: f32,
}

fn choose_views(light: u32, receiver: Receiver) -> Choice {
    let toward = toward_light(light, receiver.point);
    if !(dot3(receiver.normal, toward) > 0.0) {
        return Choice(NO_VIEW, NO_VIEW, 0.0, 0.0);
    }
    if lights[light].view_count == 0u {
        return Choice(NO_VIEW, NO_VIEW, 0.0, 1.0);
    }
    var distance = 0.0;
    if lights[light].split == SPLIT_CASCADES || lights[light].shadow_far < MAX_FLOAT {
        distance = row_times_point(lights[light].view_distance, receiver.point);
        if distance > lights[light].shadow_far {
            return Choice(NO_VIEW, NO_VIEW, 0.0, 1.0);
        }
    }
    var choice = Choice(lights[light].first_view, NO_VIEW, 0.0, 0.0);
    if lights[light].split == SPLIT_CUBE {
        choice.first += cube_face_of(-toward);
    }
    if lights[light].split == SPLIT_CASCADES {
        let last = lights[light].view_count - 1u;
        var cascade = 0u;
        if lights[light].selection == SELECT_BY_DEPTH {
            while cascade < last && distance > lights[light].split_far[cascade / 4u][cascade % 4u] {
                cascade += 1u;
            }
            let band = lights[light].split_band[cascade / 4u][cascade % 4u];
            if band > 0.0 {
                let rest = lights[light].split_far[cascade / 4u][cascade % 4u] - distance;
                choice.share = max(1.0 - rest / band, 0.0);
            }
        } else {
            while cascade < last && !(distance_to_rim(light, lights[light].first_view + cascade, receiver.point) >= 0.0) {
                cascade += 1u;
            }
            let band = lights[light].split_band[cascade / 4u][cascade % 4u];
            if band > 0.0 {
                let rest = distance_to_rim(light, lights[light].first_view + cascade, receiver.point);
                choice.share = max(1.0 - rest / band, 0.0);
            }
        }
        choice.first += cascade;
        if choice.share > 0.0 {
            choice.second = choice.first + 1u;
        }
    }
    return choice;
}

fn distance_to_rim(light: u32, view: u32, point: vec3f) -> f32 {
    let w = row_times_point(views[view].clip_w, point);
    if w <= 0.0 || views[view].rect.z == 0u || w > views[view].farthest_w * row_times_point(views[view].distance, point) {
        return -1.0;
    }
    let x = row_times_point(views[view].clip_x, point) / w;
    let y = row_times_point(views[view].clip_y, point) / w;
    // NDC reaches from -1 to 1: half a map is 1.
    let guard = lights[light].guard_texels * 2.0 / f32(views[view].rect.z);
    return (1.0 - max(abs(x), abs(y))) - guard;
}

fn lookup(light: u32, receiver: Receiver) -> Lookup {
    let choice = choose_views(light, receiver);
    if choice.first == NO_VIEW {
        return known_lookup(choice.known);
    }
    return lookup_in_view(light, choice.first, receiver);
}

fn lookup_in_view(light: u32, view: u32, receiver: Receiver) -> Lookup {
    let receiver_w = row_times_point(views[view].clip_w, receiver.point);
    if receiver_w <= 0.0 || row_times_point(views[view].half_space, receiver.point) < 0.0 {
        return known_lookup(1.0);
    }
    let normal = unit_normal(receiver.normal);
    let sides = footprint(light, view, receiver, receiver_w);
    let needed = needed_depth(light, view, receiver.point, receiver.normal, receiver_w, sides);
    let offset = normal_offset(light, view, receiver.point, normal, needed, receiver_w);
    let axis_distance = row_times_point(views[view].distance, receiver.point);
    var bias = linear_bias(view, receiver_w, depth_bias(light, view, needed, receiver_w, axis_distance));
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
        slope_limit = plane_limit(light, view, receiver_w, axis_distance);
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
    let choice = choose_views(light, receiver);
    if choice.first == NO_VIEW {
        return choice.known;
    }
    let first = visibility_in_view(light, choice.first, receiver);
    if blends_views(light) && choice.share > 0.0 {
        let second = visibility_in_view(light, choice.second, receiver);
        return first + (second - first) * choice.share;
    }
    return first;
}

fn visibility_in_view(light: u32, view: u32, receiver: Receiver) -> f32 {
    var found = lookup_in_view(light, view, receiver);
    if found.view == NO_VIEW {
        return found.known;
    }
    if (bias_kind(light) & BIAS_RECEIVER_GRADIENT) != 0u {
        found.bias += stored_gradient(found.view, light, found.texel);
    }
    return filtered_test(light, found);
}
