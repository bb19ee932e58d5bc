// Comparison samples of a depth texture: of each point the share of tests that passed.

@group(0) @binding(0) var map: texture_depth_2d;
@group(0) @binding(1) var map_sampler: sampler_comparison;
// u, v, the reference, and nothing.
@group(0) @binding(2) var<storage, read> points: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> shares: array<f32>;

@compute @workgroup_size(64)
fn compare_points(@builtin(global_invocation_id) invocation: vec3u) {
    if invocation.x >= arrayLength(&points) {
        return;
    }
    let point = points[invocation.x];
    shares[invocation.x] = textureSampleCompareLevel(map, map_sampler, point.xy, point.z);
}
