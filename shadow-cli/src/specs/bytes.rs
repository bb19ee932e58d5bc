//! Amounts of memory: as they are typed and as they are said.

use std::str::FromStr;

use super::SpecError;

/// The units that an amount of memory may have, and their bytes.
const UNITS: [(&str, u64); 9] = [
    ("B", 1),
    ("KiB", 1 << 10),
    ("MiB", 1 << 20),
    ("GiB", 1 << 30),
    ("TiB", 1 << 40),
    ("kB", 1_000),
    ("MB", 1_000_000),
    ("GB", 1_000_000_000),
    ("TB", 1_000_000_000_000),
];

/// An amount of memory in bytes, at least 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ByteSize(pub(crate) u64);

impl FromStr for ByteSize {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let failed = || SpecError::Memory(text.into());
        let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
        let unit = &text[digits.len()..];
        // Units of memory are commonly typed without regard to case, and no two of these differ in it alone.
        let (_, factor) = UNITS
            .iter()
            .find(|(name, _)| name.eq_ignore_ascii_case(unit))
            .or(unit.is_empty().then_some(&UNITS[0]))
            .ok_or_else(failed)?;
        let digits = digits.trim();
        let bytes = match digits.parse::<u64>() {
            Ok(whole) => whole.checked_mul(*factor).ok_or_else(failed)?,
            Err(_) => {
                let number: f64 = digits.parse().map_err(|_| failed())?;
                let bytes = number * *factor as f64;
                // 2^63: well below the largest u64, beyond which a conversion would not be exact.
                if !(bytes < 9.2e18) {
                    return Err(failed());
                }
                bytes as u64
            }
        };
        if bytes == 0 { Err(failed()) } else { Ok(Self(bytes)) }
    }
}

/// An amount of memory for people: three digits or so, in the largest unit that it fills.
pub(crate) fn bytes_text(bytes: u64) -> String {
    let units = [("GiB", 1_u64 << 30), ("MiB", 1 << 20), ("KiB", 1 << 10)];
    match units.iter().find(|(_, unit)| bytes >= *unit) {
        Some((name, unit)) => {
            let amount = bytes as f64 / *unit as f64;
            if amount < 10.0 { format!("{amount:.2} {name}") } else { format!("{amount:.1} {name}") }
        }
        None => format!("{bytes} bytes"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_have_units_or_are_bytes() {
        for (text, bytes) in [
            ("6GiB", 6 << 30),
            ("512MiB", 512 << 20),
            ("1.5 gib", 3 << 29),
            ("2GB", 2_000_000_000),
            ("4096", 4096),
            ("7B", 7),
            ("18446744073709551615", u64::MAX),
        ] {
            assert_eq!(text.parse(), Ok(ByteSize(bytes)), "{text}");
        }
        for bad in ["", "6G", "GiB", "0", "-1GiB", "1e30GiB", "99999999999TiB", "nan", "infGiB", "0.1"] {
            assert_eq!(bad.parse::<ByteSize>(), Err(SpecError::Memory(bad.into())), "{bad}");
        }
    }

    #[test]
    fn amounts_are_said_in_the_largest_unit() {
        assert_eq!(bytes_text(3 << 29), "1.50 GiB");
        assert_eq!(bytes_text(512 << 20), "512.0 MiB");
        assert_eq!(bytes_text(2048), "2.00 KiB");
        assert_eq!(bytes_text(5), "5 bytes");
    }
}
