// The scene's geometry, pulled from textures: software drivers read a texel of four numbers many times faster than four numbers of a buffer.

// Rows of so many texels: the smallest widest texture that WebGPU promises is twice as wide.
const TABLE_WIDTH_BITS: u32 = 12u;

// Four texels a vertex: position and u; normal and v; colour; how far facets lean away from the normal.
@group(0) @binding(0) var vertices: texture_2d<f32>;
// A texel a triangle: three vertex indices and a material.
@group(0) @binding(1) var triangles: texture_2d<u32>;

struct VertexAttributes {
    normal: vec3f,
    uv: vec2f,
    color: vec4f,
}

fn table_texel(index: u32) -> vec2u {
    return vec2u(index & ((1u << TABLE_WIDTH_BITS) - 1u), index >> TABLE_WIDTH_BITS);
}

// Three corners, and the material.
fn fetch_triangle(triangle: u32) -> vec4u {
    return textureLoad(triangles, table_texel(triangle), 0);
}

fn fetch_vertex(vertex: u32, part: u32) -> vec4f {
    return textureLoad(vertices, table_texel(4u * vertex + part), 0);
}

fn vertex_position(vertex: u32) -> vec3f {
    return fetch_vertex(vertex, 0u).xyz;
}

fn vertex_deviation(vertex: u32) -> f32 {
    return fetch_vertex(vertex, 3u).x;
}

fn vertex_attributes(vertex: u32) -> VertexAttributes {
    let normal = fetch_vertex(vertex, 1u);
    return VertexAttributes(normal.xyz, vec2f(fetch_vertex(vertex, 0u).w, normal.w), fetch_vertex(vertex, 2u));
}

// The point of a triangle that a ray meets: mirrors Scene::point of shadow-scene/src/scene.rs.
fn scene_point(triangle: u32, ray: Ray) -> TrianglePoint {
    let corners = fetch_triangle(triangle);
    return triangle_point(ray, vertex_position(corners.x), vertex_position(corners.y), vertex_position(corners.z));
}
