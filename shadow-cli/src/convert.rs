//! Biases in the numbers of engines, in metres, and in the numbers of other engines.
//!
//! Engines count biases in metres, texels, shares of a depth range and steps of a format, some times a function of the angle between normal and light. Each of these is a length at one
//! [`Place`], in closed form, and back. A bias has three [components](Component), and what an engine has no parameter for is said, never dropped.
//!
//! With the distance d from the light on its axis and a perspective map from n to f, depth is `z / w = f / (f - n) - B / d` with `B = f n / (f - n)`. A depth of δ before d is then the length
//! `m = δ d² / (B + δ d)`, and a length of m the depth `B m / (d (d - m))`. Parallel rays have `z = (d - n) / (f - n)`, and δ is the length `δ (f - n)`.

use std::str::FromStr;

use crate::presets::{Engine, FILAMENT_NORMAL_TEXELS, Kind};

/// Steps of a depth format of 16 bits, in which OGRE 13's sample and Filament count the constant of a polygon offset.
const STEPS_16: f64 = 65_535.0;
/// The share of the larger slope that the caster shader of 2006 adds, in texels; it has no parameter.
const OGRE_2006_SLOPE: f64 = 0.25;
/// Godot takes a hundredth of `shadow_bias`, but around points (`light_storage.cpp`).
const GODOT_BIAS: f64 = 0.01;
/// Godot's step along the normal of spot and point lights is this over the map's size (`light_storage.cpp`), for spot lights at a metre from the light.
const GODOT_STEP: f64 = 10.0;
/// MJP's step along the normal is this over the map's size, as though the map were so many metres wide (`GetShadowPosOffset`).
const MJP_STEP: f64 = 2.0;

/// How far two lengths that are the same can be apart by rounding, as a share of them.
const ROUNDING: f64 = 1e-12;

/// Whose numbers a bias is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum System {
    /// Lengths, and slopes in texels.
    Metres,
    /// An engine.
    Engine(Engine),
}

/// What a bias does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Component {
    /// A length toward the light, everywhere on such a place.
    Constant,
    /// How far the lookup is moved off the surface, along its normal.
    Normal,
    /// A length toward the light that grows with the tangent of the angle between normal and light.
    Slope,
}

/// A parameter of an engine's bias.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Parameter {
    /// Its name there.
    pub(crate) name: &'static str,
    /// What it does.
    pub(crate) component: Component,
    /// Whether it is toward the light below 0.
    is_negative: bool,
}

/// Where a bias is a length: on the axis of a light, on a surface that leans along the rows or columns of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// The light's kind.
    pub(crate) kind: Kind,
    /// Whether its map is in perspective.
    pub(crate) is_perspective: bool,
    /// Width and height of the map in texels.
    pub(crate) map_size: u32,
    /// The width of a texel there, in metres.
    pub(crate) texel: f64,
    /// The distances of the near and the far plane, in metres.
    pub(crate) near: f64,
    /// See [`Self::near`].
    pub(crate) far: f64,
    /// The distance along the light's axis, in metres, from near to far.
    pub(crate) at: f64,
    /// The angle between normal and light, in radians, from 0 to below a right angle.
    pub(crate) angle: f64,
}

/// How a parameter's number becomes a length, at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Unit {
    /// So many metres each.
    Metres(f64),
    /// So much depth z / w each.
    Depth(f64),
    /// A share of the stored depth, which is added to that: `z <= stored (1 + share)`.
    OfStored,
    /// Metres of which a perspective map has the first order alone: `u = m (1 - m / d)`.
    Push,
}

/// A bias as it was typed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GivenBias {
    /// Whose numbers they are.
    pub(crate) system: System,
    /// The numbers in the order of the parameters; `None` for the engine's defaults.
    values: Option<Vec<f64>>,
}

