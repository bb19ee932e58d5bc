//! One of several things, chosen by its number or its name.

use crate::error::CliError;

/// One of several things, by its number from 0 or by its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Selector {
    /// By its number from 0.
    Index(usize),
    /// By its name.
    Name(String),
}

impl Selector {
    /// A number is an index, anything else a name.
    pub(super) fn new(text: &str) -> Self {
        text.parse().map_or_else(|_| Self::Name(text.into()), Self::Index)
    }

    /// The indices of all things that are meant among those of these names: of a name all that have it.
    pub(crate) fn find_all(&self, kind: &'static str, names: &[String]) -> Result<Vec<usize>, CliError> {
        let first = self.find(kind, names)?;
        Ok(match self {
            Self::Index(_) => vec![first],
            Self::Name(wanted) => (0..names.len()).filter(|&index| names[index] == *wanted).collect(),
        })
    }

    /// The index of the thing among those of these names. A name that several have is the first's.
    pub(crate) fn find(&self, kind: &'static str, names: &[String]) -> Result<usize, CliError> {
        let (found, asked) = match self {
            Self::Index(index) => (Some(*index).filter(|index| *index < names.len()), index.to_string()),
            Self::Name(wanted) => (names.iter().position(|name| name == wanted), format!("`{wanted}`")),
        };
        found.ok_or_else(|| CliError::NoSuch { kind, asked, names: names.to_vec() })
    }
}

impl std::fmt::Display for Selector {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Index(index) => index.fmt(f),
            Self::Name(name) => write!(f, "`{name}`"),
        }
    }
}

impl From<&str> for Selector {
    fn from(text: &str) -> Self {
        Self::new(text)
    }
}

/// How many things there are, and their names: the end of a sentence.
pub(crate) fn inventory(kind: &str, names: &[String]) -> String {
    /// Beyond this many names the sentence would be a page.
    const MAX_NAMES: usize = 20;
    let listed: Vec<String> = names
        .iter()
        .take(MAX_NAMES)
        .enumerate()
        .map(|(index, name)| if name.is_empty() { index.to_string() } else { format!("{index} (`{name}`)") })
        .collect();
    let more = if names.len() > MAX_NAMES { ", ..." } else { "" };
    match names.len() {
        0 => format!("there is no {kind} at all"),
        1 => format!("there is 1 {kind}: {}", listed.join(", ")),
        count => format!("there are {count} {kind}s: {}{more}", listed.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn selecting_says_what_there_is() {
        let names = ["sun", "", "lamp"].map(String::from);
        assert_eq!(Selector::Index(2).find("light", &names).unwrap(), 2);
        assert_eq!(Selector::Name("lamp".into()).find("light", &names).unwrap(), 2);
        let error = Selector::Index(3).find("light", &names).unwrap_err().to_string();
        assert_eq!(error, "there is no light 3; there are 3 lights: 0 (`sun`), 1, 2 (`lamp`)");
        let error = Selector::Name("moon".into()).find("light", &names[..1]).unwrap_err().to_string();
        assert_eq!(error, "there is no light `moon`; there is 1 light: 0 (`sun`)");
    }
}
