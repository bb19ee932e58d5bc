//! The taps of a lookup: which texels decided, and which points of the receiver's plane these stand for.

use core::f64::consts::SQRT_2;

use glam::{DVec2, DVec3, DVec4, IVec2};
use shadow_math::{
    caster::{CASTER_PLAIN, caster_offset, pushed_depth},
    depth::{DEPTH_LINEAR, DEPTH_REVERSED, DEPTH_Z_OVER_W, DepthScale, LAYER_FIRST, comparable_depth, depth_limits},
    filter::taps::for_each_weighted_tap,
    fit::cube_face_of,
    plan::{LightPlan, SPLIT_CUBE, ViewPlan, toward_light},
    rounding::MAX_TRIANGLE_LENGTH,
    vector::row_times_point,
    visibility::{Lookup, MapAccess},
};
use shadow_scene::SceneLight;

use crate::trace::{AROUND, Clearance, SurfacePoint};

/// How far the corners of a flat surface made of many triangles can lie off its plane, as a share of their largest coordinate. Each is rounded to f32: by half a step,
/// `2^-24` of its size, on each axis, and so by `sqrt(3)` of that across the plane. Three of them decide a triangle's plane, and where a fourth is met, as in
/// a quadrilateral's other half, all four add up: `4 sqrt(3) 2^-24`, a little less than this.
const VERTEX_ROUNDING: f64 = 1.0 / (1_u32 << 21) as f64;

/// A tap whose texel hides the receiver.
pub(super) struct HidingTap {
    texel: IVec2,
    /// What the texel holds.
    stored: f32,
    /// The point of the receiver's plane behind the texel's centre.
    pub(super) behind: DVec3,
}

/// A lookup's taps on a receiver's plane.
pub(super) struct Taps<'a> {
    view: &'a ViewPlan,
    receiver: &'a SurfacePoint,
    texels: Vec<IVec2>,
    /// How far the tap's points lie above the receiver's plane, in metres.
    lift: f64,
    /// How far the outline of a caster in the map can be from the true one, in texels on each axis: half a step of the sub-pixel grid that corners are
    /// snapped to, and the plan's bound on the rounding of where they are before.
    outline_error: f64,
}

impl<'a> Taps<'a> {
    /// The taps that a lookup in this view weighs. `largest` is the largest coordinate of the receiver's triangle, in metres.
    pub(super) fn of(light: &LightPlan, view: &'a ViewPlan, lookup: &Lookup, receiver: &'a SurfacePoint, largest: f64) -> Self {
        let mut texels = Vec::new();
        for_each_weighted_tap(light, lookup, |texel| texels.push(texel));
        // Several tests of a disc or a footprint fall into the same texel.
        texels.sort_unstable_by_key(|texel| (texel.y, texel.x));
        texels.dedup();
        let w = row_times_point(view.clip_w, receiver.position.as_vec3());
        // A receiver that lies before the near plane is known to be lit.
        let least_w = if view.is_warped == 0 { view.depth_range[0] } else { 0.0 };
        let rounding = view.rounding_texels[0] + view.rounding_texels[1] / w.max(least_w.max(f32::MIN_POSITIVE));
        let outline_error = f64::from(view.snap_texels + rounding);
        Self { view, receiver, texels, lift: receiver.lift + VERTEX_ROUNDING * largest, outline_error }
    }

    /// Whether any texel belongs to another map of the light, or to none.
    pub(super) fn cross_seam(&self, light: &LightPlan, lookup: &Lookup) -> bool {
        let [left, top, width, height] = self.view.rect.map(|side| side as i32);
        self.texels.iter().any(|texel| {
            let is_inside = texel.x >= left && texel.y >= top && texel.x < left + width && texel.y < top + height;
            let is_of_other_face = || {
                let face = |point: SurfacePoint| cube_face_of(-toward_light(light, point.position.as_vec3()));
                self.point(*texel, [0.0; 2]).is_some_and(|point| light.first_view + face(point) != lookup.view)
            };
            !is_inside || light.split == SPLIT_CUBE && is_of_other_face()
        })
    }

