//! The names of the filters on the command line, with what each is.

use clap::{ValueEnum, builder::PossibleValue};
use shadow_math::Filter;

/// A filter by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FilterName(pub(crate) Filter);

/// Several filters, each once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FilterList(pub(crate) Vec<Filter>);

impl std::str::FromStr for FilterList {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "all" {
            return Ok(Self(Filter::ALL.to_vec()));
        }
        let mut filters = Vec::new();
        for name in text.split(',') {
            let Some(filter) = Filter::ALL.into_iter().find(|filter| filter.name() == name) else {
                let names = Filter::ALL.map(Filter::name).join(", ");
                return Err(format!("`{name}` is not a filter; write `all`, or some of {names}, with commas and without spaces"));
            };
            if filters.contains(&filter) {
                return Err(format!("`{name}` is named twice; name each filter once"));
            }
            filters.push(filter);
        }
        Ok(Self(filters))
    }
}

/// All of them.
const VARIANTS: [FilterName; Filter::ALL.len()] = {
    let mut variants = [FilterName(Filter::Hard); Filter::ALL.len()];
    let mut index = 0;
    while index < variants.len() {
        variants[index] = FilterName(Filter::ALL[index]);
        index += 1;
    }
    variants
};

impl ValueEnum for FilterName {
    fn value_variants<'a>() -> &'a [Self] {
        &VARIANTS
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let what = match self.0 {
            Filter::Hard => "One test, of the texel that the point falls into",
            Filter::Bilinear => "Four tests, weighted by the distance to the texels' centres",
            Filter::Cross5 => "The texel and its four neighbours, alike",
            Filter::Box3 => "The mean over a square of 3 texels, with bilinear edges",
            Filter::Box4 => "The same over 4",
            Filter::Box5 => "The same over 5",
            Filter::Box6 => "The same over 6",
            Filter::Box7 => "The same over 7",
            Filter::Box8 => "The same over 8",
            Filter::Box9 => "The same over 9",
            Filter::Gaussian => "A bell curve out to --filter-radius, with bilinear edges",
            Filter::Witness3 => "The witness kernel 1 2 1, with bilinear edges",
            Filter::Witness5 => "The witness kernel 1 3 4 3 1",
            Filter::Witness7 => "The witness kernel 1 5 12 16 12 5 1",
            Filter::Poisson => {
                "Sixteen tests in a disc of --filter-radius, at places that keep apart, turned from pixel to pixel"
            }
            Filter::Vogel => "The same along a sunflower's spiral",
            Filter::Footprint => "Tests all over the pixel's own image in the map",
            // A filter without a sentence of its own still has its name.
            _ => "",
        };
        Some(PossibleValue::new(self.0.name()).help(what))
    }
}
