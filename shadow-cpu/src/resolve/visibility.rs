//! The visibility of one light for a span of pixels.

use shadow_math::{
    depth::comparable_depth,
    filter::{bilinear_corner, bilinear_mean, kernel::MAX_KERNEL, separable_corner},
    fit::cube_face_of,
    glam::Vec2,
    plan::{
        BIAS_RECEIVER_GRADIENT, BIAS_RECEIVER_PLANE, FILTER_BILINEAR, FILTER_FOOTPRINT, FILTER_HARD, FILTER_SEPARABLE, LightPlan,
        PixelRays, SPLIT_CASCADES, SPLIT_CUBE, SPLIT_SINGLE, ViewPlan, toward_light,
    },
    visibility::{Choice, NO_VIEW, choose_views, lookup_in_view, visibility},
};

use super::{
    ShadowMaps,
    span::{Hits, Numbers, SPAN},
};

/// The lookups of a span in one view, with the four texels around each.
struct Lookups {
    /// What is known without a map; looked at where nothing is asked of one.
    known: Numbers,
    /// Below 0 where the map is asked.
    asks: [i32; SPAN],
    x: [i32; SPAN],
    y: [i32; SPAN],
    fraction: [Numbers; 2],
    depth: Numbers,
    bias: Numbers,
    stored: [Numbers; 4],
}

/// Tests of lights with a single view, which most are, go through vectors, and those of a point light where a whole span falls
/// into one face. For what is left one pixel after the other gives the same.
#[inline(always)]
pub(crate) fn span_visibility(
    light: &LightPlan,
    views: &[ViewPlan],
    maps: &ShadowMaps,
    hits: &Hits,
    rays: &PixelRays,
    count: usize,
    out: &mut Numbers,
) {
    // Taps with depths or biases of their own go one pixel after the other.
    let is_plain = light.bias & (BIAS_RECEIVER_PLANE | BIAS_RECEIVER_GRADIENT) == 0;
    let mut choices = [NOT_CHOSEN; SPAN];
    let common = common_view(light, views, hits, count, &mut choices);
    if common.is_some_and(|view| !views[view as usize].has_map()) {
        // No map, and no layer that could be looked at.
        for i in 0..count {
            let choice = choose_views(light, views, &hits.receiver(i));
            out[i] = if choice.first == NO_VIEW { choice.known } else { 1.0 };
        }
        return;
    }
    match (common.filter(|_| is_plain), light.filter) {
        (Some(view), FILTER_BILINEAR) => vector_visibility::<true>(light, &views[view as usize], maps, hits, out),
        (Some(view), FILTER_HARD) => vector_visibility::<false>(light, &views[view as usize], maps, hits, out),
        (Some(view), FILTER_SEPARABLE) => {
            let view = &views[view as usize];
            match light.filter_taps {
                3 => separable_visibility::<3>(light, view, maps, hits, out),
                4 => separable_visibility::<4>(light, view, maps, hits, out),
                5 => separable_visibility::<5>(light, view, maps, hits, out),
                6 => separable_visibility::<6>(light, view, maps, hits, out),
                7 => separable_visibility::<7>(light, view, maps, hits, out),
                8 => separable_visibility::<8>(light, view, maps, hits, out),
                _ => separable_visibility::<9>(light, view, maps, hits, out),
            }
        }
        (_, FILTER_FOOTPRINT) => {
            for i in 0..count {
                out[i] = visibility(light, views, maps, &hits.receiver_with_steps(rays, i));
            }
        }
        _ => {
            for i in 0..count {
                out[i] = visibility(light, views, maps, &hits.receiver(i));
            }
            return;
        }
    }
    if light.split == SPLIT_CASCADES || light.shadow_far < f32::MAX {
        for (out, choice) in out.iter_mut().zip(&choices[..count]) {
            if choice.first == NO_VIEW {
                *out = choice.known;
            }
        }
    }
}

/// The choice of a pixel that was not asked.
const NOT_CHOSEN: Choice = Choice { first: NO_VIEW, second: NO_VIEW, share: 0.0, known: 0.0 };