    /// The points of the receiver's plane behind the texels' centres; `None` for each that the light's ray does not meet.
    pub(super) fn centers(&self) -> impl Iterator<Item = Option<SurfacePoint>> {
        self.texels.iter().map(|texel| self.point(*texel, [0.0; 2]))
    }

    /// As [`Self::centers`], for points beside the centres by as much as outlines in the map can be off.
    pub(super) fn around(&self) -> impl Iterator<Item = Option<SurfacePoint>> {
        let e = self.outline_error;
        self.texels.iter().flat_map(move |texel| AROUND.map(|[x, y]| self.point(*texel, [x * e, y * e])))
    }

    /// The taps whose texels hide the receiver.
    pub(super) fn hiding(&self, maps: &(dyn MapAccess + Sync), lookup: &Lookup) -> impl Iterator<Item = HidingTap> {
        let [left, top, width, height] = self.view.rect.map(|side| side as i32);
        self.texels.iter().filter_map(move |&texel| {
            let is_inside = texel.x >= left && texel.y >= top && texel.x < left + width && texel.y < top + height;
            if !is_inside {
                return None;
            }
            let stored = comparable_depth(self.view, maps.fetch_texel(self.view.layer, texel.x as u32, texel.y as u32));
            let is_lit = lookup.depth <= stored + lookup.bias;
            let behind = self.point(texel, [0.0; 2])?.position;
            (!is_lit).then_some(HidingTap { texel, stored, behind })
        })
    }

    /// Whether a tap's texel can hold what it does where the light meets this surface first: the depth of the surface's plane, at the texel's centre or beside it by as
    /// much as a map can be off.
    pub(super) fn can_hold(&self, tap: &HidingTap, seen: &SurfacePoint) -> bool {
        // A second surface, and a caster that is drawn deeper, have other depths than what is seen first.
        if self.view.depth_layer != LAYER_FIRST || self.view.caster_kind != CASTER_PLAIN {
            return true;
        }
        let e = self.outline_error;
        let row = |row: [f32; 4]| DVec4::from_array(row.map(f64::from));
        let w = row(self.view.clip_w).dot(seen.position.extend(1.0));
        let metres = DepthScale { factor: f64::from(self.view.depth_factor), w_per_metre: f64::from(self.view.w_per_metre) };
        let rounding = f64::from(self.view.rounding_depth[0])
            + f64::from(self.view.rounding_depth[1]) / w
            + metres.depth_of_metres(w, f64::from(self.view.rounding_metres));
        let depth_at = |[x, y]: [f64; 2]| {
            let place = [f64::from(tap.texel.x) + 0.5 + x * e, f64::from(tap.texel.y) + 0.5 + y * e];
            let point = point_behind(self.view, place, seen)?.position.extend(1.0);
            Some(row(self.view.clip_z).dot(point) / row(self.view.clip_w).dot(point)).map(|z| forward_depth(self.view, z))
        };
        // A plane that the light runs along can have any depth.
        let depths: Option<Vec<f64>> = AROUND.into_iter().map(depth_at).collect();
        depths.is_none_or(|depths| {
            let nearest = depths.iter().copied().fold(f64::INFINITY, f64::min);
            let farthest = depths.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            // Beyond the planes of a pancaked view all is drawn onto them.
            let drawn = |depth: f64| if self.view.is_pancaked() { depth.clamp(0.0, 1.0) } else { depth };
            (drawn(nearest) - rounding..=drawn(farthest) + rounding).contains(&z_over_w(self.view, f64::from(tap.stored)))
        })
    }

