// The receiver's side: mirrors shadow-math/src/visibility.rs, and cube_face_of of shadow-math/src/fit/cube.rs.

struct Receiver {
    point: vec3f,
    normal: vec3f,
}

const NO_VIEW: u32 = 0xffffffffu;

struct Lookup {
    view: u32,
    known: f32,
    texel: vec2f,
    depth: f32,
    bias: f32,
}

fn known_lookup(visibility: f32) -> Lookup {
    return Lookup(NO_VIEW, visibility, vec2f(0.0, 0.0), 0.0, 0.0);
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
    var view = lights[light].first_view;
    if lights[light].split == SPLIT_CUBE {
        view += cube_face_of(-toward);
    }
    let receiver_w = row_times_point(views[view].clip_w, receiver.point);
    if receiver_w <= 0.0 {
        return known_lookup(1.0);
    }
    let normal = unit_normal(receiver.normal);
    let needed = needed_depth(light, view, receiver.point, receiver.normal, receiver_w);
    let offset = normal_offset(light, view, receiver.point, normal, needed, receiver_w);
    var bias = depth_bias(light, view, needed, receiver_w);
    if offset > 0.0 {
        bias = 0.0;
    }
    let point = receiver.point + normal * offset;
    let w = row_times_point(views[view].clip_w, point);
    let x = row_times_point(views[view].clip_x, point) / w;
    let y = row_times_point(views[view].clip_y, point) / w;
    let z = row_times_point(views[view].clip_z, point) / w;
    let texel_scale = views[view].texel_scale;
    let texel_offset = views[view].texel_offset;
    let texel = vec2f(x * texel_scale.x + texel_offset.x, y * texel_scale.y + texel_offset.y);
    let rect = vec4f(views[view].rect);
    let inside = texel.x >= rect.x
        && texel.y >= rect.y
        && texel.x < rect.x + rect.z
        && texel.y < rect.y + rect.w;
    if !inside || z < 0.0 {
        return known_lookup(1.0);
    }
    return Lookup(view, 0.0, texel, min(z, 1.0), bias);
}

fn unit_normal(normal: vec3f) -> vec3f {
    let largest = max(max(abs(normal.x), abs(normal.y)), abs(normal.z));
    return normalized(normal / largest);
}

fn visibility(light: u32, receiver: Receiver) -> f32 {
    let found = lookup(light, receiver);
    if found.view == NO_VIEW {
        return found.known;
    }
    return filtered_test(found.view, lights[light].filter_kind, found.texel, found.depth, found.bias);
}