/// The view that all pixels of a span ask, of those that ask any; what each of them chooses goes to `choices` where a light has more than one view or shadows end.
#[inline(always)]
fn common_view(light: &LightPlan, views: &[ViewPlan], hits: &Hits, count: usize, choices: &mut [Choice; SPAN]) -> Option<u32> {
    if light.view_count == 0 {
        return None;
    }
    if light.split == SPLIT_CUBE && light.shadow_far == f32::MAX {
        let first = cube_face_of(-toward_light(light, hits.point.get(0)));
        let mut is_common = true;
        for i in 1..count {
            is_common &= cube_face_of(-toward_light(light, hits.point.get(i))) == first;
        }
        return is_common.then_some(light.first_view + first);
    }
    if light.split == SPLIT_SINGLE && light.shadow_far == f32::MAX {
        return Some(light.first_view);
    }
    let mut common = NO_VIEW;
    let mut is_common = true;
    for i in 0..count {
        let choice = choose_views(light, views, &hits.receiver(i));
        choices[i] = choice;
        if choice.first != NO_VIEW {
            is_common &= common == NO_VIEW || common == choice.first;
            is_common &= choice.share == 0.0;
            common = choice.first;
        }
    }
    // Where nothing is asked any view will do.
    if common == NO_VIEW {
        common = light.first_view;
    }
    is_common.then_some(common)
}

impl Lookups {
    /// The lookups of a span in one view; `corner` has the first texel around a place, and the weights of what lies beyond it. `filter` is the light's, of which the compiler is to
    /// know which it is: what others need is left out.
    #[inline(always)]
    fn of(light: &LightPlan, filter: u32, view: &ViewPlan, hits: &Hits, corner: impl Fn(Vec2) -> (i32, i32, Vec2)) -> Self {
        let light = LightPlan { filter, ..*light };
        let mut lookups = Self {
            known: [0.0; SPAN],
            asks: [0; SPAN],
            x: [0; SPAN],
            y: [0; SPAN],
            fraction: [[0.0; SPAN]; 2],
            depth: [0.0; SPAN],
            bias: [0.0; SPAN],
            stored: [[0.0; SPAN]; 4],
        };
        for i in 0..SPAN {
            let receiver = hits.receiver(i);
            let faces_light = receiver.normal.dot(toward_light(&light, receiver.point)) > 0.0;
            let lookup = lookup_in_view(&light, view, 0, &receiver);
            let (x, y, fraction) = corner(lookup.texel);
            lookups.known[i] = if faces_light { lookup.known } else { 0.0 };
            lookups.asks[i] = -i32::from(faces_light & (lookup.view != NO_VIEW));
            lookups.x[i] = x;
            lookups.y[i] = y;
            lookups.fraction[0][i] = fraction.x;
            lookups.fraction[1][i] = fraction.y;
            lookups.depth[i] = lookup.depth;
            lookups.bias[i] = lookup.bias;
        }
        lookups
    }
}

/// Four tests a pixel with `BILINEAR`, else one.
#[inline(always)]
fn vector_visibility<const BILINEAR: bool>(
    light: &LightPlan,
    view: &ViewPlan,
    maps: &ShadowMaps,
    hits: &Hits,
    out: &mut Numbers,
) {
    let view = *view;
    let mut lookups = if BILINEAR {
        Lookups::of(light, FILTER_BILINEAR, &view, hits, bilinear_corner)
    } else {
        Lookups::of(light, FILTER_HARD, &view, hits, hard_texel)
    };
    fetch::<BILINEAR>(&view, maps, &mut lookups);
    for i in 0..SPAN {
        let mut tests = [0.0; 4];
        for tap in 0..if BILINEAR { 4 } else { 1 } {
            let is_lit = lookups.depth[i] <= lookups.stored[tap][i] + lookups.bias[i];
            tests[tap] = if is_lit { 1.0 } else { 0.0 };
        }
        let fraction = Vec2::new(lookups.fraction[0][i], lookups.fraction[1][i]);
        let mean = if BILINEAR { bilinear_mean(tests[0], tests[1], tests[2], tests[3], fraction) } else { tests[0] };
        out[i] = if lookups.asks[i] < 0 { mean } else { lookups.known[i] };
    }
}