    /// Whether a rasteriser's depths of a triangle have no bound on rounding in this map: slivers, by the [bound](shadow_math::rounding) that holds for all others, and
    /// triangles whose image is no thicker than their corners' own rounding.
    pub(super) fn is_sliver(&self, corners: &[DVec3; 3]) -> bool {
        let row = |row: [f32; 4]| DVec4::from_array(row.map(f64::from));
        let height = |area: f64, sides: [f64; 3]| area / sides.into_iter().fold(f64::MIN_POSITIVE, f64::max);
        let ws = corners.map(|corner| row(self.view.clip_w).dot(corner.extend(1.0)));
        let w = ws.into_iter().fold(f64::INFINITY, f64::min).max(f64::MIN_POSITIVE);
        let (w, texel) = if self.view.is_warped != 0 {
            (w, corners.map(|corner| self.view.texel_width_at(corner)).into_iter().fold(f64::INFINITY, f64::min))
        } else {
            let w = if self.view.w_per_metre == 0.0 { 1.0 } else { w.max(self.view.drawn_range()[0]) };
            (w, f64::from(self.view.texel_metres[0].max(self.view.texel_metres[1])) * w)
        };
        let [a, b, c] = *corners;
        let sides = [b - a, c - b, a - c].map(DVec3::length);
        let longest = sides.into_iter().fold(0.0, f64::max);
        let own_height = height((b - a).cross(c - a).length(), sides);
        let size = f64::from(self.view.rect[2].max(self.view.rect[3]));
        if longest * longest > MAX_TRIANGLE_LENGTH * size * texel * own_height {
            return true;
        }
        if ws.into_iter().any(|w| w <= 0.0) {
            return false;
        }
        let [a, b, c] = [0, 1, 2].map(|corner| {
            let point = corners[corner].extend(1.0);
            let ndc = DVec2::new(row(self.view.clip_x).dot(point), row(self.view.clip_y).dot(point)) / ws[corner];
            ndc * DVec2::from(self.view.texel_scale.map(f64::from))
        });
        let image_height = height((b - a).perp_dot(c - a).abs(), [b - a, c - b, a - c].map(DVec2::length));
        image_height <= f64::from(self.view.rounding_texels[0]) + f64::from(self.view.rounding_texels[1]) / w
    }

    /// As [`Self::clearance`], wherever on the light's ray through a tap.
    pub(super) fn widest_clearance(&self) -> Clearance {
        let row = DVec4::from_array(self.view.distance.map(f64::from));
        let distance = row.dot(self.receiver.position.extend(1.0));
        // Light from a place spreads up to the far plane.
        let spread = if self.view.w_per_metre == 0.0 { 1.0 } else { (f64::from(self.view.depth_range[1]) / distance).max(1.0) };
        let widest = SQRT_2 * self.outline_error * self.view.texel_width_at(self.receiver.position) * spread;
        Clearance { at_origin: widest, at_end: widest }
    }

    /// How far outlines in the map can be off, in metres across the ray from one of the taps to the light.
    pub(super) fn clearance(&self, point: &SurfacePoint) -> Clearance {
        let at_origin = SQRT_2 * self.outline_error * self.view.texel_width_at(point.position);
        // Toward the light of a perspective view texels shrink to nothing.
        Clearance { at_origin, at_end: if self.view.w_per_metre == 0.0 { at_origin } else { 0.0 } }
    }

    /// Where the light's ray through a lookup meets the receiver's plane; `None` where it does not.
    pub(super) fn behind(&self, lookup: &Lookup) -> Option<SurfacePoint> {
        point_behind(self.view, lookup.texel.as_dvec2().to_array(), self.receiver)
    }

