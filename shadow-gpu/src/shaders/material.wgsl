// Materials and their textures: mirrors shadow-math/src/material.rs.

const NO_TEXTURE: u32 = 0xffffffffu;
const FLAG_MASK: u32 = 1u;
const FLAG_DOUBLE_SIDED: u32 = 2u;
const WRAP_REPEAT: u32 = 0u;
const WRAP_CLAMP: u32 = 1u;
const WRAP_MIRROR: u32 = 2u;
const DECODE_TABLE_LEN: u32 = 512u;
const ALPHA_TABLE: u32 = 256u;
const MAX_TEXEL_COORDINATE: f32 = 8388608.0;

struct TextureData {
    first_word: u32,
    width: u32,
    height: u32,
    wrap_u: u32,
    wrap_v: u32,
}

struct MaterialData {
    base_color: vec4f,
    alpha_cutoff: f32,
    flags: u32,
    shininess: f32,
    texture: TextureData,
}

fn wrap_texel(index: i32, size: i32, wrap: u32) -> i32 {
    if index >= 0 && index < size {
        return index;
    }
    if wrap == WRAP_CLAMP {
        return min(max(index, 0), size - 1);
    }
    var period = size;
    if wrap == WRAP_MIRROR {
        period = 2 * size;
    }
    // A quotient in f32 and two corrections: integer division is what software drivers are slowest at.
    var wrapped = index - i32(floor(f32(index) / f32(period))) * period;
    if wrapped < 0 {
        wrapped += period;
    }
    if wrapped >= period {
        wrapped -= period;
    }
    if wrapped >= size {
        wrapped = period - 1 - wrapped;
    }
    return wrapped;
}

fn decode_texel(texel: u32) -> vec4f {
    let r = decoded(texel & 0xffu);
    let g = decoded(texel >> 8u & 0xffu);
    let b = decoded(texel >> 16u & 0xffu);
    let a = decoded_alpha(texel >> 24u);
    return vec4f(r, g, b, a);
}

fn sample_texture(texture: TextureData, uv: vec2f) -> vec4f {
    let width = i32(texture.width);
    let height = i32(texture.height);
    let x = min(max(uv.x * f32(texture.width) - 0.5, -MAX_TEXEL_COORDINATE), MAX_TEXEL_COORDINATE);
    let y = min(max(uv.y * f32(texture.height) - 0.5, -MAX_TEXEL_COORDINATE), MAX_TEXEL_COORDINATE);
    let floor_x = floor(x);
    let floor_y = floor(y);
    let fraction_x = x - floor_x;
    let fraction_y = y - floor_y;
    let x0 = wrap_texel(i32(floor_x), width, texture.wrap_u);
    let x1 = wrap_texel(i32(floor_x) + 1, width, texture.wrap_u);
    let y0 = wrap_texel(i32(floor_y), height, texture.wrap_v);
    let y1 = wrap_texel(i32(floor_y) + 1, height, texture.wrap_v);
    let row0 = texture.first_word + u32(y0 * width);
    let row1 = texture.first_word + u32(y1 * width);
    let t00 = decode_texel(fetch_word(row0 + u32(x0)));
    let t10 = decode_texel(fetch_word(row0 + u32(x1)));
    let t01 = decode_texel(fetch_word(row1 + u32(x0)));
    let t11 = decode_texel(fetch_word(row1 + u32(x1)));
    let top = t00 + (t10 - t00) * fraction_x;
    let bottom = t01 + (t11 - t01) * fraction_x;
    return top + (bottom - top) * fraction_y;
}

fn base_color(material: u32, uv: vec2f, vertex_color: vec4f) -> vec4f {
    let data = fetch_material(material);
    var color = data.base_color * vertex_color;
    let texture = data.texture;
    if texture.first_word != NO_TEXTURE {
        color *= sample_texture(texture, uv);
    }
    return color;
}
