// The scene's materials and texels.

// Three texels a material.
@group(1) @binding(0) var materials: texture_2d<u32>;
// A texel a word.
@group(1) @binding(1) var words: texture_2d<u32>;
// The decode table, which is small enough to be uniform: of each byte its value as a color and as alpha. The rest means nothing, since elements of a uniform array are 16 bytes apart.
@group(1) @binding(2) var<uniform> decode_table: array<vec4f, 256>;

fn fetch_word(index: u32) -> u32 {
    return textureLoad(words, table_texel(index), 0).x;
}

fn decoded(byte: u32) -> f32 {
    return decode_table[byte].x;
}

fn decoded_alpha(byte: u32) -> f32 {
    return decode_table[byte].y;
}

fn fetch_material(material: u32) -> MaterialData {
    let base_color = textureLoad(materials, table_texel(3u * material), 0);
    let surface = textureLoad(materials, table_texel(3u * material + 1u), 0);
    let texture = textureLoad(materials, table_texel(3u * material + 2u), 0);
    return MaterialData(
        bitcast<vec4f>(base_color),
        bitcast<f32>(surface.x),
        surface.y,
        bitcast<f32>(surface.z),
        TextureData(surface.w, texture.x, texture.y, texture.z, texture.w),
    );
}

// The colour and alpha of a triangle's surface at a point of it: mirrors Surfaces::color of shadow-scene/src/surfaces.rs.
fn scene_color(triangle: u32, hit: TrianglePoint) -> vec4f {
    let corners = fetch_triangle(triangle);
    let a0 = vertex_attributes(corners.x);
    let a1 = vertex_attributes(corners.y);
    let a2 = vertex_attributes(corners.z);
    let uv = a0.uv + (a1.uv - a0.uv) * hit.u + (a2.uv - a0.uv) * hit.v;
    let color = a0.color + (a1.color - a0.color) * hit.u + (a2.color - a0.color) * hit.v;
    return base_color(corners.w, uv, color);
}

// Whether an alpha-tested triangle is there: mirrors SceneAlphaTest of shadow-cpu/src/resolve.rs.
fn passes_alpha_test(triangle: u32, ray: Ray) -> bool {
    let material = fetch_material(fetch_triangle(triangle).w);
    if (material.flags & FLAG_MASK) == 0u {
        return true;
    }
    let hit = scene_point(triangle, ray);
    return scene_color(triangle, hit).w >= material.alpha_cutoff;
}
