// Light on surfaces: mirrors shadow-math/src/shade.rs.

const INVERSE_PI: f32 = 0.318309886;
const SPECULAR_REFLECTANCE: f32 = 0.04;
const SPECULAR_SCALE: f32 = SPECULAR_REFLECTANCE * 0.125 * INVERSE_PI;
const MIN_HIGHLIGHT: f32 = 8.6736174e-19;

struct Surface {
    point: vec3f,
    normal: vec3f,
    deviation: f32,
    toward_viewer: vec3f,
    base_color: vec3f,
    shininess: f32,
}

fn light_reach(light: u32, toward: vec3f) -> f32 {
    if lights[light].kind == LIGHT_DIRECTIONAL {
        return 1.0;
    }
    let squared = toward.x * toward.x + toward.y * toward.y + toward.z * toward.z;
    if squared <= 0.0 {
        return 0.0;
    }
    let distance = sqrt(squared);
    let ratio = distance * lights[light].inverse_range;
    let ratio_squared = ratio * ratio;
    let window = max(1.0 - ratio_squared * ratio_squared, 0.0);
    let axis = lights[light].axis;
    let cosine = -(axis.x * toward.x + axis.y * toward.y + axis.z * toward.z) / distance;
    let cone = min(max(cosine * lights[light].cone_scale + lights[light].cone_offset, 0.0), 1.0);
    return window * (cone * cone);
}

fn attenuation(light: u32, toward: vec3f) -> f32 {
    if lights[light].kind == LIGHT_DIRECTIONAL {
        return 1.0;
    }
    let squared = toward.x * toward.x + toward.y * toward.y + toward.z * toward.z;
    if squared <= 0.0 {
        return 0.0;
    }
    return light_reach(light, toward) / squared;
}

fn softened_terminator(cosine: f32, deviation: f32) -> f32 {
    if !(deviation > 0.0) {
        return 1.0;
    }
    let share = min(max((cosine - deviation) / deviation, 0.0), 1.0);
    return share * share * (3.0 - 2.0 * share);
}

fn shade_light(light: u32, surface: Surface, visibility: f32) -> vec3f {
    let toward = toward_light(light, surface.point);
    let direction = normalized(toward);
    var cosine = max(dot3(surface.normal, direction), 0.0);
    if lights[light].terminator == TERMINATOR_SOFT {
        cosine *= softened_terminator(cosine, surface.deviation);
    }
    let illuminance = attenuation(light, toward) * cosine * visibility;
    let half_way = normalized(direction + surface.toward_viewer);
    var highlight = approx_pow(max(dot3(surface.normal, half_way), 0.0), surface.shininess);
    if highlight < MIN_HIGHLIGHT {
        highlight = 0.0;
    }
    // A constant factor comes before the variable ones: shader compilers move it there.
    let specular = (surface.shininess + 8.0) * SPECULAR_SCALE * highlight;
    let reflected = surface.base_color * INVERSE_PI + vec3f(specular, specular, specular);
    let intensity = lights[light].intensity;
    return intensity * reflected * illuminance;
}

fn shade_ambient(ambient: vec3f, surface: Surface) -> vec3f {
    return surface.base_color * INVERSE_PI * ambient;
}

fn shadow_factor(shadow_color: vec3f, visibility: f32, reach: f32) -> vec3f {
    let hidden = (1.0 - visibility) * reach;
    return vec3f(1.0, 1.0, 1.0) - (vec3f(1.0, 1.0, 1.0) - shadow_color) * hidden;
}
