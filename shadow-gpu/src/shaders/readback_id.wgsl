// Triangle indices into a buffer without padding.

@group(0) @binding(0) var source: texture_2d<u32>;
@group(0) @binding(1) var<storage, read_write> destination: array<u32>;

@compute @workgroup_size(8, 8)
fn read_id(@builtin(global_invocation_id) texel: vec3u) {
    let size = textureDimensions(source);
    if texel.x >= size.x || texel.y >= size.y {
        return;
    }
    destination[texel.y * size.x + texel.x] = textureLoad(source, texel.xy, 0).x;
}
