// Filters: mirrors shadow-math/src/filter.rs.

fn support(filter_kind: u32) -> f32 {
    if filter_kind == FILTER_HARD {
        return 0.5;
    }
    return 1.0;
}

fn depth_test(view: u32, x: i32, y: i32, depth: f32, bias: f32) -> f32 {
    let rect = vec4i(views[view].rect);
    if x < rect.x || y < rect.y || x >= rect.x + rect.z || y >= rect.y + rect.w {
        return 1.0;
    }
    let stored = fetch_texel(views[view].layer, u32(x), u32(y));
    if depth <= stored + bias {
        return 1.0;
    }
    return 0.0;
}

fn filtered_test(view: u32, filter_kind: u32, texel: vec2f, depth: f32, bias: f32) -> f32 {
    if filter_kind == FILTER_HARD {
        return depth_test(view, i32(floor(texel.x)), i32(floor(texel.y)), depth, bias);
    }
    let corner = texel - vec2f(0.5, 0.5);
    let floor_x = floor(corner.x);
    let floor_y = floor(corner.y);
    let fraction_x = corner.x - floor_x;
    let fraction_y = corner.y - floor_y;
    let x0 = i32(floor_x);
    let y0 = i32(floor_y);
    let t00 = depth_test(view, x0, y0, depth, bias);
    let t10 = depth_test(view, x0 + 1, y0, depth, bias);
    let t01 = depth_test(view, x0, y0 + 1, depth, bias);
    let t11 = depth_test(view, x0 + 1, y0 + 1, depth, bias);
    let top = t00 + (t10 - t00) * fraction_x;
    let bottom = t01 + (t11 - t01) * fraction_x;
    return top + (bottom - top) * fraction_y;
}
