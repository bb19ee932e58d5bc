//! How lights are shadowed: options that are the keys of settings files.

use std::path::PathBuf;

use clap::{Args as ClapArgs, builder::PossibleValuesParser};
use shadow_math::{Filter, Store, Terminator, Texels, settings::SUBPIXEL_BITS};

use super::filter::FilterName;
use crate::{
    bias::{BiasNames, BiasNumbers, gradient_numbers, offset_numbers},
    light_camera::LightCameraArgs,
    presets::Engine,
    specs::{ByteSize, Selector, bias_metres, map_size},
};

/// How lights are shadowed, but for the bias.
#[derive(Clone, Debug, ClapArgs)]
pub(crate) struct ShadowArgs {
    /// How lights and shadows come together: additive (each light where it is seen) or modulative (all lights, darkened where one is not seen)
    ///
    /// additive is the sum of the lights that reach a surface. modulative multiplies the sum of all lights, the ambient one too, by a color wherever one that would reach a surface is hidden, as OGRE's modulative
    /// shadows do: highlights stay visible in shadow, and ambient light does not fill it.
    #[arg(long, value_name = "COMPOSITION", default_value = "additive", value_parser = PossibleValuesParser::new(["additive", "modulative"]), help_heading = "Shadows")]
    pub(crate) composition: String,

    /// What modulative shadows multiply by: linear, each part from 0 to 1 [default: 0.25,0.25,0.25, as OGRE]
    #[arg(long, value_name = "R,G,B", value_parser = color_numbers, help_heading = "Shadows")]
    pub(crate) shadow_color: Option<[f32; 3]>,

    /// In how many passes lights are drawn: one for all of them, or each in its own
    ///
    /// With each, the passes are added up, or multiplied with modulative shadows, as engines do that know one light at a time. The picture is the same but for rounding.
    #[arg(long, value_name = "one|each", default_value = "one", value_parser = PossibleValuesParser::new(["one", "each"]), help_heading = "Shadows")]
    pub(crate) light_passes: String,

    /// A light from which nothing is shadowed, by its name or number; can be given several times
    #[arg(long = "no-shadow", value_name = "LIGHT", help_heading = "Shadows")]
    pub(crate) no_shadow: Vec<Selector>,

    /// An object that casts no shadow, by its name or number; can be given several times
    ///
    /// Numbers count from 0. A name stands for all objects that have it; a name that no object has is told which there are.
    #[arg(long = "no-cast", value_name = "OBJECT", help_heading = "Shadows")]
    pub(crate) no_cast: Vec<Selector>,

    /// A settings file for one light in place of the options, by the light's name or number; can be given several times
    ///
    /// All maps are of one size: the file's map-size is not looked at.
    #[arg(long = "light-settings", value_name = "LIGHT=FILE", value_parser = light_settings, help_heading = "Shadows")]
    pub(crate) light_settings: Vec<LightSettings>,

    /// The most memory that shadow maps may take, such as 64MiB [default: no limit of their own]
    ///
    /// Each map takes 4 bytes a texel. What would take more is refused, with the size of maps that fits.
    #[arg(long, value_name = "SIZE", help_heading = "Shadows")]
    pub(crate) shadow_budget: Option<ByteSize>,

