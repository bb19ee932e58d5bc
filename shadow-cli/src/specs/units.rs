//! Numbers on the command line: written without a unit, and what is said to those who write one.

use super::SpecError;

/// What a number on the command line is measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unit {
    Metres,
    Degrees,
    Seconds,
    Lux,
    Candela,
    /// Exposure value, EV at ISO 100.
    ExposureValue,
    /// A direction or a colour.
    None,
}

impl Unit {
    /// What the numbers of a key of a description are measured in.
    pub(super) fn of_key(key: &str) -> Self {
        match key {
            "pos" | "eye" | "target" | "range" | "radius" | "width" | "height" => Self::Metres,
            "inner" | "outer" | "fov" | "diameter" => Self::Degrees,
            "lux" => Self::Lux,
            "cd" => Self::Candela,
            _ => Self::None,
        }
    }

    /// The end of a sentence that begins with what is measured.
    fn is_in(self) -> &'static str {
        match self {
            Self::Metres => "is in metres",
            Self::Degrees => "is in degrees",
            Self::Seconds => "is in seconds",
            Self::Lux => "is in lux",
            Self::Candela => "is in candela",
            Self::ExposureValue => "is an exposure value",
            Self::None => "has no unit",
        }
    }

    /// How many of this unit one of a unit that somebody wrote is.
    fn one(self, written: &str) -> Option<f64> {
        let known: &[(&str, f64)] = match self {
            Self::Metres => &[("mm", 1e-3), ("cm", 1e-2), ("dm", 0.1), ("m", 1.0), ("km", 1e3), ("in", 0.0254), ("ft", 0.3048)],
            Self::Degrees => &[("deg", 1.0), ("degrees", 1.0), ("°", 1.0), ("rad", 180.0 / std::f64::consts::PI)],
            Self::Seconds => &[("ms", 1e-3), ("s", 1.0), ("sec", 1.0), ("min", 60.0)],
            Self::Lux => &[("lx", 1.0), ("lux", 1.0), ("klx", 1e3)],
            Self::Candela => &[("cd", 1.0), ("kcd", 1e3)],
            Self::ExposureValue => &[("ev", 1.0), ("EV", 1.0)],
            Self::None => &[],
        };
        known.iter().find(|(name, _)| *name == written).map(|(_, one)| *one)
    }
}

/// The number and the unit of a text that has both; `None` for any other.
fn split(text: &str) -> Option<(f64, &str)> {
    if !text.starts_with(|first: char| first.is_ascii_digit() || "+-.".contains(first)) {
        return None;
    }
    // The longest beginning that is a number.
    let ends = text.char_indices().map(|(end, _)| end).skip(1).collect::<Vec<_>>();
    ends.into_iter().rev().find_map(|end| Some((text[..end].parse().ok()?, text[end..].trim())))
}

/// What to say where a number with a unit was written; `None` if the text is something else. `what` is what is measured.
pub(super) fn unit_error(text: &str, typed: &str, what: &str, unit: Unit) -> Option<SpecError> {
    let (number, written) = split(text)?;
    let meant = match unit.one(written) {
        // Twelve digits, so that 180 divided by pi and multiplied by it again looks like what it is.
        Some(one) => format!("here {}", (number * one * 1e12).round() / 1e12),
        None => format!("such as {number}"),
    };
    Some(SpecError::Unit { typed: typed.into(), what: what.into(), is_in: unit.is_in(), meant })
}

/// A number of an option by itself.
fn option(text: &str, what: &str, unit: Unit) -> Result<f32, SpecError> {
    let failed = || unit_error(text, text, what, unit).unwrap_or_else(|| SpecError::NotANumber(text.into()));
    text.parse().map_err(|_| failed())
}

/// The value of `--bias-constant`.
pub(crate) fn bias_metres(text: &str) -> Result<f32, SpecError> {
    option(text, "the bias", Unit::Metres)
}

/// The value of `--at`.
pub(crate) fn distance(text: &str) -> Result<f32, SpecError> {
    option(text, "the distance", Unit::Metres)
}

/// The value of `--angle`.
pub(crate) fn angle(text: &str) -> Result<f32, SpecError> {
    option(text, "the angle", Unit::Degrees)
}

/// The value of `--exposure`.
pub(crate) fn exposure_value(text: &str) -> Result<f32, SpecError> {
    option(text, "the exposure", Unit::ExposureValue)
}

/// The value of `--time`.
pub(crate) fn seconds(text: &str) -> Result<f64, SpecError> {
    let failed = || unit_error(text, text, "the time", Unit::Seconds).unwrap_or_else(|| SpecError::NotANumber(text.into()));
    text.parse().map_err(|_| failed())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_is_answered_with_what_is_meant() {
        let said = |text, unit| unit_error(text, text, "the bias", unit).map(|error| error.to_string());
        assert_eq!(
            said("1cm", Unit::Metres).unwrap(),
            "`1cm`: write the number without a unit; the bias is in metres, here 0.01"
        );
        assert!(said("-2 km", Unit::Metres).unwrap().ends_with("here -2000"));
        assert!(said("90deg", Unit::Degrees).unwrap().ends_with("is in degrees, here 90"));
        assert!(said("3.141592653589793rad", Unit::Degrees).unwrap().ends_with("here 180"));
        assert!(said("90°", Unit::Degrees).unwrap().ends_with("here 90"));
        assert!(said("1e3lx", Unit::Lux).unwrap().ends_with("here 1000"));
        assert!(said("5furlongs", Unit::Metres).unwrap().ends_with("is in metres, such as 5"));
        assert!(said("1m", Unit::None).unwrap().ends_with("has no unit, such as 1"));
        for no_number in ["", "cm", "inf", "nan", "x1", "-"] {
            assert_eq!(said(no_number, Unit::Metres), None, "{no_number}");
        }
    }

    #[test]
    fn options_are_numbers() {
        assert_eq!(bias_metres("0.5"), Ok(0.5));
        assert_eq!(seconds("1e-3"), Ok(1e-3));
        assert!(exposure_value("nan").is_ok_and(f32::is_nan), "refused later, with the range");
        assert_eq!(seconds("soon"), Err(SpecError::NotANumber("soon".into())));
        assert!(seconds("500ms").unwrap_err().to_string().ends_with("here 0.5"));
    }
}
