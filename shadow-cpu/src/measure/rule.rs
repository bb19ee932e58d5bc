//! Biases of others, as rules by which a receiver asks a map: to be measured beside ours on the same map and filter.
//!
//! A [`Rule`] moves the receiver along its normal and toward the light, and compares with a depth that is taken back by some more. Each engine's default is one
//! such rule, in its own units; what an engine does beside it (its filter, fit and cascades) is not part of the rule. The numbers are those of the engines' sources and
//! documents, named at each.

use glam::{Vec2, Vec3};
use shadow_math::{
    Receiver,
    bias::{depth_gradient, needed_depth, normal_offset, texel_width},
    filter::turn::turn_of_pixel,
    plan::{FILTER_DISC, LIGHT_DIRECTIONAL, LIGHT_SPOT, LightPlan, ViewPlan, toward_light},
    vector::row_times_point,
    vector::unit_normal,
    visibility::{Lookup, NO_VIEW, choose_views, footprint},
};

/// How far a rule moves a receiver along its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlongNormal {
    /// Not at all.
    Nothing,
    /// By so many texels, whatever the angle.
    Texels(f32),
    /// By so many texels times the sine of the angle between normal and light.
    TexelsTimesSine(f32),
    /// By so many texels times one minus the cosine of that angle.
    TexelsTimesOneMinusCosine(f32),
    /// By so many texels times one minus the cosine of that angle, and back along the light until it is a step across it.
    AcrossLight(f32),
}

/// How a receiver is kept from its own shadow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// The automatic bias, with its need of depth scaled: 1 is the automatic bias itself, less is less than planes need.
    Automatic {
        /// The factor on h(g), snap and rounding alike.
        scale: f32,
    },
    /// The same length everywhere, toward the light.
    Metres(f32),
    /// What engines do.
    Engine {
        /// A step along the normal; a texel is as wide as where the receiver is.
        along_normal: AlongNormal,
        /// A step toward the light, in metres.
        toward_light: f32,
        /// A depth that is taken off: a share of the view's range.
        depth: f32,
        /// A share of the stored depth that is added to it.
        of_stored: f32,
        /// A factor on `max(|dz/dx|, |dz/dy|)`, in texels: fixed-function polygon offset.
        slope: f32,
        /// A factor on `|dz/dx| + |dz/dy|`, in texels, the sum limited to a depth: the static term of a receiver plane's bias.
        sum: f32,
        /// The limit of that sum.
        sum_limit: f32,
    },
}

/// No part of an engine's rule.
const NOTHING: Rule = Rule::Engine {
    along_normal: AlongNormal::Nothing,
    toward_light: 0.0,
    depth: 0.0,
    of_stored: 0.0,
    slope: 0.0,
    sum: 0.0,
    sum_limit: f32::INFINITY,
};

/// One step of a 16-bit map, for polygon offsets whose constant is counted in units.
const UNIT_16: f32 = 1.0 / 65_536.0;

/// What an engine does by default, and where that stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EngineRule {
    /// The engine.
    pub name: &'static str,
    /// The rule for directional lights.
    pub directional: Rule,
    /// The rule for spot lights.
    pub spot: Rule,
    /// The rule for point lights.
    pub point: Rule,
    /// Whether the engine by default draws the back faces of single-sided casters, so that the fronts have their bias from the casters' own thickness. That is a matter of
    /// the map: [`Trials::try_engine`](super::Trials::try_engine) takes one of those.
    pub casts_back_faces: bool,
    /// What is expressed, in the engine's own terms, and what is not.
    pub what: &'static str,
}

