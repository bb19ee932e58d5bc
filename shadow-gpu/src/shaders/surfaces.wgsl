// The scene's materials and texels.

@group(1) @binding(0) var<storage, read> materials: array<MaterialData>;
@group(1) @binding(1) var<storage, read> words: array<u32>;

// The colour and alpha of a triangle's surface at a point of it: mirrors SceneView::color of shadow-cpu/src/resolve.rs.
fn scene_color(triangle: u32, hit: TrianglePoint) -> vec4f {
    let corners = triangle_corners(triangle);
    let a0 = vertex_attributes(corners.x);
    let a1 = vertex_attributes(corners.y);
    let a2 = vertex_attributes(corners.z);
    let uv = a0.uv + (a1.uv - a0.uv) * hit.u + (a2.uv - a0.uv) * hit.v;
    let color = a0.color + (a1.color - a0.color) * hit.u + (a2.color - a0.color) * hit.v;
    return base_color(triangle_material(triangle), uv, color);
}

// Whether an alpha-tested triangle is there: mirrors SceneAlphaTest of shadow-cpu/src/resolve.rs.
fn passes_alpha_test(triangle: u32, ray: Ray) -> bool {
    let material = triangle_material(triangle);
    if (materials[material].flags & FLAG_MASK) == 0u {
        return true;
    }
    let hit = scene_point(triangle, ray);
    return scene_color(triangle, hit).w >= materials[material].alpha_cutoff;
}
