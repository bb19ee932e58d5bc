// One depth texture into a buffer. It is bound as numbers that cannot be filtered: OpenGL cannot load texels of depth textures.

@group(0) @binding(0) var source: texture_2d<f32>;
@group(0) @binding(1) var<storage, read_write> destination: array<f32>;

@compute @workgroup_size(8, 8)
fn read_probe(@builtin(global_invocation_id) texel: vec3u) {
    let size = textureDimensions(source);
    if texel.x >= size.x || texel.y >= size.y {
        return;
    }
    destination[texel.y * size.x + texel.x] = textureLoad(source, texel.xy, 0).x;
}
