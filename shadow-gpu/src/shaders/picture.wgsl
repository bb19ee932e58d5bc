// Pictures that a light projects: mirrors shadow-math/src/picture.rs.

fn picture_color(light: u32, point: vec3f) -> vec3f {
    if lights[light].picture_width == 0u {
        return vec3f(1.0, 1.0, 1.0);
    }
    let w = row_times_point(lights[light].picture_w, point);
    if w <= 0.0 {
        return vec3f(0.0, 0.0, 0.0);
    }
    let u = row_times_point(lights[light].picture_x, point) / w;
    let v = row_times_point(lights[light].picture_y, point) / w;
    if u < 0.0 || v < 0.0 || u > 1.0 || v > 1.0 {
        return vec3f(0.0, 0.0, 0.0);
    }
    let texture = TextureData(
        lights[light].picture_first_word,
        lights[light].picture_width,
        lights[light].picture_height,
        WRAP_CLAMP,
        WRAP_CLAMP,
    );
    return sample_texture(texture, vec2f(u, v)).xyz;
}
