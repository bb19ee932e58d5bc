//! Lights to put scenes under.

use glam::Vec3;
use shadow_math::{Light, LightKind};
use shadow_scene::{Scene, SceneLight};

/// One light of each kind for a scene, placed by its bounds.
#[must_use]
pub fn one_of_each(scene: &Scene) -> [(&'static str, Light); 3] {
    let bounds = scene.bounds();
    let (center, radius) = (bounds.center(), bounds.radius().max(1e-3));
    let intensity = 1000.0 * radius * radius;
    let above = center + Vec3::new(0.35, 0.9, 0.5) * radius;
    let spot = LightKind::Spot { position: above, direction: center - above, inner: 0.4, outer: 0.6, range: None };
    let point = LightKind::Point { position: center + Vec3::new(0.1, 0.45, 0.2) * radius, range: Some(4.0 * radius) };
    [
        (
            "directional",
            Light { kind: LightKind::Directional { direction: Vec3::new(-0.4, -1.0, 0.3) }, color: Vec3::ONE, intensity: 1e4 },
        ),
        ("spot", Light { kind: spot, color: Vec3::new(1.0, 0.8, 0.6), intensity }),
        ("point", Light { kind: point, color: Vec3::new(0.7, 0.8, 1.0), intensity }),
    ]
}

/// A scene under one light alone.
#[must_use]
pub fn lit_by(scene: &Scene, name: &str, light: Light) -> Scene {
    scene.clone().with_lights(vec![SceneLight::new(name, light)])
}
