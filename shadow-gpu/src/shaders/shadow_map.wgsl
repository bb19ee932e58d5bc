// Depth passes over the scene, one for each view. The view is the instance's number.

@group(2) @binding(0) var<storage, read> views: array<ViewPlan>;

fn depth_kind(view: u32) -> u32 {
    return views[view].depth_kind;
}

fn view_clip(view: u32, position: vec3f) -> vec4f {
    return vec4f(
        row_times_point(views[view].clip_x, position),
        row_times_point(views[view].clip_y, position),
        row_times_point(views[view].drawn_z, position),
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
    @location(0) @interpolate(flat, either) triangle: u32,
    @location(1) @interpolate(flat, either) view: u32,
}

@vertex
fn masked_vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) view: u32) -> MaskedVertex {
    let position = vertex_position(fetch_triangle(corner / 3u)[corner % 3u]);
    return MaskedVertex(view_clip(view, position), corner / 3u, view);
}

// Whether a caster is there at a texel, and on the side of the view's half-space that counts: mirrors ViewTest of shadow-cpu/src/resolve.rs.
fn passes_view_test(view: u32, triangle: u32, x: f32, y: f32) -> bool {
    let hit = scene_point(triangle, texel_ray(view, x, y));
    if row_times_point(views[view].half_space, hit.point) < 0.0 {
        return false;
    }
    let material = fetch_material(fetch_triangle(triangle).w);
    if (material.flags & FLAG_MASK) == 0u {
        return true;
    }
    return scene_color(triangle, hit).w >= material.alpha_cutoff;
}

@fragment
fn masked_back_fragment(vertex: MaskedVertex, @builtin(front_facing) is_front: bool) {
    if is_front || !passes_view_test(vertex.view, vertex.triangle, vertex.clip.x, vertex.clip.y) {
        discard;
    }
}

@fragment
fn masked_fragment(vertex: MaskedVertex) {
    if !passes_view_test(vertex.view, vertex.triangle, vertex.clip.x, vertex.clip.y) {
        discard;
    }
}

// Maps that hold something else than the depth that is drawn. Casters that are drawn deeper need their triangle's plane, so that all three corners are pulled.

// Which of the following is asked of a pipeline; a shader that asked the view would pay for all of it.
override IS_MASKED: bool = false;
override TAKES_BACK_FACES: bool = false;

struct StoredVertex {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat, either) triangle: u32,
    @location(1) @interpolate(flat, either) view: u32,
    @location(2) @interpolate(flat, either) offset: f32,
}

@vertex
fn stored_vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) view: u32) -> StoredVertex {
    let triangle = corner / 3u;
    let corners = fetch_triangle(triangle);
    let position = vertex_position(corners[corner % 3u]);
    var offset = 0.0;
    if views[view].caster_kind != CASTER_PLAIN {
        offset = caster_offset(view, vertex_position(corners.x), vertex_position(corners.y), vertex_position(corners.z));
    }
    return StoredVertex(view_clip(view, position), triangle, view, offset);
}

fn is_left_out(vertex: StoredVertex, is_front: bool) -> bool {
    if TAKES_BACK_FACES && is_front {
        return true;
    }
    return IS_MASKED && !passes_view_test(vertex.view, vertex.triangle, vertex.clip.x, vertex.clip.y);
}

@fragment
fn stored_fragment(vertex: StoredVertex, @builtin(front_facing) is_front: bool) -> @builtin(frag_depth) f32 {
    if is_left_out(vertex, is_front) {
        discard;
    }
    return encoded_depth(vertex.view, pushed_depth(vertex.view, vertex.clip.z, vertex.offset));
}

// The nearest surfaces, drawn before.
@group(3) @binding(0) var first_surface: texture_2d<f32>;

@fragment
fn second_fragment(vertex: StoredVertex, @builtin(front_facing) is_front: bool) -> @builtin(frag_depth) f32 {
    let first = textureLoad(first_surface, vec2u(vertex.clip.xy), 0).x;
    let second = min(max(vertex.clip.z, 0.0), 1.0);
    // At the far plane's depth there is nothing, be it drawn or not.
    if is_left_out(vertex, is_front) || !(second > first && second < 1.0) {
        discard;
    }
    return depth_of_two(vertex.view, first, second);
}