    /// Width and height of each shadow map in texels, from 16 to 16384
    #[arg(
        long,
        value_name = "TEXELS",
        default_value_t = 2048,
        value_parser = map_size,
        help_heading = "Shadows"
    )]
    pub(crate) map_size: u32,

    /// Where samples go, and how many maps there are.
    #[command(flatten)]
    pub(crate) cameras: LightCameraArgs,

    /// Bits of the sub-pixel grid that vertices are snapped to where maps are drawn, from 4 to 8 [default: 4 on SwiftShader, else 8]
    ///
    /// The biases that follow the receiver's plane leave half a step of it to the rasteriser. Hardware has 8; what an adapter has is measured by `shadow probe`.
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u32).range(i64::from(*SUBPIXEL_BITS.start())..=i64::from(*SUBPIXEL_BITS.end())), help_heading = "Shadows")]
    pub(crate) subpixel_bits: Option<u32>,

    /// How depth tests are averaged
    #[arg(long, value_enum, value_name = "FILTER", default_value_t = FilterName(Filter::Bilinear), help_heading = "Shadows")]
    pub(crate) filter: FilterName,

    /// How far the filter reaches, in texels: from 1 to 4 for gaussian [default: 2], from 0.5 to 16 for poisson and vogel [default: 2.5]
    ///
    /// The other filters have a size of their own, and with them it is refused.
    #[arg(long, value_name = "TEXELS", allow_negative_numbers = true, help_heading = "Shadows")]
    pub(crate) filter_radius: Option<f32>,

    /// What a texel remembers: depth32, depth24, depth16, reversed32, linear, second or midpoint
    ///
    /// depth32, depth24 and depth16 are the nearest caster's depth z / w, as a 32-bit float or rounded to so many bits. reversed32 is 1 - z / w as a float, which is finest where z / w is coarsest. linear is the
    /// distance along the light's axis as a float. second is the second surface's depth and midpoint the mean of the first's and the second's, which keep closed casters from
    /// shadowing themselves and leave light behind open ones.
    #[arg(long, value_name = "STORE", default_value = "depth32", value_parser = store, help_heading = "Shadows")]
    pub(crate) store: Store,

    /// Where lookups think that texel centres are: opengl (half-way between whole numbers) or direct3d (at whole numbers)
    ///
    /// Maps are drawn as in OpenGL, Vulkan, WebGPU and Direct3D from version 10. direct3d adds the half texel that Direct3D up to version 9 needs, and so shows what mixing the two up costs.
    #[arg(long, value_name = "CONVENTION", default_value = "opengl", value_parser = texels, help_heading = "Shadows")]
    pub(crate) texels: Texels,

    /// What becomes of light where the facets of smooth meshes turn away from it: hard or soft
    ///
    /// A facet that turns away is in its own shadow even where the mesh's smooth normal still faces the light. hard ends the light there, all at once and along the facets' edges; soft lets
    /// it fade out before any facet can turn away, at the price that the terminator moves toward the light: on coarse meshes by more. It is light that fades: modulative shadows, which
    /// multiply, keep their edge.
    #[arg(long, value_name = "hard|soft", default_value = "hard", value_parser = terminator, help_heading = "Shadows")]
    pub(crate) terminator: Terminator,
}

/// A settings file for one light.
#[derive(Clone, Debug)]
pub(crate) struct LightSettings {
    /// The light.
    pub(crate) light: Selector,
    /// The file.
    pub(crate) path: PathBuf,
}

/// `LIGHT=FILE`.
fn light_settings(text: &str) -> Result<LightSettings, String> {
    let parts = text.split_once('=').filter(|(light, path)| !light.is_empty() && !path.is_empty());
    let (light, path) = parts.ok_or_else(|| {
        format!("`{text}` is no settings file of a light; write the light's name or number, an equals sign and the file, as 0=sun.toml")
    })?;
    Ok(LightSettings { light: Selector::from(light), path: path.into() })
}

/// Three numbers with commas, each from 0 to 1.
fn color_numbers(text: &str) -> Result<[f32; 3], String> {
    let numbers: Option<Vec<f32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    let color = numbers.and_then(|numbers| <[f32; 3]>::try_from(numbers).ok());
    color.filter(|color| color.iter().all(|part| (0.0..=1.0).contains(part))).ok_or_else(|| {
        format!(
            "`{text}` is not a shadow color; write three numbers from 0 (black) to 1 (no shadow) with commas, as 0.25,0.25,0.25"
        )
    })
}

/// What is stored, by its name.
fn store(text: &str) -> Result<Store, String> {
    let names = Store::ALL.map(Store::name).join(", ");
    let found = Store::ALL.into_iter().find(|store| store.name() == text);
    found.ok_or_else(|| format!("`{text}` is not a store; take one of {names}"))
}

/// A texel convention, by its name.
fn texels(text: &str) -> Result<Texels, String> {
    match text {
        "opengl" => Ok(Texels::OpenGl),
        "direct3d" => Ok(Texels::Direct3d),
        _ => Err(format!("`{text}` is not a texel convention; take opengl or direct3d")),
    }
}

/// A treatment of the terminator, by its name.
fn terminator(text: &str) -> Result<Terminator, String> {
    match text {
        "hard" => Ok(Terminator::Hard),
        "soft" => Ok(Terminator::Soft),
        _ => Err(format!("`{text}` is not a treatment of the terminator; take hard or soft")),
    }
}

