// A triangle that covers every pixel: passes that work pixel by pixel are fragments of it. Software drivers write a fragment's output many times
// faster than an element of a storage buffer. It lies on the far plane: where the camera's depth is tested to be nearer, pixels that show nothing are
// left out before any shader runs.

@vertex
fn full_screen(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    // (-1, -1), (3, -1) and (-1, 3).
    return vec4f(f32(corner & 1u) * 4.0 - 1.0, f32(corner >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}
