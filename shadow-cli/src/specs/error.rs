//! Why a value of the command line cannot be read.

use shadow_math::settings::{MAX_MAP_SIZE, MIN_MAP_SIZE};

use super::{MAX_LIGHT_SAMPLES, MAX_PICTURE_SIZE};

/// Why a value of the command line cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum SpecError {
    /// Not a width and a height.
    #[error("`{0}` is not a size; write width and height in pixels, each from 1 to {MAX_PICTURE_SIZE}, such as 1280x720")]
    Size(String),
    /// A side of a picture beyond the limit.
    #[error(
        "`{size}`: {side} pixels are more than the limit of {MAX_PICTURE_SIZE} on a side, which is what graphics adapters hold; choose a smaller one"
    )]
    SizeTooLarge {
        /// What was typed.
        size: String,
        /// The side that is too large, in pixels.
        side: u64,
    },
    /// Not a size of shadow maps.
    #[error("`{0}` is not a size of shadow maps; write a number of texels from {MIN_MAP_SIZE} to {MAX_MAP_SIZE}, such as 2048")]
    MapSize(String),
    /// Not an amount of memory.
    #[error("`{0}` is not an amount of memory; write a number above 0 with KiB, MiB, GiB or TiB, such as 6GiB, or one of bytes")]
    Memory(String),
    /// A number with a unit, where a number is enough.
    #[error("`{typed}`: write the number without a unit; {what} {is_in}, {meant}")]
    Unit {
        /// What was typed.
        typed: String,
        /// What the number measures.
        what: String,
        /// The unit that it has anyway: "is in metres".
        is_in: &'static str,
        /// The number that was meant, or an example.
        meant: String,
    },
    /// Not a number.
    #[error("`{0}` is not a number")]
    NotANumber(String),
    /// Not a layer.
    #[error(
        "there is no layer `{0}`; there are: color, visibility[:LIGHT], depth, shadow-map[:LIGHT[:VIEW]], and the views mini-screen[:LIGHT[:VIEW]], light-view[:LIGHT[:VIEW]], distance-match[:LIGHT], texels[:LIGHT], bias[:LIGHT], taps[:LIGHT], aliasing[:LIGHT], unshadowed, shadows and cause"
    )]
    Layer(String),
    /// Not the number of a view.
    #[error("`{0}` is not the number of a view; a light's views count from 0")]
    View(String),
    /// Not a kind of light.
    #[error("there is no kind of light `{0}`; there are: directional, spot, point (such as directional:dir=-1,-2,-1;lux=20000)")]
    LightKind(String),
    /// A part without an equals sign.
    #[error("`{part}` is not KEY=VALUE; {what} takes: {}", accepted.join(", "))]
    NotKeyValue {
        /// The part.
        part: String,
        /// What is described.
        what: &'static str,
        /// The keys it takes.
        accepted: &'static [&'static str],
    },
    /// A key that means nothing here.
    #[error("{what} has no `{key}`; it takes: {}", accepted.join(", "))]
    UnknownKey {
        /// What is described.
        what: &'static str,
        /// The key.
        key: String,
        /// The keys it takes.
        accepted: &'static [&'static str],
    },
    /// A key that is given twice.
    #[error("`{key}` is given twice")]
    RepeatedKey {
        /// The key.
        key: String,
    },
    /// A key that must be there.
    #[error("{what} needs `{key}`; it takes: {}", accepted.join(", "))]
    MissingKey {
        /// What is described.
        what: &'static str,
        /// The key.
        key: &'static str,
        /// The keys it takes.
        accepted: &'static [&'static str],
    },
    /// Not a number.
    #[error("`{key}={value}`: `{part}` is not a finite number")]
    Number {
        /// The key.
        key: &'static str,
        /// Its value.
        value: String,
        /// The part that is not a number.
        part: String,
    },
    /// Not three numbers.
    #[error("`{key}={value}` must be three numbers separated by commas, such as {key}=1,2,3")]
    Vector {
        /// The key.
        key: &'static str,
        /// Its value.
        value: String,
    },
    /// Not two backends.
    #[error("`{0}` is not a pair of backends; write exactly two of cpu and gpu, such as cpu,gpu")]
    Backends(String),
    /// Not a list of backends.
    #[error("`{0}` is not a list of backends; write some of cpu, gpu and trace, each at most once, such as cpu,gpu")]
    BackendList(String),
    /// The same backend twice.
    #[error("comparing a backend with itself proves nothing; name two different ones, such as cpu,gpu")]
    SameBackend,
    /// A light that is both a sphere and a rectangle.
    #[error("a light is a sphere of `radius` or a rectangle of `width` and `height`, not both; leave one out")]
    TwoSizes,
    /// The tracer in a comparison of renderers.
    #[error(
        "the tracer follows no plan, so that it cannot be compared layer by layer; `shadow measure` judges shadow maps by it"
    )]
    CompareTrace,
    /// Not a number of samples.
    #[error("`{0}` is not a number of samples; write a square number from 1 to {MAX_LIGHT_SAMPLES}, such as 64")]
    LightSamples(String),
    /// A number of samples that does not fill a square.
    #[error("{given} samples do not fill a square grid; take {below} or {above}")]
    LightSamplesNotSquare {
        /// What was typed.
        given: u32,
        /// The next lower square.
        below: u32,
        /// The next higher one.
        above: u32,
    },
}