/// A component of a bias, and what the target makes of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Converted {
    /// What it does.
    pub(crate) component: Component,
    /// Its length, in metres.
    pub(crate) metres: f64,
    /// What the target cannot do; `None` if it can.
    pub(crate) problem: Option<String>,
}

/// A bias in two systems.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Conversion {
    /// The numbers that were converted, by the names of their parameters.
    pub(crate) from: Vec<(&'static str, f64)>,
    /// The target's, likewise; `None` where no number does what is asked.
    pub(crate) to: Vec<(&'static str, Option<f64>)>,
    /// What it does, component by component.
    pub(crate) components: Vec<Converted>,
}

impl Component {
    /// Every component.
    pub(crate) const ALL: [Self; 3] = [Self::Constant, Self::Normal, Self::Slope];

    /// The name in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Normal => "normal",
            Self::Slope => "slope",
        }
    }

    /// What it is, for people.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Constant => "toward the light",
            Self::Normal => "along the normal",
            Self::Slope => "with the slope",
        }
    }
}

impl System {
    /// The name on the command line and in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Metres => "metres",
            Self::Engine(engine) => engine.name(),
        }
    }

    /// Its parameters. Of two for the same component the first is the one that conversions set.
    pub(crate) fn parameters(self) -> Vec<Parameter> {
        let [constant, normal, slope] =
            Component::ALL.map(|component| move |name| Parameter { name, component, is_negative: false });
        let Self::Engine(engine) = self else { return vec![constant("constant"), normal("normal"), slope("slope")] };
        match engine {
            Engine::Ogre2006 => vec![constant("units")],
            Engine::Ogre112 => vec![constant("fixed")],
            Engine::Ogre13 => vec![constant("constant"), slope("slope")],
            Engine::Mjp => vec![constant("bias"), normal("offsetScale")],
            Engine::Filament => {
                vec![
                    constant("constantBias"),
                    normal("normalBias"),
                    constant("polygonOffsetConstant"),
                    slope("polygonOffsetSlope"),
                ]
            }
            Engine::Bevy => vec![constant("depth"), normal("normal")],
            // It is added to the depth that is compared: `shadowCoord.z += shadowBias`.
            Engine::Three => vec![Parameter { is_negative: true, ..constant("bias") }, normal("normalBias")],
            Engine::Babylon => vec![constant("bias"), normal("normalBias")],
            Engine::Godot => vec![constant("bias"), normal("normal_bias")],
        }
    }

    /// How the numbers of a parameter become lengths at a place.
    fn unit(self, parameter: &Parameter, place: &Place) -> Unit {
        let (sine, cosine) = place.angle.sin_cos();
        let Self::Engine(engine) = self else {
            return if parameter.component == Component::Slope { Unit::Depth(place.slope_depth()) } else { Unit::Metres(1.0) };
        };
        match (engine, parameter.component, place.kind) {
            (Engine::Ogre2006, ..) => Unit::Push,
            (Engine::Ogre112, ..) => Unit::OfStored,
            // `glPolygonOffset` and its like: a factor on the larger of two slopes, which on such a place is the only one.
            (_, Component::Slope, _) => Unit::Depth(place.slope_depth()),
            (Engine::Ogre13, ..) => Unit::Depth(1.0 / STEPS_16),
            (Engine::Filament, Component::Constant, _) if parameter.name == "polygonOffsetConstant" => {
                Unit::Depth(1.0 / STEPS_16)
            }
            (Engine::Filament, Component::Constant, _) => Unit::Metres(1.0),
            (Engine::Filament, Component::Normal, kind) => Unit::Metres(kind.pick(FILAMENT_NORMAL_TEXELS) * place.texel * sine),
            (Engine::Mjp, Component::Constant, _) => Unit::Depth(1.0),
            (Engine::Mjp, Component::Normal, _) => Unit::Metres(MJP_STEP / f64::from(place.map_size) * (1.0 - cosine)),
            (Engine::Bevy, Component::Constant, _) => Unit::Metres(1.0),
            // The texel's diagonal, at any angle.
            (Engine::Bevy, Component::Normal, _) => Unit::Metres(std::f64::consts::SQRT_2 * place.texel),
            // Around points the distance over the range; otherwise z / w.
            (Engine::Three, Component::Constant, Kind::Point) => Unit::Metres(place.far - place.near),
            (Engine::Three, Component::Constant, _) => Unit::Depth(1.0),
            (Engine::Three, Component::Normal, _) => Unit::Metres(1.0),
            // `shadowMapVertexMetric`: (z + n) / (n + f) of clip z, which is linear in the distance; around points the distance plus n, over n + f.
            (Engine::Babylon, Component::Constant, Kind::Point) => Unit::Metres(place.far + place.near),
            (Engine::Babylon, Component::Constant, _) => Unit::Metres(place.far - place.near),
            // `shadowMapVertexNormalBias`: casters shrink by a length times the sine.
            (Engine::Babylon, Component::Normal, _) => Unit::Metres(sine),
            (Engine::Godot, Component::Constant, Kind::Directional) => Unit::Metres(GODOT_BIAS),
            // It is added to clip z, before the division by the distance.
            (Engine::Godot, Component::Constant, Kind::Spot) => Unit::Depth(GODOT_BIAS / place.at),
            (Engine::Godot, Component::Constant, Kind::Point) => Unit::Metres(1.0),
            // Across the light: the step's part along the normal is what lifts the lookup off the surface.
            (Engine::Godot, Component::Normal, Kind::Directional) => Unit::Metres(place.texel * (1.0 - cosine) * sine * sine),
            (Engine::Godot, Component::Normal, Kind::Spot) => {
                Unit::Metres(GODOT_STEP / f64::from(place.map_size) * place.at * (1.0 - cosine))
            }
            (Engine::Godot, Component::Normal, Kind::Point) => {
                Unit::Metres(GODOT_STEP / f64::from(place.map_size) * (1.0 - cosine))
            }
        }
    }

    /// The slope in texels that is there without a parameter.
    fn built_in_slope(self) -> f64 {
        if self == Self::Engine(Engine::Ogre2006) { OGRE_2006_SLOPE } else { 0.0 }
    }

    /// What a person should know about its numbers for a kind of light.
    pub(crate) fn remark(self, kind: Kind) -> Option<&'static str> {
        let Self::Engine(engine) = self else { return None };
        Some(match engine {
            Engine::Ogre2006 => {
                "ogre-2006: a unit is taken for a metre; its shader always adds a quarter of the slope over a texel, for which it has no parameter"
            }
            Engine::Ogre112 => "ogre-1.12: the sample's gradient, whose scale is 0 by default, is not converted",
            Engine::Ogre13 => {
                "ogre-13: amounts away from the light; a material's depth_bias has the sign that its render system takes for that"
            }
            Engine::Mjp if kind == Kind::Directional => {
                "mjp: the bias is used without the receiver plane alone, which is on by default; offsetScale is for a cascade as deep as the whole range"
            }
            Engine::Mjp => "mjp: the sample has directional lights alone; for others a share of z / w is taken",
            Engine::Three | Engine::Babylon => {
                return Some(if engine == Engine::Three {
                    "three: the range of depth is the map's here; three.js has the near and far of the light's shadow camera"
                } else {
                    "babylon: without a filter; the range of depth is the map's here, Babylon has shadowMinZ and shadowMaxZ or the camera's"
                });
            }
            Engine::Godot if kind == Kind::Spot => {
                "godot: the range of depth is the map's here; Godot's near plane is a 200th of the light's range"
            }
            Engine::Filament | Engine::Bevy | Engine::Godot => return None,
        })
    }
}

