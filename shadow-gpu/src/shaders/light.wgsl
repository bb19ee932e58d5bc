// The way to a light: mirrors toward_light of shadow-math/src/plan/data.rs.

fn toward_light(light: u32, point: vec3f) -> vec3f {
    let position = lights[light].position;
    if lights[light].kind == LIGHT_DIRECTIONAL {
        return position;
    }
    return position - point;
}
