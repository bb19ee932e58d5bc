// Filters: mirrors shadow-math/src/filter.rs and its folder.

const MAX_FOOTPRINT_TESTS: u32 = 16u;
const FOOTPRINT_TESTS_PER_TEXEL: f32 = 2.0;
const MAX_FLOAT: f32 = 3.40282347e+38;

const TURNS = array<vec2f, 16>(
    vec2f(1.0, 0.0),
    vec2f(0.9238795, 0.38268343),
    vec2f(0.70710677, 0.70710677),
    vec2f(0.38268343, 0.9238795),
    vec2f(0.0, 1.0),
    vec2f(-0.38268343, 0.9238795),
    vec2f(-0.70710677, 0.70710677),
    vec2f(-0.9238795, 0.38268343),
    vec2f(-1.0, 0.0),
    vec2f(-0.9238795, -0.38268343),
    vec2f(-0.70710677, -0.70710677),
    vec2f(-0.38268343, -0.9238795),
    vec2f(0.0, -1.0),
    vec2f(0.38268343, -0.9238795),
    vec2f(0.70710677, -0.70710677),
    vec2f(0.9238795, -0.38268343),
);
const DITHER = array<u32, 16>(0u, 8u, 2u, 10u, 12u, 4u, 14u, 6u, 3u, 11u, 1u, 9u, 15u, 7u, 13u, 5u);

// What a lookup asks of the maps.
struct Lookup {
    view: u32,
    known: f32,
    texel: vec2f,
    depth: f32,
    bias: f32,
    turn: vec2f,
    footprint: Footprint,
    slope: vec2f,
    slope_limit: f32,
}

struct Footprint {
    x: vec2f,
    y: vec2f,
}

fn turn_of_pixel(pixel: vec2u) -> vec2f {
    var turns = TURNS;
    var dither = DITHER;
    return turns[dither[(pixel.y % 4u) * 4u + pixel.x % 4u]];
}

fn support(light: u32, gradient: vec2f, footprint: Footprint) -> f32 {
    let kind = filter_kind(light);
    if kind <= FILTER_SEPARABLE {
        return lights[light].filter_reach;
    }
    let sum = abs(gradient.x) + abs(gradient.y);
    if !(sum > 0.0 && sum <= MAX_FLOAT) {
        return lights[light].filter_reach;
    }
    let share = vec2f(gradient.x / sum, gradient.y / sum);
    if kind == FILTER_CROSS {
        return 0.5 + max(abs(share.x), abs(share.y));
    }
    if kind == FILTER_DISC {
        return 0.5 + lights[light].filter_reach * sqrt(share.x * share.x + share.y * share.y);
    }
    let along_x = abs(footprint.x.x * share.x + footprint.x.y * share.y);
    let along_y = abs(footprint.y.x * share.x + footprint.y.y * share.y);
    return 0.5 + 0.5 * (along_x + along_y);
}

fn depth_test(view: u32, x: i32, y: i32, depth: f32, bias: f32) -> f32 {
    let rect = vec4i(views[view].rect);
    if x < rect.x || y < rect.y || x >= rect.x + rect.z || y >= rect.y + rect.w {
        return 1.0;
    }
    let stored = comparable_depth(view, fetch_texel(views[view].layer, u32(x), u32(y)));
    if depth <= stored + bias {
        return 1.0;
    }
    return 0.0;
}

fn tap_depth(light: u32, asked: Lookup, x: i32, y: i32) -> f32 {
    if (bias_kind(light) & BIAS_RECEIVER_PLANE) == 0u {
        return asked.depth;
    }
    let along_x = asked.slope.x * (f32(x) + 0.5 - asked.texel.x);
    let along_y = asked.slope.y * (f32(y) + 0.5 - asked.texel.y);
    let correction = min(max(along_x + along_y, -asked.slope_limit), asked.slope_limit);
    return min(asked.depth + correction, depth_limits(asked.view).y);
}

fn tap_test(light: u32, asked: Lookup, x: i32, y: i32) -> f32 {
    return depth_test(asked.view, x, y, tap_depth(light, asked, x, y), asked.bias);
}

fn stored(view: u32, x: i32, y: i32) -> f32 {
    let rect = vec4i(views[view].rect);
    if x < rect.x || y < rect.y || x >= rect.x + rect.z || y >= rect.y + rect.w {
        return 1.0;
    }
    return fetch_texel(views[view].layer, u32(x), u32(y));
}

fn stored_gradient(view: u32, light: u32, texel: vec2f) -> f32 {
    let x = i32(floor(texel.x));
    let y = i32(floor(texel.y));
    let across = abs(stored(view, x + 1, y) - stored(view, x - 1, y));
    let down = abs(stored(view, x, y + 1) - stored(view, x, y - 1));
    let difference = min(max(across, down), lights[light].gradient_clamp);
    return difference * lights[light].gradient_scale + stored(view, x, y) * lights[light].gradient_fixed;
}

fn test_at(light: u32, asked: Lookup, place: vec2f) -> f32 {
    return tap_test(light, asked, i32(floor(place.x)), i32(floor(place.y)));
}

