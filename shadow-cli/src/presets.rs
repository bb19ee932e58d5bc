//! Presets: the defaults of engines, by the kind of light, as far as settings can say them.
//!
//! Every number names its source: the engine's source file, setting or manual. What an engine does beside it and settings cannot say is listed with the preset, as sentences for people; what
//! a number of the engine means in metres is the matter of [`convert`](crate::convert).

use clap::ValueEnum;
use shadow_math::{
    Bias, Filter, LightKind, ShadowSettings, Store,
    settings::{BiasParts, Ogre2006, PolygonOffset, ReceiverGradient},
};

/// An engine, or a sample, whose defaults are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Engine {
    /// The shaders of "Shadow Mapping in Ogre" (Chong 2006)
    #[value(name = "ogre-2006")]
    Ogre2006,
    /// OGRE 1.12 with the shaders of its shadow sample
    #[value(name = "ogre-1.12")]
    Ogre112,
    /// OGRE 13.3.1 and later, with the materials of its shadow sample
    #[value(name = "ogre-13")]
    Ogre13,
    /// TheRealMJP's sample "Shadows"
    Mjp,
    /// Filament
    Filament,
    /// Bevy
    Bevy,
    /// three.js
    Three,
    /// Babylon.js
    Babylon,
    /// Godot 4, Forward+
    Godot,
}

/// A kind of light, as far as engines tell them apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Kind {
    /// Parallel rays
    Directional,
    /// A cone
    Spot,
    /// All around
    Point,
}

impl Kind {
    /// Every kind.
    pub(crate) const ALL: [Self; 3] = [Self::Directional, Self::Spot, Self::Point];

    /// The kind of a light.
    pub(crate) fn of(light: &LightKind) -> Self {
        match light {
            LightKind::Directional { .. } => Self::Directional,
            LightKind::Spot { .. } => Self::Spot,
            LightKind::Point { .. } => Self::Point,
        }
    }

    /// The name on the command line and in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Directional => "directional",
            Self::Spot => "spot",
            Self::Point => "point",
        }
    }

    /// The number of this kind from a list by [`Self::ALL`].
    pub(crate) fn pick<T: Copy>(self, list: [T; 3]) -> T {
        match self {
            Self::Directional => list[0],
            Self::Spot => list[1],
            Self::Point => list[2],
        }
    }
}

/// Bevy's `shadow_depth_bias`, in metres toward the light: `DEFAULT_SHADOW_DEPTH_BIAS` of `DirectionalLight`, `SpotLight` and `PointLight` (bevy_light).
const BEVY_DEPTH: [f64; 3] = [0.02, 0.02, 0.08];
/// Bevy's `shadow_normal_bias`, in texels along their diagonal: `DEFAULT_SHADOW_NORMAL_BIAS` of the same.
const BEVY_NORMAL: [f64; 3] = [1.8, 1.8, 0.6];
/// Filament's `LightManager::ShadowOptions`: `constantBias` in metres, `normalBias` without a unit, `polygonOffsetConstant` in steps of the format, `polygonOffsetSlope`.
const FILAMENT: [f64; 4] = [0.001, 1.0, 0.5, 2.0];
/// The texels that a `normalBias` of 1 is in Filament: `ShadowMapManager.cpp` takes half a texel for directional lights, and a whole one for the others.
pub(crate) const FILAMENT_NORMAL_TEXELS: [f64; 3] = [0.5, 1.0, 1.0];
/// Godot's `shadow_bias`: class reference of `Light3D`, with the override of `SpotLight3D`.
const GODOT_BIAS: [f64; 3] = [0.1, 0.03, 0.1];
/// Godot's `shadow_normal_bias`: class reference of `Light3D`, with the overrides of `SpotLight3D` and `OmniLight3D`.
const GODOT_NORMAL: [f64; 3] = [2.0, 1.0, 1.0];
/// MJP's `Bias`, a share of the depth range, and `OffsetScale`: `AppSettings.cs`. The bias is used without the receiver plane alone, which is on by default.
const MJP: [f64; 2] = [0.005, 0.0];
/// three.js's `LightShadow.bias` and `normalBias`.
const THREE: [f64; 2] = [0.0, 0.0];
/// Babylon's `ShadowGenerator.bias`, a share of the depth range, and `normalBias`, in metres.
const BABYLON: [f64; 2] = [0.000_05, 0.0];
/// OGRE 1.12's `fixedDepthBias`, a share of the stored depth: the shadow sample's default parameter.
const OGRE_112_FIXED: f64 = 0.0005;
/// OGRE 13's `depth_bias`, a constant in steps of the format and a slope: the shadow sample's caster material.
const OGRE_13: [f64; 2] = [0.5, 1.0];
/// The push of the caster shader of 2006, in units, which are taken for metres.
const OGRE_2006_UNITS: f64 = 1.0;

