// The visibility of one light at every pixel that shows a triangle: the depth test leaves the others as they were cleared.
// Mirrors resolve of shadow-cpu/src/resolve.rs.

@group(1) @binding(0) var<uniform> camera: CameraPlan;
// The light, whose first view is the first one of `views`.
@group(1) @binding(1) var<uniform> lights: array<LightPlan, 1>;
@group(1) @binding(2) var<uniform> views: array<ViewPlan, 8>;
@group(1) @binding(3) var maps: texture_2d_array<f32>;
@group(1) @binding(4) var seen: texture_2d<u32>;

// Each filter, bias and kind of depth has a pipeline of its own, and so have lights of whose views some are warped, and lights whose views are blended: a driver that runs a shader to its end with all lanes off would pay for all of them.
override LIGHT_FILTER: u32;
override LIGHT_BIAS: u32;
override LIGHT_DEPTH: u32;
override LIGHT_IS_WARPED: bool;
override LIGHT_BLENDS: bool;

fn filter_kind(light: u32) -> u32 {
    return LIGHT_FILTER;
}

fn bias_kind(light: u32) -> u32 {
    return LIGHT_BIAS;
}

fn depth_kind(view: u32) -> u32 {
    return LIGHT_DEPTH;
}

fn is_warped(view: u32) -> u32 {
    return select(0u, views[view].is_warped, LIGHT_IS_WARPED);
}

fn blends_views(light: u32) -> bool {
    return LIGHT_BLENDS;
}

// Every tap goes through here: what a backend allows of depth textures differs.
fn fetch_texel(layer: u32, x: u32, y: u32) -> f32 {
    return textureLoad(maps, vec2u(x, y), layer, 0).x;
}

@fragment
fn resolve_visibility(@builtin(position) position: vec4f) -> @location(0) f32 {
    let triangle = textureLoad(seen, vec2u(position.xy), 0).x;
    // A fragment's position is its pixel's centre.
    let ray = pixel_ray(camera.rays, position.x, position.y);
    let hit = scene_point(triangle, ray);
    let normal = turned_to_viewer(hit.normal, hit.normal, ray);
    var steps = PixelSteps(vec3f(0.0, 0.0, 0.0), vec3f(0.0, 0.0, 0.0));
    if filter_kind(0u) == FILTER_FOOTPRINT {
        steps = pixel_steps(camera.rays, ray, hit.point, normal);
    }
    let receiver = Receiver(hit.point, normal, vec2u(position.xy), steps);
    return visibility(0u, receiver);
}