/// The defaults of engines.
pub const ENGINES: [EngineRule; 7] = {
    const fn engine(along_normal: AlongNormal, toward_light: f32, depth: f32, slope: f32) -> Rule {
        let (of_stored, sum, sum_limit) = (0.0, 0.0, f32::INFINITY);
        Rule::Engine { along_normal, toward_light, depth, of_stored, slope, sum, sum_limit }
    }
    const fn same(name: &'static str, rule: Rule, casts_back_faces: bool, what: &'static str) -> EngineRule {
        EngineRule { name, directional: rule, spot: rule, point: rule, casts_back_faces, what }
    }
    /// A square's diagonal over its side, as Bevy scales texels.
    const SQRT_2: f32 = core::f32::consts::SQRT_2;
    [
        same(
            "OGRE 1.12",
            Rule::Engine {
                along_normal: AlongNormal::Nothing,
                toward_light: 0.0,
                depth: 0.0,
                of_stored: 0.0005,
                slope: 0.0,
                sum: 0.0,
                sum_limit: f32::INFINITY,
            },
            true,
            "its shadow sample's receiver: a fixed bias of 0.0005 of the stored depth, with a gradient whose scale is 0 by default",
        ),
        same(
            "OGRE 13",
            engine(AlongNormal::Nothing, 0.0, 0.5 * UNIT_16, 1.0),
            true,
            "its shadow sample's depth_bias, constant 0.5 and slope 1 on a map of 16 bits, taken as away from the light",
        ),
        EngineRule {
            name: "Bevy",
            directional: engine(AlongNormal::Texels(1.8 * SQRT_2), 0.02, 0.0, 0.0),
            spot: engine(AlongNormal::Texels(1.8 * SQRT_2), 0.02, 0.0, 0.0),
            point: engine(AlongNormal::Texels(0.6 * SQRT_2), 0.08, 0.0, 0.0),
            casts_back_faces: false,
            what: "shadow_depth_bias 0.02 m (point 0.08), shadow_normal_bias 1.8 texels (point 0.6) times sqrt 2, at any angle",
        },
        EngineRule {
            name: "Filament",
            directional: engine(AlongNormal::TexelsTimesSine(0.5), 0.001, 0.5 * UNIT_16, 2.0),
            spot: engine(AlongNormal::TexelsTimesSine(1.0), 0.001, 0.5 * UNIT_16, 2.0),
            point: engine(AlongNormal::TexelsTimesSine(1.0), 0.001, 0.5 * UNIT_16, 2.0),
            casts_back_faces: false,
            what: "constantBias 0.001 m, normalBias 1 (half a texel times the sine; a whole one for spot and point lights), polygon offset 0.5 and 2 on a map of 16 bits",
        },
        same(
            "MJP",
            Rule::Engine {
                along_normal: AlongNormal::Nothing,
                toward_light: 0.0,
                depth: 0.0,
                of_stored: 0.0,
                slope: 0.0,
                sum: 1.0,
                sum_limit: 0.01,
            },
            false,
            "receiver plane: its static term of a texel, at most 0.01 of the range; the plane's own correction at each tap is part of it here",
        ),
        same("three.js", NOTHING, true, "bias 0 and normalBias 0"),
        EngineRule {
            name: "Godot 4",
            directional: engine(AlongNormal::AcrossLight(2.0), 0.001, 0.0, 0.0),
            spot: engine(AlongNormal::TexelsTimesOneMinusCosine(5.0), 0.03, 0.0, 0.0),
            point: engine(AlongNormal::AcrossLight(5.0), 0.1, 0.0, 0.0),
            casts_back_faces: false,
            what: "shadow_bias 0.1 (for directional lights its shaders take a hundredth, in metres toward the light; for omni lights metres; a spot light's 0.03 is added to clip z in hundredths, which is 0.03 m \
                   half-way through its default range), shadow_normal_bias 2 texels times one minus the cosine, across the light (spot and omni 1, which is ten over the map's size of the distance: five texels of a \
                   right angle; along the normal for spot lights, across the light for omni lights); its scaling by split and filter quality is not expressed",
        },
    ]
};

impl Rule {
    /// What a receiver asks of the maps of a light by this rule; as [`lookup`](shadow_math::visibility::lookup) otherwise.
    #[must_use]
    pub fn ask(&self, light: &LightPlan, views: &[ViewPlan], receiver: &Receiver) -> Lookup {
        let known = |known| Lookup { view: NO_VIEW, known, ..Lookup::default() };
        let toward = toward_light(light, receiver.point);
        let choice = choose_views(light, views, receiver);
        let index = choice.first;
        let Some(view) = views.get(index as usize) else { return known(choice.known) };
        let w = row_times_point(view.clip_w, receiver.point);
        if w <= 0.0 || row_times_point(view.half_space, receiver.point) < 0.0 {
            return known(1.0);
        }
        let normal = unit_normal(receiver.normal);
        let sides = footprint(light, view, receiver, w);
        let (step, bias) = self.step_and_bias(light, view, receiver, normal, toward, w);
        let point = receiver.point + step;
        let w = row_times_point(view.clip_w, point);
        let ndc = Vec3::new(
            row_times_point(view.clip_x, point),
            row_times_point(view.clip_y, point),
            row_times_point(view.clip_z, point),
        ) / w;
        let texel =
            Vec2::new(ndc.x * view.texel_scale[0] + view.texel_offset[0], ndc.y * view.texel_scale[1] + view.texel_offset[1]);
        let [left, top, width, height] = view.rect.map(|side| side as f32);
        let is_inside = texel.x >= left && texel.y >= top && texel.x < left + width && texel.y < top + height;
        if !is_inside || ndc.z < 0.0 || !(w > 0.0) {
            return known(1.0);
        }
        // `z <= stored (1 + s)` is `z / (1 + s) <= stored`.
        let of_stored = if let Self::Engine { of_stored, .. } = self { *of_stored } else { 0.0 };
        let depth = ndc.z.min(1.0) / (1.0 + of_stored);
        let turn = if light.filter == FILTER_DISC { turn_of_pixel(receiver.pixel) } else { Vec2::X };
        Lookup { view: index, texel, depth, bias, turn, footprint: sides, ..Lookup::default() }
    }