/// How far a receiver plane of MJP's corrects a tap, in metres: it has no limit there, and no scene is a thousand kilometres deep.
const MJP_PLANE_METRES: f32 = 1e6;

/// The reach of Bevy's eight taps around a direction, on each axis, in texels of its map of 1024: seven eighths (the farthest of Direct3D's pattern for 8 samples) of `POINT_SHADOW_SCALE`, 0.003,
/// over a face of two units (`shadow_sampling.wgsl`).
const BEVY_POINT_REACH: f32 = 0.875 * 0.003 * 1024.0 / 2.0;

/// The radius of Godot's disc in texels: `directional_shadow_quality_radius` and `shadows_quality_radius` of the quality "Soft Low", which is the default of both `soft_shadow_filter_quality`.
const GODOT_RADIUS: f32 = 2.0;
/// What Godot's `shadow_bias` of a spot light comes to in metres: it is added to clip z, in hundredths, so that its length grows with the distance. Half-way through the default range of 5 m,
/// whose near plane is a 200th of it, the default is three centimetres.
const GODOT_SPOT_METRES: f32 = 0.03;
/// What Godot's step of a spot light is in texels: ten over the map's size times the distance (`light_storage.cpp`), where a texel of the default cone of 45 degrees is two over it.
const GODOT_SPOT_TEXELS: f32 = 5.0;

impl Engine {
    /// Every engine.
    pub(crate) const ALL: [Self; 9] = [
        Self::Ogre2006,
        Self::Ogre112,
        Self::Ogre13,
        Self::Mjp,
        Self::Filament,
        Self::Bevy,
        Self::Three,
        Self::Babylon,
        Self::Godot,
    ];

