//! Descriptions such as `eye=1,2,3;fov=40`: keys and values, with errors that name the key and those that there are.

use glam::DVec3;

use super::{
    SpecError,
    units::{Unit, unit_error},
};

/// The values of a description such as `eye=1,2,3;fov=40`, by their keys.
pub(super) struct Pairs<'a> {
    what: &'static str,
    accepted: &'static [&'static str],
    pairs: Vec<(&'a str, &'a str)>,
}

impl<'a> Pairs<'a> {
    /// Splits a description of `what`, which takes these keys and no others. Empty parts are skipped, so that it may end in `;`.
    pub(super) fn parse(text: &'a str, what: &'static str, accepted: &'static [&'static str]) -> Result<Self, SpecError> {
        let mut pairs: Vec<(&str, &str)> = Vec::new();
        for part in text.split(';').map(str::trim).filter(|part| !part.is_empty()) {
            let (key, value) =
                part.split_once('=').ok_or_else(|| SpecError::NotKeyValue { part: part.into(), what, accepted })?;
            let (key, value) = (key.trim(), value.trim());
            if !accepted.contains(&key) {
                return Err(SpecError::UnknownKey { what, key: key.into(), accepted });
            }
            if pairs.iter().any(|(before, _)| *before == key) {
                return Err(SpecError::RepeatedKey { key: key.into() });
            }
            pairs.push((key, value));
        }
        Ok(Self { what, accepted, pairs })
    }

    fn get(&self, key: &str) -> Option<&'a str> {
        self.pairs.iter().find(|(name, _)| *name == key).map(|(_, value)| *value)
    }

    fn missing(&self, key: &'static str) -> SpecError {
        SpecError::MissingKey { what: self.what, key, accepted: self.accepted }
    }

    /// The text of a key, if it is given.
    pub(super) fn optional_text(&self, key: &'static str) -> Option<&'a str> {
        self.get(key)
    }

    /// The number of a key, if it is given.
    pub(super) fn optional_number(&self, key: &'static str) -> Result<Option<f64>, SpecError> {
        self.get(key).map(|value| number(key, value, value)).transpose()
    }

    /// The number of a key that must be there.
    pub(super) fn number(&self, key: &'static str) -> Result<f64, SpecError> {
        self.optional_number(key)?.ok_or_else(|| self.missing(key))
    }

    /// The three numbers of a key, if it is given.
    pub(super) fn optional_vector(&self, key: &'static str) -> Result<Option<DVec3>, SpecError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let numbers = value.split(',').map(|part| number(key, value, part.trim())).collect::<Result<Vec<f64>, _>>();
        match numbers?[..] {
            [x, y, z] => Ok(Some(DVec3::new(x, y, z))),
            _ => Err(SpecError::Vector { key, value: value.into() }),
        }
    }

    /// The three numbers of a key that must be there.
    pub(super) fn vector(&self, key: &'static str) -> Result<DVec3, SpecError> {
        self.optional_vector(key)?.ok_or_else(|| self.missing(key))
    }
}

/// A finite number.
fn number(key: &'static str, value: &str, part: &str) -> Result<f64, SpecError> {
    let failed = || {
        let not_finite = || SpecError::Number { key, value: value.into(), part: part.into() };
        unit_error(part, &format!("{key}={value}"), key, Unit::of_key(key)).unwrap_or_else(not_finite)
    };
    part.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(failed)
}
