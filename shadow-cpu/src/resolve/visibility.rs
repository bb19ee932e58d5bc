//! The visibility of one light for a span of pixels.

use shadow_math::{
    filter::{bilinear_corner, bilinear_mean},
    fit::cube_face_of,
    glam::Vec2,
    plan::{FILTER_BILINEAR, FILTER_FOOTPRINT, FILTER_HARD, LightPlan, PixelRays, SPLIT_SINGLE, ViewPlan, toward_light},
    visibility::{NO_VIEW, lookup_in_view, visibility},
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
    match (common_view(light, hits, count), light.filter) {
        (Some(view), FILTER_BILINEAR) => vector_visibility::<true>(light, &views[view as usize], maps, hits, out),
        (Some(view), FILTER_HARD) => vector_visibility::<false>(light, &views[view as usize], maps, hits, out),
        (_, FILTER_FOOTPRINT) => {
            for i in 0..count {
                out[i] = visibility(light, views, maps, &hits.receiver_with_steps(rays, i));
            }
        }
        _ => {
            for i in 0..count {
                out[i] = visibility(light, views, maps, &hits.receiver(i));
            }
        }
    }
}

/// The view that all pixels of a span ask.
#[inline(always)]
fn common_view(light: &LightPlan, hits: &Hits, count: usize) -> Option<u32> {
    if light.split == SPLIT_SINGLE {
        return Some(light.first_view);
    }
    let first = cube_face_of(-toward_light(light, hits.point.get(0)));
    let mut is_common = true;
    for i in 1..count {
        is_common &= cube_face_of(-toward_light(light, hits.point.get(i))) == first;
    }
    is_common.then_some(light.first_view + first)
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
    // The compiler is to know which filter it is: what others need is left out.
    let light = LightPlan { filter: if BILINEAR { FILTER_BILINEAR } else { FILTER_HARD }, ..*light };
    let view = *view;
    let mut lookups = Lookups {
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
        let lookup = lookup_in_view(&light, &view, 0, &receiver);
        let (x, y, fraction) = if BILINEAR { bilinear_corner(lookup.texel) } else { hard_texel(lookup.texel) };
        lookups.known[i] = if faces_light { lookup.known } else { 0.0 };
        lookups.asks[i] = -i32::from(faces_light & (lookup.view != NO_VIEW));
        lookups.x[i] = x;
        lookups.y[i] = y;
        lookups.fraction[0][i] = fraction.x;
        lookups.fraction[1][i] = fraction.y;
        lookups.depth[i] = lookup.depth;
        lookups.bias[i] = lookup.bias;
    }
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
                    lookups.stored[tap][i] = *depth;
                }
            }
        } else {
            let taps = if BILINEAR { 4 } else { 1 };
            for (tap, (dx, dy)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().take(taps).enumerate() {
                let (x, y) = (x + dx, y + dy);
                let is_inside = x >= left && y >= top && x < left + width && y < top + height;
                lookups.stored[tap][i] = if is_inside { layer[y as usize * size + x as usize] } else { f32::INFINITY };
            }
        }
    }
}