/// A square of tests under a kernel of `TAPS` weights: the columns of a pixel side by side, in the order of [`filtered_test`](shadow_math::filter::filtered_test).
#[inline(always)]
fn separable_visibility<const TAPS: usize>(
    light: &LightPlan,
    view: &ViewPlan,
    maps: &ShadowMaps,
    hits: &Hits,
    out: &mut Numbers,
) {
    let (light, view) = (*light, *view);
    let lookups = Lookups::of(&light, FILTER_SEPARABLE, &view, hits, |texel| separable_corner(&light, texel));
    let table = light.filter_table.as_flattened();
    let mut kernel = [0.0; MAX_KERNEL];
    kernel[..TAPS].copy_from_slice(&table[..TAPS]);
    for i in 0..SPAN {
        if lookups.asks[i] == 0 {
            out[i] = lookups.known[i];
            continue;
        }
        let tests = |row: usize| row_of_tests::<TAPS>(&view, maps, &lookups, i, row);
        let mut columns = [0.0; MAX_KERNEL + 1];
        let mut above = tests(0);
        for row in 0..TAPS {
            let below = tests(row + 1);
            for x in 0..=TAPS {
                columns[x] += kernel[row] * (above[x] + (below[x] - above[x]) * lookups.fraction[1][i]);
            }
            above = below;
        }
        let mut sum = 0.0;
        for x in 0..TAPS {
            sum += kernel[x] * (columns[x] + (columns[x + 1] - columns[x]) * lookups.fraction[0][i]);
        }
        out[i] = sum / (light.filter_total * light.filter_total);
    }
}

/// The tests of a row of texels around the lookup of one pixel. Texels outside the view's rectangle are lit.
#[inline(always)]
fn row_of_tests<const TAPS: usize>(
    view: &ViewPlan,
    maps: &ShadowMaps,
    lookups: &Lookups,
    i: usize,
    row: usize,
) -> [f32; MAX_KERNEL + 1] {
    let size = maps.size as usize;
    let layer: &[f32] = &maps.layers[view.layer as usize];
    let [left, top, width, height] = view.rect.map(|side| side as i32);
    let (x0, y) = (lookups.x[i], lookups.y[i] + row as i32);
    let is_lit = |stored: f32| if lookups.depth[i] <= comparable_depth(view, stored) + lookups.bias[i] { 1.0 } else { 0.0 };
    let mut tests = [1.0; MAX_KERNEL + 1];
    let is_row_inside = y >= top && y < top + height;
    if is_row_inside && x0 >= left && x0 + (TAPS as i32) < left + width {
        let first = y as usize * size + x0 as usize;
        for (test, &stored) in tests.iter_mut().zip(&layer[first..=first + TAPS]) {
            *test = is_lit(stored);
        }
    } else if is_row_inside {
        for (test, x) in tests.iter_mut().zip(x0..=x0 + TAPS as i32) {
            if x >= left && x < left + width {
                *test = is_lit(layer[y as usize * size + x as usize]);
            }
        }
    }
    tests
}

/// The texel that a place lies in, in the form of [`bilinear_corner`].
#[inline(always)]
fn hard_texel(texel: Vec2) -> (i32, i32, Vec2) {
    (texel.x.floor() as i32, texel.y.floor() as i32, Vec2::ZERO)
}

/// Fetches the texels of each lookup that asks: four, or the first alone. Texels outside the view's rectangle are infinitely far: they count as lit.
#[inline(always)]
fn fetch<const BILINEAR: bool>(view: &ViewPlan, maps: &ShadowMaps, lookups: &mut Lookups) {
    let size = maps.size as usize;
    let layer: &[f32] = &maps.layers[view.layer as usize];
    let [left, top, width, height] = view.rect.map(|side| side as i32);
    for i in 0..SPAN {
        if lookups.asks[i] == 0 {
            continue;
        }
        let (x, y) = (lookups.x[i], lookups.y[i]);
        if BILINEAR && x >= left && y >= top && x + 1 < left + width && y + 1 < top + height {
            let upper = y as usize * size + x as usize;
            let lower = upper + size;
            if let (Some([a, b]), Some([c, d])) = (layer[upper..].first_chunk::<2>(), layer[lower..].first_chunk::<2>()) {
                for (tap, depth) in [a, b, c, d].into_iter().enumerate() {
                    lookups.stored[tap][i] = comparable_depth(view, *depth);
                }
            }
        } else {
            let taps = if BILINEAR { 4 } else { 1 };
            for (tap, (dx, dy)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().take(taps).enumerate() {
                let (x, y) = (x + dx, y + dy);
                let is_inside = x >= left && y >= top && x < left + width && y < top + height;
                let stored = || comparable_depth(view, layer[y as usize * size + x as usize]);
                lookups.stored[tap][i] = if is_inside { stored() } else { f32::INFINITY };
            }
        }
    }
}
