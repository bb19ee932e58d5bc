// The camera pass: which triangle each pixel shows. Vertices are pulled, so that every vertex knows its triangle; and since all three do, it does not matter whose a pixel takes.

@group(2) @binding(0) var<uniform> camera: CameraPlan;

struct CameraVertex {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat, either) triangle: u32,
}

@vertex
fn camera_vertex(@builtin(vertex_index) corner: u32) -> CameraVertex {
    let position = vertex_position(fetch_triangle(corner / 3u)[corner % 3u]);
    let clip = vec4f(
        row_times_point(camera.clip_x, position),
        row_times_point(camera.clip_y, position),
        row_times_point(camera.clip_z, position),
        row_times_point(camera.clip_w, position),
    );
    return CameraVertex(clip, corner / 3u);
}

@fragment
fn opaque_fragment(vertex: CameraVertex) -> @location(0) u32 {
    return vertex.triangle;
}

// Back faces of single-sided materials are left out here rather than by the pipeline's state: a driver that clips in software can cull by
// an area in floating point, whose sign is not that of the area on the grid where a triangle is thinner than a step of it.
@fragment
fn opaque_front_fragment(vertex: CameraVertex, @builtin(front_facing) is_front: bool) -> @location(0) u32 {
    if !is_front {
        discard;
    }
    return vertex.triangle;
}

@fragment
fn masked_front_fragment(vertex: CameraVertex, @builtin(front_facing) is_front: bool) -> @location(0) u32 {
    if !is_front {
        discard;
    }
    return masked_triangle(vertex);
}

@fragment
fn masked_fragment(vertex: CameraVertex) -> @location(0) u32 {
    return masked_triangle(vertex);
}

fn masked_triangle(vertex: CameraVertex) -> u32 {
    let ray = pixel_ray(camera.rays, vertex.clip.x, vertex.clip.y);
    if !passes_alpha_test(vertex.triangle, ray) {
        discard;
    }
    return vertex.triangle;
}