fn bilinear_test(light: u32, asked: Lookup) -> f32 {
    let corner = asked.texel - vec2f(0.5, 0.5);
    let floor_x = floor(corner.x);
    let floor_y = floor(corner.y);
    let fraction_x = corner.x - floor_x;
    let fraction_y = corner.y - floor_y;
    let x0 = i32(floor_x);
    let y0 = i32(floor_y);
    let t00 = tap_test(light, asked, x0, y0);
    let t10 = tap_test(light, asked, x0 + 1, y0);
    let t01 = tap_test(light, asked, x0, y0 + 1);
    let t11 = tap_test(light, asked, x0 + 1, y0 + 1);
    let top = t00 + (t10 - t00) * fraction_x;
    let bottom = t01 + (t11 - t01) * fraction_x;
    return top + (bottom - top) * fraction_y;
}

fn kernel_weight(light: u32, tap: i32) -> f32 {
    return lights[light].filter_table[tap / 4][tap % 4];
}

fn separable_test(light: u32, asked: Lookup) -> f32 {
    let taps = i32(lights[light].filter_taps);
    let half_kernel = 0.5 * f32(taps);
    let corner = asked.texel - vec2f(half_kernel, half_kernel);
    let floor_x = floor(corner.x);
    let floor_y = floor(corner.y);
    let fraction_x = corner.x - floor_x;
    let fraction_y = corner.y - floor_y;
    let x0 = i32(floor_x);
    let y0 = i32(floor_y);
    var sum = 0.0;
    var column_before = 0.0;
    for (var x = 0; x <= taps; x++) {
        var column = 0.0;
        var above = tap_test(light, asked, x0 + x, y0);
        for (var y = 0; y < taps; y++) {
            let below = tap_test(light, asked, x0 + x, y0 + y + 1);
            column += kernel_weight(light, y) * (above + (below - above) * fraction_y);
            above = below;
        }
        if x > 0 {
            sum += kernel_weight(light, x - 1) * (column_before + (column - column_before) * fraction_x);
        }
        column_before = column;
    }
    let total = lights[light].filter_total;
    return sum / (total * total);
}

fn cross_test(light: u32, asked: Lookup) -> f32 {
    let x = i32(floor(asked.texel.x));
    let y = i32(floor(asked.texel.y));
    let beside = tap_test(light, asked, x - 1, y)
        + tap_test(light, asked, x + 1, y);
    let above = tap_test(light, asked, x, y - 1)
        + tap_test(light, asked, x, y + 1);
    return (tap_test(light, asked, x, y) + beside + above) / 5.0;
}

fn disc_place(light: u32, asked: Lookup, tap: u32) -> vec2f {
    let pair = lights[light].filter_table[tap / 2u];
    let place = select(pair.xy, pair.zw, tap % 2u == 1u);
    let turn = asked.turn;
    return vec2f(
        asked.texel.x + place.x * turn.x - place.y * turn.y,
        asked.texel.y + place.x * turn.y + place.y * turn.x,
    );
}

fn disc_test(light: u32, asked: Lookup) -> f32 {
    let taps = lights[light].filter_taps;
    var lit = 0.0;
    for (var tap = 0u; tap < taps; tap++) {
        lit += test_at(light, asked, disc_place(light, asked, tap));
    }
    return lit / f32(taps);
}

fn footprint_count(side: vec2f) -> u32 {
    let wanted = floor(max(abs(side.x), abs(side.y)) * FOOTPRINT_TESTS_PER_TEXEL) + 1.0;
    return u32(min(wanted, f32(MAX_FOOTPRINT_TESTS)));
}

fn footprint_place(asked: Lookup, at: vec2u, counts: vec2u) -> vec2f {
    let a = (f32(at.x) + 0.5) / f32(counts.x) - 0.5;
    let b = (f32(at.y) + 0.5) / f32(counts.y) - 0.5;
    let side_x = asked.footprint.x;
    let side_y = asked.footprint.y;
    return vec2f(
        asked.texel.x + side_x.x * a + side_y.x * b,
        asked.texel.y + side_x.y * a + side_y.y * b,
    );
}

fn footprint_test(light: u32, asked: Lookup) -> f32 {
    let counts = vec2u(footprint_count(asked.footprint.x), footprint_count(asked.footprint.y));
    var lit = 0.0;
    for (var row = 0u; row < counts.y; row++) {
        for (var column = 0u; column < counts.x; column++) {
            lit += test_at(light, asked, footprint_place(asked, vec2u(column, row), counts));
        }
    }
    return lit / f32(counts.x * counts.y);
}

fn filtered_test(light: u32, asked: Lookup) -> f32 {
    let kind = filter_kind(light);
    if kind == FILTER_HARD {
        return test_at(light, asked, asked.texel);
    }
    if kind == FILTER_BILINEAR {
        return bilinear_test(light, asked);
    }
    if kind == FILTER_SEPARABLE {
        return separable_test(light, asked);
    }
    if kind == FILTER_CROSS {
        return cross_test(light, asked);
    }
    if kind == FILTER_DISC {
        return disc_test(light, asked);
    }
    return footprint_test(light, asked);
}
