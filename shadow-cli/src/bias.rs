//! Biases by their names, joined by plus signs, and by the numbers that go with them: on the command line and in settings files.

use std::{fmt, str::FromStr};

use shadow_math::{
    Bias,
    settings::{BiasParts, Ogre2006, PolygonOffset, ReceiverGradient},
};

/// The constant bias in metres if none is given: a centimetre.
const DEFAULT_CONSTANT_METRES: f32 = 0.01;
/// The step along the normal in texels if none is given: what a bilinear lookup reaches.
const DEFAULT_NORMAL_TEXELS: f32 = 1.0;
/// The most that a receiver plane corrects if nothing is said: ten centimetres, a few texels of a town's map and many of a room's.
const DEFAULT_LIMIT_METRES: f32 = 0.1;

/// The name of a bias, or of a part of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BiasName {
    Automatic,
    None,
    Constant,
    Slope,
    NormalOffset,
    ReceiverPlane,
    ReceiverGradient,
    BackFaces,
    PolygonOffset,
    Ogre2006,
    Ogre2006Corrected,
}

impl BiasName {
    const ALL: [Self; 11] = [
        Self::Automatic,
        Self::None,
        Self::Constant,
        Self::Slope,
        Self::NormalOffset,
        Self::ReceiverPlane,
        Self::ReceiverGradient,
        Self::BackFaces,
        Self::PolygonOffset,
        Self::Ogre2006,
        Self::Ogre2006Corrected,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Automatic => "automatic",
            Self::None => "none",
            Self::Constant => "constant",
            Self::Slope => "slope",
            Self::NormalOffset => "normal-offset",
            Self::ReceiverPlane => "receiver-plane",
            Self::ReceiverGradient => "receiver-gradient",
            Self::BackFaces => "back-faces",
            Self::PolygonOffset => "polygon-offset",
            Self::Ogre2006 => "ogre-2006",
            Self::Ogre2006Corrected => "ogre-2006-corrected",
        }
    }
}

/// One bias by itself, or several parts that add up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct BiasNames(Vec<BiasName>);

impl Default for BiasNames {
    fn default() -> Self {
        Self(vec![BiasName::Automatic])
    }
}

impl fmt::Display for BiasNames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<_> = self.0.iter().map(|name| name.name()).collect();
        f.write_str(&names.join("+"))
    }
}

impl FromStr for BiasNames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut names = Vec::new();
        for typed in text.split('+') {
            let Some(name) = BiasName::ALL.into_iter().find(|name| name.name() == typed) else {
                let all = BiasName::ALL.map(BiasName::name).join(", ");
                return Err(format!("`{typed}` is not a bias; take one of {all}, or several joined by plus signs"));
            };
            if names.contains(&name) {
                return Err(format!("`{typed}` is named twice; name each part once"));
            }
            names.push(name);
        }
        if let (Some(alone), true) =
            (names.iter().find(|name| matches!(name, BiasName::Automatic | BiasName::None)), names.len() > 1)
        {
            return Err(format!("`{}` stands by itself; leave it or the other parts out", alone.name()));
        }
        if names.contains(&BiasName::Slope) && names.contains(&BiasName::ReceiverPlane) {
            return Err("`slope` and `receiver-plane` are two remedies for the same slope; leave one of them out".into());
        }
        let pushes = [BiasName::PolygonOffset, BiasName::Ogre2006, BiasName::Ogre2006Corrected];
        if let [first, second, ..] = pushes.into_iter().filter(|name| names.contains(name)).collect::<Vec<_>>()[..] {
            return Err(format!("`{}` and `{}` both draw casters deeper; leave one of them out", first.name(), second.name()));
        }
        Ok(Self(names))
    }
}

/// The numbers of biases; `None` for each that is not given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BiasNumbers {
    /// Metres toward the light.
    pub(crate) constant: Option<f32>,
    /// A factor on what planes need.
    pub(crate) scale: Option<f32>,
    /// Texels along the normal.
    pub(crate) normal: Option<f32>,
    /// The most metres that a receiver plane corrects.
    pub(crate) limit: Option<f32>,
    /// A receiver gradient's fixed share, clamp and scale.
    pub(crate) gradient: Option<[f32; 3]>,
    /// A polygon offset's slope, units and clamp.
    pub(crate) offset: Option<[f32; 3]>,
    /// Metres that the caster shader of 2006 pushes.
    pub(crate) push: Option<f32>,
}

/// A number without a meaning beside the biases that are named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Meaningless {
    /// The key that it has in a settings file; an option has the same name.
    pub(crate) key: &'static str,
    /// With which biases it would have one.
    pub(crate) use_with: &'static [&'static str],
}

/// Every key, and the biases that it goes with.
const KEYS: [Meaningless; 7] = [
    Meaningless { key: "bias-constant", use_with: &["constant", "slope"] },
    Meaningless { key: "bias-scale", use_with: &["slope"] },
    Meaningless { key: "bias-normal", use_with: &["normal-offset"] },
    Meaningless { key: "bias-limit", use_with: &["receiver-plane"] },
    Meaningless { key: "bias-gradient", use_with: &["receiver-gradient"] },
    Meaningless { key: "bias-offset", use_with: &["polygon-offset"] },
    Meaningless { key: "bias-push", use_with: &["ogre-2006", "ogre-2006-corrected"] },
];

