// The scene's geometry, pulled from storage buffers.

struct GeometryLayout {
    vertex_count: u32,
    triangle_count: u32,
}

// Three coordinates a vertex, then nine attributes a vertex: normal, texture coordinates, colour.
@group(0) @binding(0) var<storage, read> vertices: array<f32>;
// Three vertex indices a triangle, then one material a triangle.
@group(0) @binding(1) var<storage, read> triangles: array<u32>;
@group(0) @binding(2) var<uniform> geometry: GeometryLayout;

struct VertexAttributes {
    normal: vec3f,
    uv: vec2f,
    color: vec4f,
}

fn triangle_corners(triangle: u32) -> vec3u {
    return vec3u(triangles[3u * triangle], triangles[3u * triangle + 1u], triangles[3u * triangle + 2u]);
}

fn triangle_material(triangle: u32) -> u32 {
    return triangles[3u * geometry.triangle_count + triangle];
}

fn vertex_position(vertex: u32) -> vec3f {
    return vec3f(vertices[3u * vertex], vertices[3u * vertex + 1u], vertices[3u * vertex + 2u]);
}

fn vertex_attributes(vertex: u32) -> VertexAttributes {
    let first = 3u * geometry.vertex_count + 9u * vertex;
    let normal = vec3f(vertices[first], vertices[first + 1u], vertices[first + 2u]);
    let uv = vec2f(vertices[first + 3u], vertices[first + 4u]);
    let color = vec4f(vertices[first + 5u], vertices[first + 6u], vertices[first + 7u], vertices[first + 8u]);
    return VertexAttributes(normal, uv, color);
}

// The point of a triangle that a ray meets: mirrors Scene::point of shadow-scene/src/scene.rs.
fn scene_point(triangle: u32, ray: Ray) -> TrianglePoint {
    let corners = triangle_corners(triangle);
    return triangle_point(ray, vertex_position(corners.x), vertex_position(corners.y), vertex_position(corners.z));
}
