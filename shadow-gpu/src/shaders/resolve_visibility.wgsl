// The visibility of every light at every pixel, the lights of a pixel side by side. Mirrors resolve of shadow-cpu/src/resolve.rs.

@group(1) @binding(0) var<uniform> camera: CameraPlan;
@group(1) @binding(1) var<storage, read> lights: array<LightPlan>;
@group(1) @binding(2) var<storage, read> views: array<ViewPlan>;
@group(1) @binding(3) var maps: texture_2d_array<f32>;
@group(1) @binding(4) var seen: texture_2d<u32>;
@group(1) @binding(5) var<storage, read_write> visibilities: array<f32>;

// Every tap goes through here: what a backend allows of depth textures differs.
fn fetch_texel(layer: u32, x: u32, y: u32) -> f32 {
    return textureLoad(maps, vec2u(x, y), layer, 0).x;
}

@compute @workgroup_size(8, 8)
fn resolve_visibility(@builtin(global_invocation_id) pixel: vec3u) {
    if pixel.x >= camera.width || pixel.y >= camera.height {
        return;
    }
    let first = (pixel.y * camera.width + pixel.x) * camera.light_count;
    let triangle = textureLoad(seen, pixel.xy, 0).x;
    if triangle == NO_TRIANGLE {
        for (var light = 0u; light < camera.light_count; light++) {
            visibilities[first + light] = 1.0;
        }
        return;
    }
    let ray = pixel_ray(camera.rays, f32(pixel.x) + 0.5, f32(pixel.y) + 0.5);
    let hit = scene_point(triangle, ray);
    let receiver = Receiver(hit.point, turned_to_viewer(hit.normal, hit.normal, ray));
    for (var light = 0u; light < camera.light_count; light++) {
        visibilities[first + light] = visibility(light, receiver);
    }
}
