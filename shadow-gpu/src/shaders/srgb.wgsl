// The sRGB transfer function: mirrors shadow-math/src/srgb.rs.

const LINEAR_LIMIT: f32 = 0.0031308;

fn linear_to_srgb(linear: f32) -> f32 {
    let x = min(max(linear, 0.0), 1.0);
    if x <= LINEAR_LIMIT {
        return x * 12.92;
    }
    return 1.055 * approx_pow(x, 0.41666666) - 0.055;
}
