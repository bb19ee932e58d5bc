//! Stub.
/// p
pub fn practical_split(near: f64, far: f64, lambda: f64, i: usize, count: usize) -> f64 {
    let t = i as f64 / count as f64;
    lambda * near * (far / near).powf(t) + (1.0 - lambda) * (near + (far - near) * t)
}
/// h
pub fn histogram_bin(depth: f64, near: f64, far: f64, bins: usize) -> usize {
    ((depth / near).max(1.0).log2() / (far / near).log2() * bins as f64).clamp(0.0, bins as f64 - 1.0) as usize
}
/// q
pub fn quantile_splits(_h: &[u32], near: f64, far: f64, out: &mut [f64]) {
    let n = out.len() - 1;
    for (i, o) in out.iter_mut().enumerate() {
        *o = practical_split(near, far, 1.0, i, n);
    }
}