    /// How far the receiver is moved, in metres, and what is added to the stored depth.
    fn step_and_bias(
        &self,
        light: &LightPlan,
        view: &ViewPlan,
        receiver: &Receiver,
        normal: Vec3,
        toward: Vec3,
        w: f32,
    ) -> (Vec3, f32) {
        let point = receiver.point;
        let direction = toward.normalize_or_zero();
        match *self {
            Self::Automatic { scale } => {
                let needed = scale * needed_depth(light, view, point, receiver.normal, w, footprint(light, view, receiver, w));
                let offset = normal_offset(light, view, point, normal, needed, w);
                (normal * offset, if offset > 0.0 { 0.0 } else { needed.min(1.0) })
            }
            Self::Metres(metres) => (direction * metres, 0.0),
            Self::Engine { along_normal, toward_light, depth, slope, sum, sum_limit, .. } => {
                let texel = texel_width(light, view, point, w);
                let cosine = normal.dot(direction).clamp(0.0, 1.0);
                let step = texel
                    * match along_normal {
                        AlongNormal::Nothing => Vec3::ZERO,
                        AlongNormal::Texels(texels) => normal * texels,
                        AlongNormal::TexelsTimesSine(texels) => normal * (texels * (1.0 - cosine * cosine).sqrt()),
                        AlongNormal::TexelsTimesOneMinusCosine(texels) => normal * (texels * (1.0 - cosine)),
                        AlongNormal::AcrossLight(texels) => (normal - direction * cosine) * (texels * (1.0 - cosine)),
                    };
                let gradient = depth_gradient(view, point, normal).abs();
                let of_slope = if slope > 0.0 { slope * gradient.max_element() } else { 0.0 };
                let of_sum = if sum > 0.0 { (sum * gradient.element_sum()).min(sum_limit) } else { 0.0 };
                (step + direction * toward_light, (depth + of_slope + of_sum).min(1.0))
            }
        }
    }
}

impl EngineRule {
    /// The rule for a light of this kind.
    #[must_use]
    pub fn of(&self, light: &LightPlan) -> Rule {
        match light.kind {
            LIGHT_DIRECTIONAL => self.directional,
            LIGHT_SPOT => self.spot,
            _ => self.point,
        }
    }
}

#[cfg(test)]
mod tests {
    use shadow_math::{
        Light, LightKind, ShadowSettings,
        bounds::Aabb,
        plan::{LIGHT_POINT, MAX_VIEWS_PER_LIGHT, plan_light},
        visibility::lookup,
    };

    use shadow_math::fit::Subject;

    use super::*;

