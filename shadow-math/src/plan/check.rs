//! Which settings have a meaning, whatever the light and the scene.

use super::error::PlanError;
use crate::settings::{
    Bias, BiasParts, Cascades, Fit, MAX_CASCADES, MAX_MAP_SIZE, MIN_MAP_SIZE, Ogre2006, SUBPIXEL_BITS, ShadowSettings, Split,
    SplitScheme, Store,
};

/// Whether numbers are in their ranges, and fit, split, store and bias go together. The numbers of the bias and of the filter are looked at where a light is planned.
///
/// # Errors
///
/// The first [`PlanError`] that is found: of sizes, distances, the plane, cascades, and of what has no meaning together.
///
/// ```
/// use shadow_math::{Fit, PlanError, ShadowSettings, Store, plan::check_settings};
///
/// let settings = ShadowSettings { fit: Fit::Lispsm, store: Store::Linear, ..ShadowSettings::default() };
/// assert_eq!(check_settings(&settings), Err(PlanError::StoreOfFit { fit: Fit::Lispsm, store: Store::Linear }));
/// ```
pub fn check_settings(settings: &ShadowSettings) -> Result<(), PlanError> {
    let size = settings.map_size;
    if !(MIN_MAP_SIZE..=MAX_MAP_SIZE).contains(&size) {
        return Err(PlanError::MapSize(size));
    }
    if !SUBPIXEL_BITS.contains(&settings.subpixel_bits) {
        return Err(PlanError::SubpixelBits(settings.subpixel_bits));
    }
    check_store(settings)?;
    if let Some(metres) = settings.shadow_distance
        && !(metres.is_finite() && metres > 0.0)
    {
        return Err(PlanError::ShadowDistance(metres));
    }
    if let Some(plane) = settings.plane {
        let has_normal = plane[..3].iter().any(|&number| number != 0.0);
        if !(plane.iter().all(|number| number.is_finite()) && has_normal) {
            return Err(PlanError::Plane(plane));
        }
    }
    // The settings' own, and those of single cascades.
    let mut fits = [None; 1 + MAX_CASCADES];
    fits[0] = Some(settings.fit);
    if let Split::Cascades(cascades) = settings.split {
        check_cascades(&cascades, size)?;
        let count = cascades.count as usize;
        // Those beyond the last cascade are nobody's.
        fits[1..=count].copy_from_slice(&cascades.fits[..count]);
        if cascades.stabilised
            && let Some(fit) = fits.into_iter().flatten().find(|fit| *fit != Fit::Uniform)
        {
            return Err(PlanError::StabilisedFit(fit));
        }
        if cascades.stabilised && cascades.scheme == SplitScheme::Histogram {
            return Err(PlanError::StabilisedHistogram);
        }
        if let Some(fit) = fits.into_iter().flatten().find(|fit| fit.makes_one_map()) {
            return Err(PlanError::FitOfCascades(fit));
        }
    }
    if settings.split == Split::Cube && settings.fit.makes_one_map() {
        return Err(PlanError::FitOfCube(settings.fit));
    }
    for fit in fits.into_iter().flatten().filter(|fit| fit.is_warped()) {
        let store = settings.store;
        let is_coarse = fit == Fit::PlaneOptimal && store == Store::Depth16;
        if store == Store::Linear || is_coarse {
            return Err(PlanError::StoreOfFit { fit, store });
        }
        if let Bias::Parts(BiasParts { ogre_2006: Some(ogre), .. }) = settings.bias {
            return Err(PlanError::BiasOfFit { fit, bias: name_of(ogre) });
        }
    }
    Ok(())
}

/// The name of the article's caster shader, of its text or as it was published.
fn name_of(ogre: Ogre2006) -> &'static str {
    if ogre.is_corrected { "ogre-2006-corrected" } else { "ogre-2006" }
}

/// Whether the numbers of cascades are in their ranges; `most` is the size of the settings' maps in texels.
fn check_cascades(cascades: &Cascades, most: u32) -> Result<(), PlanError> {
    let count = cascades.count as usize;
    if !(1..=MAX_CASCADES).contains(&count) {
        return Err(PlanError::CascadeCount(cascades.count));
    }
    if !(cascades.padding.is_finite() && cascades.padding >= 0.0) {
        return Err(PlanError::Padding(cascades.padding));
    }
    if !(0.0..=1.0).contains(&cascades.blend) {
        return Err(PlanError::Blend(cascades.blend));
    }
    if let Some(&factor) = cascades.lispsm_factors.iter().find(|factor| !(factor.is_finite() && **factor >= 0.0)) {
        return Err(PlanError::LispsmFactor(factor));
    }
    match cascades.scheme {
        SplitScheme::Practical(lambda) if !(0.0..=1.0).contains(&lambda) => return Err(PlanError::Lambda(lambda)),
        SplitScheme::Explicit(ends) => {
            let mut before = 0.0;
            for &metres in &ends[..count - 1] {
                if !(metres.is_finite() && metres > before) {
                    return Err(PlanError::SplitDistance(metres));
                }
                before = metres;
            }
        }
        _ => {}
    }
    for size in cascades.map_sizes[..count].iter().map(|size| size.unwrap_or(most)) {
        if !(MIN_MAP_SIZE..=most).contains(&size) {
            return Err(PlanError::CascadeMapSize { size, most });
        }
        if cascades.stabilised && !size.is_power_of_two() {
            return Err(PlanError::StabilisedMapSize(size));
        }
    }
    Ok(())
}

/// Whether what is stored goes together with the bias and with pancaking.
fn check_store(settings: &ShadowSettings) -> Result<(), PlanError> {
    let ShadowSettings { store, bias, pancake, .. } = *settings;
    let is_of_two = matches!(store, Store::Second | Store::Midpoint);
    if pancake && is_of_two {
        return Err(PlanError::PancakeOfTwo(store));
    }
    let Bias::Parts(parts) = bias else { return Ok(()) };
    let (is_linear, is_reversed) = (store == Store::Linear, store == Store::Reversed32);
    let refused = [
        (parts.polygon_offset.is_some() && (is_linear || is_of_two), "polygon-offset"),
        (parts.ogre_2006.is_some() && (is_linear || is_of_two || is_reversed), parts.ogre_2006.map_or("", name_of)),
        (parts.receiver_plane.is_some() && is_linear, "receiver-plane"),
        (parts.receiver_gradient.is_some() && is_reversed, "receiver-gradient"),
    ];
    match refused.into_iter().find(|(is_refused, _)| *is_refused) {
        Some((_, bias)) => Err(PlanError::BiasOfOtherStores { bias, store }),
        None => Ok(()),
    }
}