    /// The gap that the bias leaves: how far before the receiver's plane the depth lies that is compared, in metres along the light's ray through the lookup.
    pub(super) fn gap_metres(&self, light: &SceneLight, lookup: &Lookup) -> f64 {
        let compared = f64::from(lookup.depth) - f64::from(lookup.bias);
        // A bias that reaches back to the light lights everything: linear depth has values there that no distance has.
        if self.view.depth_kind == DEPTH_LINEAR && compared < 0.0 {
            return f64::INFINITY;
        }
        let depth = z_over_w(self.view, compared);
        // What lies before a pancaked view's near plane, however far, is drawn onto it.
        if self.view.is_pancaked() && depth <= 0.0 {
            return f64::INFINITY;
        }
        let Some(behind) = self.behind(lookup) else { return 0.0 };
        let row = |row: [f32; 4]| DVec4::from_array(row.map(f64::from)).dot(behind.position.extend(1.0));
        let depth_behind = forward_depth(self.view, row(self.view.clip_z) / row(self.view.clip_w));
        metres_before(light, self.view, behind.position, depth_behind - depth)
    }

    /// How far behind itself a blocker was drawn into the map, in metres along the light's ray through a point of it.
    pub(super) fn pushed_metres(&self, light: &SceneLight, point: DVec3, corners: &[DVec3; 3]) -> f64 {
        if self.view.caster_kind == CASTER_PLAIN {
            return 0.0;
        }
        let [v0, v1, v2] = corners.map(DVec3::as_vec3);
        let row = |row: [f32; 4]| DVec4::from_array(row.map(f64::from)).dot(point.extend(1.0));
        let w = row(self.view.clip_w);
        let drawn = row(self.view.drawn_z) / w;
        let pushed = f64::from(pushed_depth(self.view, drawn as f32, caster_offset(self.view, v0, v1, v2)));
        // Where nothing is farther than it was drawn, it hides nothing.
        if pushed == f64::from(depth_limits(self.view)[1].abs()) {
            return f64::INFINITY;
        }
        let of_drawn = if self.view.is_pancaked() { f64::from(self.view.drawn_scale) } else { 1.0 };
        let deeper = (forward_depth(self.view, pushed) - forward_depth(self.view, drawn)).max(0.0) * of_drawn;
        -metres_before(light, self.view, point, -deeper)
    }

    fn point(&self, texel: IVec2, offset: [f64; 2]) -> Option<SurfacePoint> {
        let place = [f64::from(texel.x) + 0.5 + offset[0], f64::from(texel.y) + 0.5 + offset[1]];
        let point = point_behind(self.view, place, self.receiver)?;
        Some(SurfacePoint { lift: self.lift, ..point })
    }
}

/// z / w of a clip depth divided by w, whichever way the view draws it.
fn forward_depth(view: &ViewPlan, depth: f64) -> f64 {
    if view.depth_kind == DEPTH_Z_OVER_W { depth } else { 1.0 - depth }
}

/// z / w of a depth in the order in which depths are compared.
fn z_over_w(view: &ViewPlan, comparable: f64) -> f64 {
    match view.depth_kind {
        DEPTH_REVERSED => 1.0 + comparable,
        DEPTH_LINEAR => {
            let [near, far] = view.depth_range.map(f64::from);
            let w = (comparable - f64::from(view.linear_offset)) / f64::from(view.linear_scale);
            far / (far - near) - f64::from(view.depth_factor) / w
        }
        _ => comparable,
    }
}

/// Where the light's ray through a point of a map meets the receiver's plane: `None` where it runs along the plane, or meets it behind the light.
fn point_behind(view: &ViewPlan, texel: [f64; 2], receiver: &SurfacePoint) -> Option<SurfacePoint> {
    let row = |row: [f32; 4]| DVec4::from_array(row.map(f64::from));
    let ndc = |axis: usize| (texel[axis] - f64::from(view.texel_offset[axis])) / f64::from(view.texel_scale[axis]);
    let w = row(view.clip_w);
    // The point's x and y are the texel's times its w, and it lies on the plane: three planes that meet in one point.
    let (a, b) = (row(view.clip_x) - w * ndc(0), row(view.clip_y) - w * ndc(1));
    let position =
        meeting_point([(a.truncate(), -a.w), (b.truncate(), -b.w), (receiver.normal, receiver.normal.dot(receiver.position))])?;
    let is_before_the_light = w.dot(position.extend(1.0)) > 0.0;
    is_before_the_light.then_some(SurfacePoint { position, ..*receiver })
}