impl BiasNames {
    /// The bias, with the defaults of what is not given. What its numbers may be is the plan's to say.
    pub(crate) fn with(&self, numbers: &BiasNumbers) -> Result<Bias, Meaningless> {
        let BiasNumbers { constant, scale, normal, limit, gradient, offset, push } = *numbers;
        let given = [
            constant.is_some(),
            scale.is_some(),
            normal.is_some(),
            limit.is_some(),
            gradient.is_some(),
            offset.is_some(),
            push.is_some(),
        ];
        let has = |name: BiasName| self.0.contains(&name);
        for (key, _) in KEYS.into_iter().zip(given).filter(|(_, is_given)| *is_given) {
            if !self.0.iter().any(|name| key.use_with.contains(&name.name())) {
                return Err(key);
            }
        }
        if has(BiasName::Automatic) {
            return Ok(Bias::Automatic);
        }
        let of = |name: BiasName, number: f32| has(name).then_some(number);
        let [fixed, clamp, gradient_scale] = gradient.unwrap_or_else(|| {
            let ReceiverGradient { fixed, clamp, scale } = ReceiverGradient::default();
            [fixed, clamp, scale]
        });
        let polygon_offset =
            offset.map_or_else(PolygonOffset::default, |[slope, units, clamp]| PolygonOffset { slope, units, clamp });
        let metres = push.unwrap_or(Ogre2006::default().metres);
        let is_corrected = has(BiasName::Ogre2006Corrected);
        Ok(Bias::Parts(BiasParts {
            polygon_offset: has(BiasName::PolygonOffset).then_some(polygon_offset),
            ogre_2006: (is_corrected || has(BiasName::Ogre2006)).then_some(Ogre2006 { metres, is_corrected }),
            back_faces: has(BiasName::BackFaces),
            constant: of(BiasName::Constant, constant.unwrap_or(DEFAULT_CONSTANT_METRES)).or(constant),
            slope: of(BiasName::Slope, scale.unwrap_or(1.0)),
            normal_offset: of(BiasName::NormalOffset, normal.unwrap_or(DEFAULT_NORMAL_TEXELS)),
            receiver_plane: of(BiasName::ReceiverPlane, limit.unwrap_or(DEFAULT_LIMIT_METRES)),
            receiver_gradient: has(BiasName::ReceiverGradient).then_some(ReceiverGradient {
                fixed,
                clamp,
                scale: gradient_scale,
            }),
        }))
    }

    /// The names of a bias, and its numbers.
    pub(crate) fn of(bias: Bias) -> (Self, BiasNumbers) {
        let Bias::Parts(parts) = bias else { return (Self::default(), BiasNumbers::default()) };
        let BiasParts {
            constant,
            slope,
            normal_offset,
            receiver_plane,
            receiver_gradient,
            polygon_offset,
            ogre_2006,
            back_faces,
        } = parts;
        let is_corrected = ogre_2006.is_some_and(|shader| shader.is_corrected);
        let parts = [
            // A length beside a slope needs no name of its own.
            (BiasName::Constant, constant.is_some() && slope.is_none()),
            (BiasName::Slope, slope.is_some()),
            (BiasName::NormalOffset, normal_offset.is_some()),
            (BiasName::ReceiverPlane, receiver_plane.is_some()),
            (BiasName::ReceiverGradient, receiver_gradient.is_some()),
            (BiasName::BackFaces, back_faces),
            (BiasName::PolygonOffset, polygon_offset.is_some()),
            (BiasName::Ogre2006, ogre_2006.is_some() && !is_corrected),
            (BiasName::Ogre2006Corrected, is_corrected),
        ];
        let mut names: Vec<_> = parts.into_iter().filter_map(|(name, is_there)| is_there.then_some(name)).collect();
        if names.is_empty() {
            names.push(BiasName::None);
        }
        let gradient = receiver_gradient.map(|ReceiverGradient { fixed, clamp, scale }| [fixed, clamp, scale]);
        let offset = polygon_offset.map(|PolygonOffset { slope, units, clamp }| [slope, units, clamp]);
        let push = ogre_2006.map(|Ogre2006 { metres, .. }| metres);
        let numbers =
            BiasNumbers { constant, scale: slope, normal: normal_offset, limit: receiver_plane, gradient, offset, push };
        (Self(names), numbers)
    }
}

/// A bias in a line: its names and the numbers that are not at their defaults.
pub(crate) fn summary(bias: Bias) -> String {
    let (names, BiasNumbers { constant, scale, normal, limit, gradient, offset, push }) = BiasNames::of(bias);
    let mut text = names.to_string();
    if let Some(scale) = scale.filter(|&scale| scale != 1.0) {
        text += &format!(" x {scale}");
    }
    if let Some(metres) = constant.filter(|&metres| metres > 0.0) {
        text += &format!(" {metres} m");
    }
    if let Some(texels) = normal {
        text += &format!(" {texels} texels");
    }
    if let Some(metres) = limit {
        text += &format!(" up to {metres} m");
    }
    if let Some([slope, units, clamp]) = offset {
        text += &format!(" {slope}, {units}, {clamp}");
    }
    if let Some(metres) = push {
        text += &format!(" {metres} m");
    }
    if let Some([fixed, clamp, scale]) = gradient {
        text += &format!(" {fixed}, {clamp}, {scale}");
    }
    text
}

