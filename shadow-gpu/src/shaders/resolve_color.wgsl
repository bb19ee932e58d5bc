// The colour of every pixel that shows a triangle, linear, after exposure: the depth test leaves the others as they were cleared.
// Reads visibilities, never a map. Mirrors SurfaceSpan of shadow-cpu/src/resolve/color.rs.

@group(2) @binding(0) var<uniform> camera: CameraPlan;
@group(2) @binding(1) var<storage, read> lights: array<LightPlan>;
@group(2) @binding(2) var seen: texture_2d<u32>;
@group(2) @binding(3) var visibilities: texture_2d_array<f32>;

override ASKS_FOR_DEVIATION: bool = false;

fn pixel_color(triangle: u32, x: f32, y: f32) -> vec4f {
    let ray = pixel_ray(camera.rays, x, y);
    let hit = scene_point(triangle, ray);
    let base = scene_color(triangle, hit);
    let corners = fetch_triangle(triangle);
    let n0 = vertex_attributes(corners.x).normal;
    let n1 = vertex_attributes(corners.y).normal;
    let n2 = vertex_attributes(corners.z).normal;
    let normal = normalized(n0 + (n1 - n0) * hit.u + (n2 - n0) * hit.v);
    // Only lights with a soft terminator ask for it, and three more texels are a price.
    var deviation = 0.0;
    if ASKS_FOR_DEVIATION {
        let d0 = vertex_deviation(corners.x);
        let d1 = vertex_deviation(corners.y);
        let d2 = vertex_deviation(corners.z);
        deviation = d0 + (d1 - d0) * hit.u + (d2 - d0) * hit.v;
    }
    let surface = Surface(
        hit.point,
        turned_to_viewer(normal, hit.normal, ray),
        deviation,
        normalized(-ray.direction),
        base.xyz,
        fetch_material(corners.w).shininess,
    );
    var radiance = shade_ambient(camera.ambient, surface);
    var factor = vec3f(1.0, 1.0, 1.0);
    for (var light = camera.first_light; light < camera.first_light + camera.light_count; light++) {
        let picture = picture_color(light, hit.point);
        var seen_share = textureLoad(visibilities, vec2u(vec2f(x, y)), light, 0).x;
        if camera.composition != COMPOSE_ADDITIVE {
            let own = shadow_factor(camera.shadow_color, seen_share, light_reach(light, toward_light(light, hit.point)));
            factor *= vec3f(1.0, 1.0, 1.0) - (vec3f(1.0, 1.0, 1.0) - own) * picture;
            seen_share = 1.0;
        }
        radiance += shade_light(light, surface, seen_share) * picture;
    }
    if camera.composition == COMPOSE_FACTOR {
        return vec4f(factor, 1.0);
    }
    if camera.composition == COMPOSE_MODULATIVE {
        radiance *= factor;
    }
    return vec4f(radiance * camera.exposure, 1.0);
}

@fragment
fn resolve_color(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let triangle = textureLoad(seen, vec2u(position.xy), 0).x;
    return pixel_color(triangle, position.x, position.y);
}
