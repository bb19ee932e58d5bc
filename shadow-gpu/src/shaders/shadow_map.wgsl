// Depth passes over the scene, one for each view. The view is the instance's number.

@group(2) @binding(0) var<storage, read> views: array<ViewPlan>;

fn view_clip(view: u32, position: vec3f) -> vec4f {
    return vec4f(
        row_times_point(views[view].clip_x, position),
        row_times_point(views[view].clip_y, position),
        row_times_point(views[view].clip_z, position),
        row_times_point(views[view].clip_w, position),
    );
}

@vertex
fn opaque_vertex(@location(0) position: vec3f, @builtin(instance_index) view: u32) -> @builtin(position) vec4f {
    return view_clip(view, position);
}

// Front faces are left out here rather than by the pipeline's state: see opaque_front_fragment of camera.wgsl.
@fragment
fn opaque_back_fragment(@builtin(front_facing) is_front: bool) {
    if is_front {
        discard;
    }
}

struct MaskedVertex {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat, first) triangle: u32,
    @location(1) @interpolate(flat, first) view: u32,
}

@vertex
fn masked_vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) view: u32) -> MaskedVertex {
    let position = vertex_position(fetch_triangle(corner / 3u)[corner % 3u]);
    return MaskedVertex(view_clip(view, position), corner / 3u, view);
}

@fragment
fn masked_back_fragment(vertex: MaskedVertex, @builtin(front_facing) is_front: bool) {
    let ray = pixel_ray(views[vertex.view].rays, vertex.clip.x, vertex.clip.y);
    if is_front || !passes_alpha_test(vertex.triangle, ray) {
        discard;
    }
}

@fragment
fn masked_fragment(vertex: MaskedVertex) {
    let ray = pixel_ray(views[vertex.view].rays, vertex.clip.x, vertex.clip.y);
    if !passes_alpha_test(vertex.triangle, ray) {
        discard;
    }
}
