//! The memory that an import may take: every large reservation is claimed here before it is made.

use core::{cell::Cell, fmt::Display};

use super::error::{ImportError, Result};

/// What memory is taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// The file itself, its buffers, and what is decompressed from them.
    Buffers,
    /// Vertices, indices and instances.
    Meshes,
    /// Texels.
    Textures,
}

impl Use {
    fn name(self) -> &'static str {
        match self {
            Self::Buffers => "buffers",
            Self::Meshes => "meshes",
            Self::Textures => "textures",
        }
    }

    /// What to do other than to raise the limit.
    fn advice(self) -> &'static str {
        match self {
            Self::Buffers | Self::Meshes => "export a part of the scene",
            Self::Textures => "scale the images down",
        }
    }
}

/// What an import has claimed so far, and the limit.
#[derive(Debug)]
pub(super) struct Budget {
    file: String,
    limit: u64,
    claimed: Cell<u64>,
}

impl Budget {
    /// A budget of `limit` bytes for the file that messages call `file`.
    pub(super) fn new(file: &str, limit: u64) -> Self {
        Self { file: file.into(), limit, claimed: Cell::new(0) }
    }

    /// Claims memory before it is reserved. `place` is the JSON path of what needs it, or empty for the file itself.
    pub(super) fn claim(&self, what: Use, bytes: u64, place: impl Display) -> Result<()> {
        let needed = self.claimed.get().saturating_add(bytes);
        if needed > self.limit {
            let place = place.to_string();
            return Err(ImportError::Memory {
                file: self.file.clone(),
                place: if place.is_empty() { place } else { format!("{place}: ") },
                what: what.name(),
                needed,
                limit: self.limit,
                advice: what.advice(),
            });
        }
        self.claimed.set(needed);
        Ok(())
    }

    /// Gives back what was claimed for a step that is over.
    pub(super) fn release(&self, bytes: u64) {
        self.claimed.set(self.claimed.get().saturating_sub(bytes));
    }

    /// How many bytes can still be claimed.
    pub(super) fn left(&self) -> u64 {
        self.limit.saturating_sub(self.claimed.get())
    }
}
