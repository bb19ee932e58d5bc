// Triangles whose clip coordinates are given, for a probe that asks what the rasteriser makes of them.

struct Fragment {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) depth: f32,
}

@vertex
fn corner(@location(0) position: vec4f, @location(1) depth: f32) -> Fragment {
    return Fragment(position, depth);
}

// The triangle's own number as depth, in place of the rasteriser's.
@fragment
fn write_depth(fragment: Fragment) -> @builtin(frag_depth) f32 {
    return fragment.depth;
}