/// How surfaces are kept from shadowing themselves: the choices of all commands on pictures but the one that certifies the automatic bias.
#[derive(Clone, Debug, Default, ClapArgs)]
pub(crate) struct BiasArgs {
    /// The defaults of an engine, by the kind of each light, as far as the other options can say them
    ///
    /// Map size, filter, what is stored and the bias, with the numbers of the engine's own sources. What of them cannot be said is told in a note. To change a preset, print it as a file with
    /// `shadow settings --preset NAME`, which also has it as options.
    #[arg(
        long,
        value_enum,
        value_name = "NAME",
        conflicts_with_all = [
            "map_size", "filter", "filter_radius", "store", "texels", "terminator", "bias", "bias_constant", "bias_scale", "bias_normal", "bias_limit", "bias_gradient",
            "bias_offset", "bias_push"
        ],
        help_heading = "Shadows"
    )]
    pub(crate) preset: Option<Engine>,

    /// How surfaces are kept from shadowing themselves: automatic, none, or parts joined by plus signs
    ///
    /// automatic is what the receiver's plane needs under the filter, by depth or along its normal: there is nothing to tune. none shows self-shadowing as it is. The parts, which add
    /// up, are constant (the same length everywhere), slope (what the receiver's plane needs, by depth alone), normal-offset (a step along the normal, in texels times the sine
    /// of its angle with the light), receiver-plane (each tap is compared with the depth that the receiver's plane has there; not with slope), receiver-gradient (what
    /// OGRE 1.12's sample reads off the map) and back-faces (of single-sided casters the map has the back faces alone). Casters are drawn deeper with polygon-offset (as hardware does it),
    /// ogre-2006 (as the shader of "Shadow Mapping in Ogre" does it) or ogre-2006-corrected (as its text asks for).
    #[arg(long, value_name = "BIAS", default_value_t = BiasNames::default(), help_heading = "Shadows")]
    pub(crate) bias: BiasNames,

    /// Metres added to the bias along the light's view axis, with constant [default: 0.01] or slope [default: 0]
    #[arg(long, value_name = "METRES", value_parser = bias_metres, allow_negative_numbers = true, help_heading = "Shadows")]
    pub(crate) bias_constant: Option<f32>,

    /// A factor on what the receiver's plane needs, with slope [default: 1, which is enough and no more]
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true, help_heading = "Shadows")]
    pub(crate) bias_scale: Option<f32>,

    /// Texels along the normal, with normal-offset, from 0 to 8 [default: 1]
    #[arg(long, value_name = "TEXELS", allow_negative_numbers = true, help_heading = "Shadows")]
    pub(crate) bias_normal: Option<f32>,

    /// The most metres that a tap is corrected by, with receiver-plane [default: 0.1]
    #[arg(long, value_name = "METRES", value_parser = bias_metres, allow_negative_numbers = true, help_heading = "Shadows")]
    pub(crate) bias_limit: Option<f32>,

    /// The share of the stored depth, the clamp on differences and their scale, with receiver-gradient [default: 0.0005,0.0098,0]
    #[arg(long, value_name = "FIXED,CLAMP,SCALE", value_parser = gradient_numbers, allow_negative_numbers = true, help_heading = "Shadows")]
    pub(crate) bias_gradient: Option<[f32; 3]>,

    /// The factor on the larger slope, the units and the clamp in depth (0 for none), with polygon-offset [default: 2,4,0]
    #[arg(long, value_name = "SLOPE,UNITS[,CLAMP]", value_parser = offset_numbers, allow_negative_numbers = true, help_heading = "Shadows")]
    pub(crate) bias_offset: Option<[f32; 3]>,

    /// Metres by which casters are pushed away from the light, with ogre-2006 or ogre-2006-corrected [default: 1, as published]
    #[arg(long, value_name = "METRES", value_parser = bias_metres, allow_negative_numbers = true, help_heading = "Shadows")]
    pub(crate) bias_push: Option<f32>,
}

impl BiasArgs {
    /// The numbers that were typed.
    pub(crate) fn numbers(&self) -> BiasNumbers {
        BiasNumbers {
            constant: self.bias_constant,
            scale: self.bias_scale,
            normal: self.bias_normal,
            limit: self.bias_limit,
            gradient: self.bias_gradient,
            offset: self.bias_offset,
            push: self.bias_push,
        }
    }
}