    /// A light that shines straight down, its view, and a receiver whose plane falls 3 to 4 along x and 1 to 4 along z.
    fn noon() -> (LightPlan, Vec<ViewPlan>, Receiver) {
        let bounds = Aabb::new(Vec3::splat(-4.0), Vec3::splat(4.0));
        let light = Light { kind: LightKind::Directional { direction: Vec3::NEG_Y }, color: Vec3::ONE, intensity: 1.0 };
        let mut views = [ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
        let settings = ShadowSettings { map_size: 512, ..ShadowSettings::default() };
        let plan =
            plan_light(&light, &Subject::unseen(&[bounds], bounds), &settings, [0, 0], &mut views).expect("the light is planned");
        let receiver = Receiver::new(Vec3::new(0.5, 1.0, -0.25), Vec3::new(3.0, 4.0, 1.0));
        (plan, views[..1].to_vec(), receiver)
    }

    const NOTHING_ELSE: (f32, f32, f32, f32, f32, f32) = (0.0, 0.0, 0.0, 0.0, 0.0, f32::INFINITY);

    fn engine(along_normal: AlongNormal, other: (f32, f32, f32, f32, f32, f32)) -> Rule {
        let (toward_light, depth, of_stored, slope, sum, sum_limit) = other;
        Rule::Engine { along_normal, toward_light, depth, of_stored, slope, sum, sum_limit }
    }

    /// What a rule asks beyond what asks without any bias: how many texels beside, how many metres nearer to the light, and the bias.
    fn beyond_nothing(rule: Rule) -> (f32, f32, f32) {
        let (light, views, receiver) = noon();
        let asked = rule.ask(&light, &views, &receiver);
        let nothing = NOTHING.ask(&light, &views, &receiver);
        let metres = (nothing.depth - asked.depth) / views[0].depth_factor;
        ((asked.texel - nothing.texel).length(), metres, asked.bias)
    }

    /// Depths and texels near 1 and 256, in f32, of which differences are taken.
    fn is_near(a: f32, b: f32) -> bool {
        (a - b).abs() < 1e-4 * b.abs() + 4e-5
    }

    #[test]
    fn steps_are_those_of_geometry() {
        let (_, views, receiver) = noon();
        let texel = views[0].texel_metres[0].max(views[0].texel_metres[1]);
        let normal = receiver.normal.normalize();
        let (cosine, sine) = (normal.y, (1.0 - normal.y * normal.y).sqrt());
        for (rule, texels, metres) in [
            (Rule::Metres(0.25), 0.0, 0.25),
            (engine(AlongNormal::Nothing, (0.25, 0.0, 0.0, 0.0, 0.0, f32::INFINITY)), 0.0, 0.25),
            (engine(AlongNormal::Texels(8.0), NOTHING_ELSE), 8.0 * sine, 8.0 * texel * cosine),
            (engine(AlongNormal::TexelsTimesSine(8.0), NOTHING_ELSE), 8.0 * sine * sine, 8.0 * texel * sine * cosine),
            (
                engine(AlongNormal::TexelsTimesOneMinusCosine(8.0), NOTHING_ELSE),
                8.0 * (1.0 - cosine) * sine,
                8.0 * texel * (1.0 - cosine) * cosine,
            ),
            (engine(AlongNormal::AcrossLight(8.0), NOTHING_ELSE), 8.0 * (1.0 - cosine) * sine, 0.0),
        ] {
            let (found_texels, found_metres, bias) = beyond_nothing(rule);
            let is_right = is_near(found_texels, texels) && is_near(found_metres, metres) && bias == 0.0;
            assert!(is_right, "{rule:?}: {found_texels} {texels}, {found_metres} {metres}, {bias}");
        }
    }

    #[test]
    fn depths_are_those_of_the_plane() {
        let (light, views, receiver) = noon();
        // A texel along x the plane falls by 3/4 of it, and along z by 1/4.
        let depth_of_texel = |axis: usize| views[0].texel_metres[axis] * views[0].depth_factor;
        let gradients = [0.75 * depth_of_texel(0), 0.25 * depth_of_texel(1)];
        let (steepest, sum) = (gradients[0].max(gradients[1]), gradients[0] + gradients[1]);
        for (other, bias) in [
            ((0.0, 0.001, 0.0, 0.0, 0.0, f32::INFINITY), 0.001),
            ((0.0, 0.0, 0.0, 2.0, 0.0, f32::INFINITY), 2.0 * steepest),
            ((0.0, 0.0, 0.0, 0.0, 1.5, f32::INFINITY), 1.5 * sum),
            ((0.0, 0.0, 0.0, 0.0, 1.5, 0.5 * sum), 0.5 * sum),
            ((0.0, 0.0, 0.0, 0.0, 0.0, f32::INFINITY), 0.0),
        ] {
            let (texels, metres, found) = beyond_nothing(engine(AlongNormal::Nothing, other));
            assert!((texels, metres) == (0.0, 0.0) && (found - bias).abs() <= 1e-5 * bias, "{other:?}: {found} {bias}");
        }
        let stored = engine(AlongNormal::Nothing, (0.0, 0.0, 0.25, 0.0, 0.0, f32::INFINITY)).ask(&light, &views, &receiver);
        let nothing = NOTHING.ask(&light, &views, &receiver);
        assert!(is_near(stored.depth * 1.25, nothing.depth));
    }

    #[test]
    fn all_of_the_automatic_rule_is_the_automatic_bias() {
        let (light, views, receiver) = noon();
        let grazing = Receiver { normal: Vec3::new(1.0, 0.02, 0.3), ..receiver };
        for receiver in [receiver, grazing] {
            assert_eq!(Rule::Automatic { scale: 1.0 }.ask(&light, &views, &receiver), lookup(&light, &views, &receiver));
        }
        let below = Receiver { normal: Vec3::NEG_Y, ..receiver };
        for rule in [Rule::Automatic { scale: 0.5 }, Rule::Metres(1.0), NOTHING] {
            let asked = rule.ask(&light, &views, &below);
            assert_eq!((asked.view, asked.known), (NO_VIEW, 0.0), "{rule:?} of a surface that faces away");
        }
    }

    #[test]
    fn engines_have_rules_of_their_own_for_each_kind() {
        let (light, ..) = noon();
        let [spot, point] = [LIGHT_SPOT, LIGHT_POINT].map(|kind| LightPlan { kind, ..light });
        for engine in ENGINES {
            assert_eq!([&light, &spot, &point].map(|light| engine.of(light)), [engine.directional, engine.spot, engine.point]);
        }
        assert!(ENGINES.iter().any(|engine| engine.directional != engine.spot && engine.directional != engine.point));
    }
}