/// Two or three numbers with commas: a polygon offset's.
pub(crate) fn offset_numbers(text: &str) -> Result<[f32; 3], String> {
    let numbers: Option<Vec<f32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[slope, units]) => Ok([slope, units, 0.0]),
        Some(&[slope, units, clamp]) => Ok([slope, units, clamp]),
        _ => Err(format!(
            "`{text}` is not a polygon offset; write its slope, its units and, if there is one, its clamp with commas, as 2,4 or 2,4,0.01"
        )),
    }
}

/// Three numbers with commas: a receiver gradient's.
pub(crate) fn gradient_numbers(text: &str) -> Result<[f32; 3], String> {
    let problem = || {
        format!(
            "`{text}` is not a receiver gradient; write its fixed share, its clamp and its scale with commas, as 0.0005,0.0098,1"
        )
    };
    let numbers: Option<Vec<f32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    numbers.and_then(|numbers| <[f32; 3]>::try_from(numbers).ok()).ok_or_else(problem)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(text: &str) -> BiasNames {
        text.parse().expect(text)
    }

    #[test]
    fn every_name_is_a_bias_and_comes_back() {
        let gradient = BiasNumbers { gradient: Some([0.001, 0.01, 1.0]), ..BiasNumbers::default() };
        for (text, numbers) in [
            ("automatic", BiasNumbers::default()),
            ("none", BiasNumbers::default()),
            ("constant", BiasNumbers { constant: Some(0.5), ..BiasNumbers::default() }),
            ("slope", BiasNumbers { scale: Some(2.0), constant: Some(0.1), ..BiasNumbers::default() }),
            ("normal-offset+receiver-plane", BiasNumbers { normal: Some(2.0), limit: Some(0.3), ..BiasNumbers::default() }),
            ("normal-offset+back-faces", BiasNumbers { normal: Some(0.5), ..BiasNumbers::default() }),
            ("constant+receiver-gradient", BiasNumbers { constant: Some(0.5), ..gradient }),
            ("polygon-offset", BiasNumbers { offset: Some([1.0, 2.0, 0.5]), ..BiasNumbers::default() }),
            ("ogre-2006", BiasNumbers { push: Some(0.5), ..BiasNumbers::default() }),
            ("back-faces+ogre-2006-corrected", BiasNumbers { push: Some(0.5), ..BiasNumbers::default() }),
        ] {
            let bias = named(text).with(&numbers).expect(text);
            assert_eq!(BiasNames::of(bias), (named(text), numbers), "{text}");
        }
    }

    #[test]
    fn defaults_stand_in_for_what_is_not_given() {
        let parts = |text: &str| {
            let bias = named(text).with(&BiasNumbers::default()).expect("no number is given that could have no meaning");
            let Bias::Parts(parts) = bias else { return None };
            Some(parts)
        };
        assert_eq!(parts("none"), Some(BiasParts::NONE));
        assert_eq!(parts("constant+normal-offset").and_then(|parts| parts.constant), Some(0.01));
        assert_eq!(parts("slope"), Some(BiasParts { slope: Some(1.0), ..BiasParts::NONE }));
        let gradient = parts("receiver-gradient").and_then(|parts| parts.receiver_gradient);
        assert_eq!(gradient, Some(ReceiverGradient::default()));
        assert_eq!(parts("receiver-plane").and_then(|parts| parts.receiver_plane), Some(0.1));
        assert_eq!(parts("automatic"), None);
    }

    #[test]
    fn what_does_not_go_together_is_refused() {
        for (text, part) in [
            ("smooth", "receiver-plane"),
            ("slope+slope", "twice"),
            ("automatic+slope", "by itself"),
            ("none+constant", "by itself"),
            ("slope+receiver-plane", "leave one"),
            ("polygon-offset+ogre-2006", "both draw"),
            ("ogre-2006+ogre-2006-corrected", "both draw"),
            ("", "not a bias"),
        ] {
            let problem = text.parse::<BiasNames>().expect_err(text);
            assert!(problem.contains(part), "{text}: {problem}");
        }
        let numbers = BiasNumbers { normal: Some(1.0), ..BiasNumbers::default() };
        assert_eq!(named("slope").with(&numbers).map_err(|meaningless| meaningless.key), Err("bias-normal"));
        assert!(gradient_numbers("1,2").is_err() && gradient_numbers("1,2,x").is_err());
        assert_eq!(gradient_numbers("0.5, 1,2"), Ok([0.5, 1.0, 2.0]));
        assert_eq!(offset_numbers("1.5, 4"), Ok([1.5, 4.0, 0.0]));
        assert!(offset_numbers("1.5").is_err());
    }
}