impl FromStr for System {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let engines = Engine::ALL.map(Self::Engine);
        let mut all = [Self::Metres].into_iter().chain(engines);
        all.find(|system| system.name() == text).ok_or_else(|| {
            let names = Engine::ALL.map(Engine::name).join(", ");
            format!("there is no engine `{text}`; there are: metres, {names}")
        })
    }
}

impl FromStr for GivenBias {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let Some((name, list)) = text.split_once(':') else {
            let system: System = text.trim().parse()?;
            if system == System::Metres {
                return Err("`metres` has no defaults; write metres:constant=0.01, for example".into());
            }
            return Ok(Self { system, values: None });
        };
        let system: System = name.trim().parse()?;
        let name = system.name();
        let parameters = system.parameters();
        let names: Vec<_> = parameters.iter().map(|parameter| parameter.name).collect();
        let names = names.join(", ");
        let mut values: Vec<Option<f64>> = vec![None; parameters.len()];
        for part in list.split(';').map(str::trim).filter(|part| !part.is_empty()) {
            let Some((key, value)) = part.split_once('=') else {
                return Err(format!("`{part}` is not NAME=VALUE; {name} has: {names}"));
            };
            let (key, value) = (key.trim(), value.trim());
            let Some(index) = parameters.iter().position(|parameter| parameter.name == key) else {
                return Err(format!("{name} has no parameter `{key}`; it has: {names}"));
            };
            let number = value.parse().ok().filter(|number: &f64| number.is_finite());
            let number = number.ok_or_else(|| format!("{name}: {key}={value} is not a finite number"))?;
            let is_negative = parameters[index].is_negative;
            if (is_negative && number > 0.0) || (!is_negative && number < 0.0) {
                let limit = if is_negative { "at most 0, since it is added to the depth that is compared" } else { "at least 0" };
                return Err(format!("{name}: {key}={value} would be away from the light; it is {limit}"));
            }
            if values[index].replace(number).is_some() {
                return Err(format!("{name}: {key} is given twice; give it once"));
            }
        }
        if values.iter().all(Option::is_none) {
            return Err(format!("`{text}` has no number; write {name} for its defaults, or some of: {names}"));
        }
        Ok(Self { system, values: Some(values.into_iter().map(Option::unwrap_or_default).collect()) })
    }
}

