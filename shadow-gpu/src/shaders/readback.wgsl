// Textures into buffers without padding. Maps are read back through a shader because not every backend can copy them.

struct ReadbackLayer {
    layer: u32,
}

@group(0) @binding(0) var source: texture_2d_array<f32>;
@group(0) @binding(1) var<uniform> selected: ReadbackLayer;
@group(0) @binding(2) var<storage, read_write> destination: array<f32>;

@compute @workgroup_size(8, 8)
fn read_depth(@builtin(global_invocation_id) texel: vec3u) {
    let size = textureDimensions(source);
    if texel.x >= size.x || texel.y >= size.y {
        return;
    }
    destination[texel.y * size.x + texel.x] = textureLoad(source, texel.xy, selected.layer, 0).x;
}