    /// The name on the command line and in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Ogre2006 => "ogre-2006",
            Self::Ogre112 => "ogre-1.12",
            Self::Ogre13 => "ogre-13",
            Self::Mjp => "mjp",
            Self::Filament => "filament",
            Self::Bevy => "bevy",
            Self::Three => "three",
            Self::Babylon => "babylon",
            Self::Godot => "godot",
        }
    }

    /// The defaults of its own bias parameters for a kind of light, in the order in which [`convert`](crate::convert) has them.
    pub(crate) fn defaults(self, kind: Kind) -> Vec<f64> {
        match self {
            Self::Ogre2006 => vec![OGRE_2006_UNITS],
            Self::Ogre112 => vec![OGRE_112_FIXED],
            Self::Ogre13 => OGRE_13.to_vec(),
            Self::Mjp => MJP.to_vec(),
            Self::Filament => FILAMENT.to_vec(),
            Self::Bevy => vec![kind.pick(BEVY_DEPTH), kind.pick(BEVY_NORMAL)],
            Self::Three => THREE.to_vec(),
            Self::Babylon => BABYLON.to_vec(),
            Self::Godot => vec![kind.pick(GODOT_BIAS), kind.pick(GODOT_NORMAL)],
        }
    }

    /// The engine's defaults for a kind of light.
    pub(crate) fn settings(self, kind: Kind) -> ShadowSettings {
        let (map_size, store, filter, filter_radius, parts) = match self {
            // Map: `SceneManager::setShadowTextureSettings`, 512. Format: the manual's setup, PF_FLOAT32_R. Filter: the manual's "bilinear analogue", five taps. Bias: the article's caster shader.
            Self::Ogre2006 => {
                let shader = Ogre2006 { metres: OGRE_2006_UNITS as f32, is_corrected: false };
                let parts = BiasParts { ogre_2006: Some(shader), ..BiasParts::NONE };
                (512, Store::Depth32, Filter::Cross5, None, parts)
            }
            // Map and format: as above. Filter and bias: the sample's receiver (fixedDepthBias 0.0005, gradientClamp 0.0098, gradientScaleBias 0). `setShadowCasterRenderBackFaces` is on.
            Self::Ogre112 => {
                let gradient = ReceiverGradient { fixed: OGRE_112_FIXED as f32, ..ReceiverGradient::default() };
                let parts = BiasParts { receiver_gradient: Some(gradient), back_faces: true, ..BiasParts::NONE };
                (512, Store::Depth32, Filter::Cross5, None, parts)
            }
            // Map: `ShadowTextureConfig`, 512. Format: the sample's PF_DEPTH16 since 13.3.1. Bias: its caster material's `depth_bias 0.5 1`. `setShadowCasterRenderBackFaces` is on.
            Self::Ogre13 => {
                let [units, slope] = OGRE_13.map(|number| number as f32);
                let parts = BiasParts {
                    polygon_offset: Some(PolygonOffset { slope, units, clamp: 0.0 }),
                    back_faces: true,
                    ..BiasParts::NONE
                };
                (512, Store::Depth16, Filter::Cross5, None, parts)
            }
            // `AppSettings.cs`: SMSize2048, FixedSizePCF with Filter2x2 (a hardware comparison), UsePlaneDepthBias, OffsetScale 0. Format: DXGI_FORMAT_D32_FLOAT.
            Self::Mjp => {
                let parts = BiasParts { receiver_plane: Some(MJP_PLANE_METRES), ..BiasParts::NONE };
                (2048, Store::Depth32, Filter::Bilinear, None, parts)
            }
            // `ShadowOptions::mapSize`, 1024. Format: DEPTH16 (`ShadowMapManager.cpp`). Filter: `ShadowType::PCF` at its quality LOW, the witness kernel of 3 (`surface_shadowing.fs`).
            Self::Filament => {
                let [constant, normal, units, slope] = FILAMENT.map(|number| number as f32);
                let parts = BiasParts {
                    constant: Some(constant),
                    normal_offset: Some(kind.pick(FILAMENT_NORMAL_TEXELS) as f32 * normal),
                    polygon_offset: Some(PolygonOffset { slope, units, clamp: 0.0 }),
                    ..BiasParts::NONE
                };
                (1024, Store::Depth16, Filter::Witness3, None, parts)
            }
            // `DirectionalLightShadowMap`, 2048 (whose array has the spot lights too), and `PointLightShadowMap`, 1024. Format: Depth32Float, reversed. Filter: `ShadowFilteringMethod::Gaussian`,
            // which is the witness kernel of 5, and around points eight taps with Gaussian weights.
            Self::Bevy => {
                let parts = BiasParts {
                    constant: Some(kind.pick(BEVY_DEPTH) as f32),
                    // The square's diagonal: `shadow_normal_bias * SQRT_2` (bevy_pbr, `render/light.rs`).
                    normal_offset: Some((kind.pick(BEVY_NORMAL) * std::f64::consts::SQRT_2) as f32),
                    ..BiasParts::NONE
                };
                match kind {
                    Kind::Directional | Kind::Spot => (2048, Store::Reversed32, Filter::Witness5, None, parts),
                    Kind::Point => (1024, Store::Reversed32, Filter::Gaussian, Some(BEVY_POINT_REACH), parts),
                }
            }
            // `LightShadow.mapSize`, 512. Format: depth in the four bytes of a colour, z / w, and around points the distance (`MeshDistanceMaterial`). Filter: `PCFShadowMap`, the default of
            // `WebGLRenderer.shadowMap.type`. Bias: `LightShadow`, 0. Faces: `WebGLShadowMap` draws the back sides of materials that have a front alone.
            Self::Three => {
                let store = if kind == Kind::Point { Store::Linear } else { Store::Depth32 };
                (512, store, Filter::Witness3, None, BiasParts { back_faces: true, ..BiasParts::NONE })
            }
            // The map's size is the constructor's argument; the manual's examples take 1024. Filter: FILTER_NONE. Format: the depth metric as a float, which is linear in the distance.
            Self::Babylon => {
                let share = BABYLON[0] as f32;
                if kind == Kind::Directional {
                    // z / w is linear for parallel rays, and a share of it so many steps of 24 bits.
                    let units = share * Store::Depth24.steps();
                    let parts =
                        BiasParts { polygon_offset: Some(PolygonOffset { slope: 0.0, units, clamp: 0.0 }), ..BiasParts::NONE };
                    (1024, Store::Depth24, Filter::Hard, None, parts)
                } else {
                    let gradient = ReceiverGradient { fixed: share, ..ReceiverGradient::default() };
                    let parts = BiasParts { receiver_gradient: Some(gradient), ..BiasParts::NONE };
                    (1024, Store::Linear, Filter::Hard, None, parts)
                }
            }
            // Project settings: `directional_shadow/size` 4096; `positional_shadow/atlas_size` 4096, of whose first quadrant a light has a quarter, and a cube's face half of that
            // (`atlas_quadrant_0_subdiv`); both `16_bits`. Filter: "Soft Low", a Vogel disc. Bias: see the constants above; a directional light's is in hundredths of metres.
            Self::Godot => {
                let (map_size, constant, normal) = match kind {
                    Kind::Directional => (4096, 0.01 * GODOT_BIAS[0] as f32, GODOT_NORMAL[0] as f32),
                    Kind::Spot => (1024, GODOT_SPOT_METRES, GODOT_NORMAL[1] as f32 * GODOT_SPOT_TEXELS),
                    Kind::Point => (512, GODOT_BIAS[2] as f32, GODOT_NORMAL[2] as f32),
                };
                let parts = BiasParts { constant: Some(constant), normal_offset: Some(normal), ..BiasParts::NONE };
                (map_size, Store::Depth16, Filter::Vogel, Some(GODOT_RADIUS), parts)
            }
        };
        ShadowSettings { map_size, store, filter, filter_radius, bias: Bias::Parts(parts), ..ShadowSettings::default() }
    }

    /// What of its defaults for a kind of light settings do not say, or say otherwise: sentences without a capital and a full stop.
    pub(crate) fn differences(self, kind: Kind) -> Vec<&'static str> {
        /// OGRE's camera of a point light.
        const ONE_CONE: &str = "OGRE aims one map of 120 degrees at what the camera sees, where there is a cube here";
        type Sentences = &'static [&'static str];
        let by_kind = |directional: Sentences, spot: Sentences, point: Sentences| kind.pick([directional, spot, point]);
        let sentences: &[Sentences] = match self {
            Self::Ogre2006 => &[
                &[
                    "a unit is taken for a metre",
                    "by itself the fit is uniform over the scene here, where OGRE's follows the camera (--fit ogre-uniform)",
                ],
                if kind == Kind::Point { &[ONE_CONE] } else { &[] },
            ],
            Self::Ogre112 => &[
                &[
                    "by itself the fit is uniform over the scene here, where OGRE's follows the camera (--fit ogre-uniform, whose own depth range is almost nothing without a far distance)",
                ],
                if kind == Kind::Point { &[ONE_CONE] } else { &[] },
            ],
            Self::Ogre13 => &[
                &[
                    "depth_bias is taken as away from the light",
                    "the filter is the shadow sample's, where the shader generator takes four taps at 0.3 texels",
                    "by itself the fit is uniform over the scene here, where OGRE's follows the camera (--fit ogre-uniform)",
                ],
                if kind == Kind::Point { &[ONE_CONE] } else { &[] },
            ],
            Self::Mjp => &[
                &[
                    "the static term of its receiver plane, a texel and at most 0.01 of the range, is here what snapping and rounding need",
                    "by itself there is one map here, where the sample has four cascades (--split cascades)",
                ],
                if kind == Kind::Directional {
                    &[]
                } else {
                    &["the sample has directional lights alone, and its settings for these are taken"]
                },
            ],
            Self::Filament => &[
                &["depth is not reversed in the map, whose 16 bits have the same steps either way"],
                if kind == Kind::Directional {
                    &[
                        "by itself the fit is uniform over the scene here, where Filament clips it to what the camera sees (--fit focused)",
                        "nothing is warped by LiSPSM, which Filament does by default",
                    ]
                } else {
                    &[]
                },
            ],
            Self::Bevy => &[
                &[
                    "the step along the normal is times the sine of its angle with the light, where Bevy's is the same at any angle",
                ],
                by_kind(
                    &[
                        "by itself there is one map over the scene here, where Bevy has four cascades up to 150 m (--split cascades --shadow-distance 150)",
                    ],
                    &["the depth bias is along the light's axis, where Bevy's is toward the light"],
                    &[
                        "the depth bias is along each face's axis, where Bevy's is toward the light",
                        "its eight taps with Gaussian weights are a Gaussian of the same reach in a map of 1024 texels",
                    ],
                ),
            ],
            Self::Three => &[
                by_kind(
                    &["the fit is uniform over the scene, where three.js has a box of 10 by 10 units around the target"],
                    &[],
                    &["what is stored is the distance along each face's axis, where three.js stores that from the light"],
                ),
                &[
                    "PCFShadowMap's seventeen tests up to a texel away (until r181, and five tests on a Vogel disc since) are the witness kernel of 3, which is wider by an eighth",
                ],
            ],
            Self::Babylon => &[
                by_kind(
                    &[
                        "the bias is a share of the light's own range of depth, where Babylon's range without shadowMinZ and shadowMaxZ is the camera's",
                    ],
                    &["the bias is a share of the stored distance, so that it is Babylon's at the far plane and less before it"],
                    &[
                        "the bias is a share of the stored distance, so that it is Babylon's at the far plane and less before it",
                        "what is stored is the distance along each face's axis, where Babylon stores that from the light",
                    ],
                ),
                &["the map's size is the manual's example, since Babylon has no default"],
            ],
            Self::Godot => &[
                by_kind(
                    &[
                        "the step along the normal is times the sine of its angle with the light, where Godot's is across the light and times one minus the cosine",
                        "by itself there is one map over the scene here, where Godot has four splits up to 100 m, each a quarter of the 4096 texels' area (--split cascades --shadow-distance 100), with biases by split",
                    ],
                    &[
                        "the bias is 0.03 m, what Godot's addition to clip z is half-way through the default range of 5 m: nearer it is less there, farther more",
                        "the step along the normal is times the sine of its angle with the light, where Godot's is times one minus the cosine, and in texels of a cone of 45 degrees",
                    ],
                    &[
                        "the step along the normal is in texels and times the sine, where Godot's is a length and times one minus the cosine: the two lengths meet half-way through the default range of 5 m",
                        "the cube's faces are drawn as they are, where Godot copies them into two paraboloids",
                        "the bias is along each face's axis, where Godot's is toward the light",
                    ],
                ),
                &[
                    "the disc has sixteen hard tests, where Godot's has four bilinear ones",
                    "what Godot multiplies biases with by split and by filter quality is left out",
                ],
            ],
        };
        sentences.concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_command_line() {
        for engine in Engine::ALL {
            let named = Engine::from_str(engine.name(), false);
            assert_eq!(named, Ok(engine));
        }
        for kind in Kind::ALL {
            assert_eq!(Kind::from_str(kind.name(), false), Ok(kind));
        }
    }

    /// They are joined by semicolons, after the name of the preset.
    #[test]
    fn every_preset_says_what_it_does_not() {
        for (engine, kind) in Engine::ALL.into_iter().flat_map(|engine| Kind::ALL.map(|kind| (engine, kind))) {
            let sentences = engine.differences(kind);
            let are_parts = sentences.iter().all(|sentence| !sentence.ends_with('.') && !sentence.contains(';'));
            assert!(!sentences.is_empty() && are_parts, "{} {}: {sentences:?}", engine.name(), kind.name());
        }
    }

    /// Numbers that stand in other places of this workspace, and those that are derived here.
    #[test]
    fn numbers_are_the_engines() {
        let parts = |engine: Engine, kind: Kind| match engine.settings(kind).bias {
            Bias::Parts(parts) => parts,
            _ => BiasParts::NONE,
        };
        let bevy = parts(Engine::Bevy, Kind::Point);
        assert_eq!((bevy.constant, bevy.normal_offset), (Some(0.08), Some(0.848_528_15)));
        let filament = parts(Engine::Filament, Kind::Directional);
        assert_eq!((filament.constant, filament.normal_offset), (Some(0.001), Some(0.5)));
        assert_eq!(parts(Engine::Filament, Kind::Spot).normal_offset, Some(1.0));
        let ogre = parts(Engine::Ogre112, Kind::Spot);
        assert_eq!(ogre.receiver_gradient, Some(ReceiverGradient::default()));
        let babylon =
            parts(Engine::Babylon, Kind::Directional).polygon_offset.map(|offset| offset.units / Store::Depth24.steps());
        assert_eq!(babylon, Some(5e-5));
        let godot = parts(Engine::Godot, Kind::Directional);
        assert!(godot.constant.is_some_and(|metres| (metres - 0.001).abs() < 1e-9));
        assert_eq!(Engine::Bevy.settings(Kind::Point).filter_radius, Some(1.344));
    }
}