impl Place {
    /// The depth z / w there.
    fn depth(&self) -> f64 {
        let share = (self.at - self.near) / (self.far - self.near);
        if self.is_perspective { share * self.far / self.at } else { share }
    }

    /// How fast depth grows there, times the square of the distance in perspective.
    fn factor(&self) -> f64 {
        let range = self.far - self.near;
        if self.is_perspective { self.far * self.near / range } else { 1.0 / range }
    }

    /// The length that a depth before the place takes up.
    fn metres_of_depth(&self, depth: f64) -> f64 {
        if self.is_perspective { depth * self.at * self.at / (self.factor() + depth * self.at) } else { depth / self.factor() }
    }

    /// The depth that a length before the place takes up; `None` where it reaches back to the light.
    fn depth_of_metres(&self, metres: f64) -> Option<f64> {
        if !self.is_perspective {
            return Some(metres * self.factor());
        }
        (metres < self.at).then(|| self.factor() * metres / (self.at * (self.at - metres)))
    }

    /// By how much depth the surface falls away over a texel. In the map that is the same all over a plane: with `1 / d = (1 - u tan) / D` at the tangent u from the axis, z / w grows by
    /// `B tan / D` with u.
    fn slope_depth(&self) -> f64 {
        let fall = self.factor() * self.texel * self.angle.tan();
        if self.is_perspective { fall / (self.at * self.at) } else { fall }
    }
}

