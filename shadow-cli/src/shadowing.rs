//! How the lights of a scene are shadowed: all alike, or by their kind as a preset has it.

use shadow_math::{Camera, Filter, LightKind, ShadowSettings};
use shadow_scene::{FramePlan, Scene};

use crate::{
    error::CliError,
    feedback::feedback,
    presets::{Engine, Kind},
};

/// Settings for each kind of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shadowing {
    /// By the kinds' order. All have the same map size, since the maps of a frame lie in one array.
    kinds: [ShadowSettings; 3],
    /// Whose defaults they are, if they are an engine's.
    preset: Option<Engine>,
}

impl Shadowing {
    /// The same for every light.
    pub(crate) fn alike(settings: ShadowSettings) -> Self {
        Self { kinds: [settings; 3], preset: None }
    }

    /// An engine's defaults, with maps as large as its largest among the kinds of light that the scene has.
    pub(crate) fn preset(engine: Engine, scene: &Scene) -> Self {
        let kinds = Kind::ALL.map(|kind| engine.settings(kind));
        let sizes = kinds_of(scene).into_iter().map(|kind| kind.pick(kinds).map_size);
        // A scene always has a light; were there none, no map would be drawn.
        let map_size = sizes.max().unwrap_or(kinds[0].map_size);
        Self { kinds: kinds.map(|settings| ShadowSettings { map_size, ..settings }), preset: Some(engine) }
    }

    /// The same with another filter, as large as it is by itself.
    pub(crate) fn with_filter(self, filter: Filter) -> Self {
        Self { kinds: self.kinds.map(|settings| ShadowSettings { filter, filter_radius: None, ..settings }), ..self }
    }

    /// The same with each kind's settings changed.
    pub(crate) fn with<E>(self, change: impl Fn(ShadowSettings) -> Result<ShadowSettings, E>) -> Result<Self, E> {
        let [a, b, c] = self.kinds;
        Ok(Self { kinds: [change(a)?, change(b)?, change(c)?], ..self })
    }

    /// The same for rasterisers whose sub-pixel grids have at least so many bits.
    pub(crate) fn on_grid(self, subpixel_bits: u32) -> Self {
        Self { kinds: self.kinds.map(|settings| ShadowSettings { subpixel_bits, ..settings }), ..self }
    }

    /// Width and height of every map in texels.
    pub(crate) fn map_size(&self) -> u32 {
        self.kinds[0].map_size
    }

    /// Bits of the sub-pixel grid that it is for.
    pub(crate) fn subpixel_bits(&self) -> u32 {
        self.kinds[0].subpixel_bits
    }

    /// How a light of this kind is shadowed.
    pub(crate) fn of(&self, light: &LightKind) -> ShadowSettings {
        Kind::of(light).pick(self.kinds)
    }

    /// How the first light of a scene is shadowed.
    pub(crate) fn of_first(&self, scene: &Scene) -> ShadowSettings {
        scene.lights().first().map_or(self.kinds[0], |light| self.of(&light.light.kind))
    }

    /// The settings of the kinds of light that a scene has, each kind with its name; one without a name where all are alike.
    pub(crate) fn by_kind(&self, scene: &Scene) -> Vec<(&'static str, ShadowSettings)> {
        let kinds = kinds_of(scene);
        match (self.preset, &kinds[..]) {
            (None, _) | (_, []) => vec![("", self.kinds[0])],
            (Some(_), &[kind]) => vec![("", kind.pick(self.kinds))],
            (Some(_), _) => kinds.into_iter().map(|kind| (kind.name(), kind.pick(self.kinds))).collect(),
        }
    }

    /// The plan of a picture of a scene.
    pub(crate) fn plan(&self, scene: &Scene, camera: &Camera, size: (u32, u32), ev: Option<f32>) -> Result<FramePlan, CliError> {
        let feedback = feedback(scene, camera, &self.kinds, size, None)?;
        Ok(FramePlan::with_feedback(scene, camera, self.map_size(), |_, light| self.of(&light.light.kind), size, ev, &feedback)?)
    }

    /// What of a preset is not as in the engine, for the kinds of light that the scene has.
    pub(crate) fn notes(&self, scene: &Scene) -> Vec<String> {
        let Some(engine) = self.preset else { return Vec::new() };
        let kinds = kinds_of(scene);
        let mut notes: Vec<String> = kinds
            .iter()
            .map(|&kind| format!("preset {}, {} lights: {}", engine.name(), kind.name(), engine.differences(kind).join("; ")))
            .collect();
        let sizes: Vec<(Kind, u32)> = kinds.iter().map(|&kind| (kind, engine.settings(kind).map_size)).collect();
        if sizes.iter().any(|(_, size)| *size != self.kinds[0].map_size) {
            let sizes: Vec<String> = sizes.iter().map(|(kind, size)| format!("{} {size}", kind.name())).collect();
            notes.push(format!(
                "preset {}: all maps of a picture are as large as the largest, {} texels, where the engine has {}",
                engine.name(),
                self.kinds[0].map_size,
                sizes.join(", ")
            ));
        }
        notes
    }
}

/// The kinds of light that a scene has, each once.
fn kinds_of(scene: &Scene) -> Vec<Kind> {
    let has = |kind: &Kind| scene.lights().iter().any(|light| Kind::of(&light.light.kind) == *kind);
    Kind::ALL.into_iter().filter(has).collect()
}
