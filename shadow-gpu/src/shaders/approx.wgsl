// Logarithm and power from + - * / alone: mirrors shadow-math/src/approx.rs.

fn approx_log2(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    let exponent = bitcast<i32>(bits - 0x3f3504f3u) >> 23u;
    let mantissa = bitcast<f32>(bits - (bitcast<u32>(exponent) << 23u));
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let s2 = s * s;
    var series = 0.3205989;
    series = series * s2 + 0.4121986;
    series = series * s2 + 0.577078;
    series = series * s2 + 0.9617967;
    series = series * s2 + 2.88539;
    return f32(exponent) + series * s;
}

fn approx_exp2(x: f32) -> f32 {
    if x < -126.0 {
        return 0.0;
    }
    let clamped = min(x, 127.0);
    let whole = floor(clamped + 0.5);
    let f = clamped - whole;
    var series = 1.5252734e-5;
    series = series * f + 1.540353e-4;
    series = series * f + 0.0013333558;
    series = series * f + 0.009618129;
    series = series * f + 0.05550411;
    series = series * f + 0.2402265;
    series = series * f + 0.6931472;
    series = series * f + 1.0;
    return series * bitcast<f32>(u32(i32(whole) + 127) << 23u);
}

fn approx_pow(x: f32, y: f32) -> f32 {
    if !(x >= 1.17549435e-38) {
        return 0.0;
    }
    return approx_exp2(y * approx_log2(x));
}