impl Unit {
    /// The length of a number of at least 0.
    fn to_metres(self, number: f64, place: &Place) -> Result<f64, String> {
        Ok(match self {
            Self::Metres(each) => number * each,
            Self::Depth(each) => place.metres_of_depth(number * each),
            Self::OfStored => place.metres_of_depth(place.depth() * number / (1.0 + number)),
            Self::Push if place.is_perspective => {
                // The root of m² - d m + u d = 0 that is 0 without a push.
                let root = place.at * (place.at - 4.0 * number);
                if root < 0.0 {
                    return Err(format!(
                        "pushed by more than a quarter of the distance to the light, {} m, casters shadow nothing",
                        0.25 * place.at
                    ));
                }
                2.0 * number * place.at / (place.at + root.sqrt())
            }
            Self::Push => number,
        })
    }

    /// The number of at least 0 whose length that is.
    fn of_metres(self, metres: f64, place: &Place) -> Result<f64, &'static str> {
        const TO_LIGHT: &str = "the bias reaches back to the light, where depth has no end";
        if metres == 0.0 {
            return Ok(0.0);
        }
        match self {
            Self::Metres(each) if each > 0.0 => Ok(metres / each),
            Self::Metres(_) => Err("at this angle no number of it does anything"),
            Self::Depth(each) => place.depth_of_metres(metres).map(|depth| depth / each).ok_or(TO_LIGHT),
            Self::OfStored => {
                let depth = place.depth_of_metres(metres).ok_or(TO_LIGHT)?;
                let stored = place.depth() - depth;
                if stored > 0.0 {
                    Ok(depth / stored)
                } else {
                    Err("the bias reaches back to the near plane, where a share of the stored depth is nothing")
                }
            }
            Self::Push if !place.is_perspective => Ok(metres),
            Self::Push if metres <= 0.5 * place.at => Ok(metres * (1.0 - metres / place.at)),
            Self::Push => Err("no push is as much as half of the distance to the light"),
        }
    }
}

/// Converts a bias at a place. An error says which of its numbers is no length there.
pub(crate) fn convert(given: &GivenBias, to: System, place: &Place) -> Result<Conversion, String> {
    let from = given.system;
    let parameters = from.parameters();
    let values = match (&given.values, from) {
        (Some(values), _) => values.clone(),
        (None, System::Engine(engine)) => engine.defaults(place.kind),
        (None, System::Metres) => vec![0.0; parameters.len()],
    };
    let targets = to.parameters();
    let mut numbers: Vec<Option<f64>> = vec![Some(0.0); targets.len()];
    let mut components = Vec::with_capacity(Component::ALL.len());
    for component in Component::ALL {
        let built_in = |system: System| {
            if component == Component::Slope { place.metres_of_depth(system.built_in_slope() * place.slope_depth()) } else { 0.0 }
        };
        let mut metres = built_in(from);
        for (parameter, value) in parameters.iter().zip(&values).filter(|(parameter, _)| parameter.component == component) {
            let length = from.unit(parameter, place).to_metres(value.abs(), place);
            metres += length.map_err(|problem| format!("{}: {}={value}: {problem}", from.name(), parameter.name))?;
        }
        let problem = match targets.iter().position(|parameter| parameter.component == component) {
            Some(index) => {
                let parameter = &targets[index];
                let found = to.unit(parameter, place).of_metres(metres, place);
                numbers[index] = found.ok().map(|number| if parameter.is_negative && number > 0.0 { -number } else { number });
                found.err().map(|problem| format!("{}'s {}: {problem}", to.name(), parameter.name))
            }
            None if (metres - built_in(to)).abs() <= ROUNDING * metres => None,
            None if built_in(to) > 0.0 => {
                Some(format!("{} has no parameter for this, and always adds {:.4} m", to.name(), built_in(to)))
            }
            None => Some(format!("{} has no parameter for this", to.name())),
        };
        components.push(Converted { component, metres, problem });
    }
    let named = |parameters: &[Parameter]| parameters.iter().map(|parameter| parameter.name).collect::<Vec<_>>();
    Ok(Conversion {
        from: named(&parameters).into_iter().zip(values).collect(),
        to: named(&targets).into_iter().zip(numbers).collect(),
        components,
    })
}

#[cfg(test)]
mod tests;