/// The point of three planes `normal . p = offset`, by Cramer's rule; `None` if two of them are parallel.
fn meeting_point([(a, d), (b, e), (c, f)]: [(DVec3, f64); 3]) -> Option<DVec3> {
    let determinant = a.dot(b.cross(c));
    let point = (b.cross(c) * d + c.cross(a) * e + a.cross(b) * f) / determinant;
    point.is_finite().then_some(point)
}

/// How many metres along the light's ray a depth takes up before a point.
pub(super) fn metres_before(light: &SceneLight, view: &ViewPlan, point: DVec3, depth: f64) -> f64 {
    let along_axis = view.metres_of_depth(point, depth);
    // Parallel rays run along the axis; others are longer than their share of it.
    let axis_distance = DVec4::from_array(view.distance.map(f64::from)).dot(point.extend(1.0));
    let ray = light.light.position().map_or(1.0, |light| light.as_dvec3().distance(point) / axis_distance);
    along_axis * ray
}

#[cfg(test)]
mod tests {
    use shadow_math::{
        Light, LightKind, ShadowSettings,
        bounds::Aabb,
        depth::DepthScale,
        glam::Vec3,
        plan::{MAX_VIEWS_PER_LIGHT, plan_light},
    };

    use shadow_math::fit::Subject;

    use super::*;

    fn views() -> Vec<ViewPlan> {
        let bounds = Aabb::new(Vec3::splat(-4.0), Vec3::splat(4.0));
        let sun = LightKind::Directional { direction: Vec3::new(0.3, -1.0, 0.2) };
        let spot =
            LightKind::Spot { position: Vec3::new(1.0, 9.0, 2.0), direction: Vec3::NEG_Y, inner: 0.0, outer: 0.6, range: None };
        let view = |kind| {
            let light = Light { kind, color: Vec3::ONE, intensity: 1.0 };
            let mut views = [ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
            plan_light(&light, &Subject::unseen(&[bounds], bounds), &ShadowSettings::default(), [0, 0], &mut views)
                .expect("the light is planned");
            views[0]
        };
        vec![view(sun), view(spot)]
    }

    /// A texel's point, projected by the plan's matrix, is the texel's centre, and lies on the plane.
    #[test]
    fn a_point_behind_a_texel_is_seen_in_it() {
        for view in views() {
            let normal = DVec3::new(0.3, 1.0, -0.2).normalize();
            let receiver = SurfacePoint { position: DVec3::new(0.5, -1.0, 0.25), normal, lift: 0.0, triangle: 0 };
            for texel in [[1000.5, 900.5], [3.5, 2040.5]] {
                let point = point_behind(&view, texel, &receiver).expect("the ray meets the plane");
                assert!(normal.dot(point.position - receiver.position).abs() < 1e-12);
                let ndc = view.clip_from_world().as_dmat4().project_point3(point.position);
                for (axis, ndc) in [ndc.x, ndc.y].into_iter().enumerate() {
                    let seen = ndc * f64::from(view.texel_scale[axis]) + f64::from(view.texel_offset[axis]);
                    assert!((seen - texel[axis]).abs() < 1e-9, "{seen} instead of {}", texel[axis]);
                }
            }
        }
    }

    #[test]
    fn the_length_of_a_bias_is_that_of_its_depth() {
        for view in views() {
            let (point, metres) = (DVec3::new(0.5, -1.0, 0.25), 0.125);
            let w = DVec4::from_array(view.clip_w.map(f64::from)).dot(point.extend(1.0));
            let scale = DepthScale { factor: f64::from(view.depth_factor), w_per_metre: f64::from(view.w_per_metre) };
            let bias = scale.depth_of_metres(w, metres);
            assert!((view.metres_of_depth(point, bias) - metres).abs() < 1e-12);
        }
    }
}
