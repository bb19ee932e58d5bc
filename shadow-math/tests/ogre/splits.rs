//! Where OGRE's PSSM splits the camera's view.

use shadow_math::splits::practical_splits;

use crate::data::{cases, file};

/// Rounding of single precision: OGRE adds up a power and a product, each of a few roundings of 2^-24.
const ROUNDING: f64 = 1e-6;

/// `calculateSplitPoints` is the practical split scheme.
#[test]
fn splits_are_those_of_the_practical_scheme() {
    assert_eq!(file().split_tables.len(), 9);
    for table in &file().split_tables {
        let mut splits = vec![0.0; table.split_count + 1];
        practical_splits(f64::from(table.near), f64::from(table.far), f64::from(table.lambda), &mut splits);
        assert_eq!(splits.len(), table.points.len());
        for (ours, ogre) in splits.iter().zip(&table.points) {
            assert!((ours / f64::from(*ogre) - 1.0).abs() < ROUNDING, "{ours} against {ogre} of {table:?}");
        }
    }
}

/// A cascade reaches beyond its ends by the padding, but not before the first one and not beyond the last.
#[test]
fn cascades_reach_beyond_their_splits_by_the_padding() {
    for case in cases(13, |case| case.setup == "pssm") {
        let params = &case.params;
        let points = params.split_points.as_ref().expect("cascades have splits");
        let (count, cascade) = (points.len() - 1, params.iteration.expect("each case is a cascade"));
        let number = |given: Option<f32>| f64::from(given.expect("cascades have it"));
        let splits: Vec<f64> = if params.manual_splits == Some(true) {
            points.iter().copied().map(f64::from).collect()
        } else {
            let mut splits = vec![0.0; count + 1];
            practical_splits(number(params.split_near), number(params.split_far), number(params.lambda), &mut splits);
            splits
        };
        let padding = number(params.split_padding);
        let near = if cascade == 0 { splits[0] } else { splits[cascade] - padding };
        let far = if cascade + 1 == count { splits[count] } else { splits[cascade + 1] + padding };
        for (ours, ogre) in [near, far].into_iter().zip(case.planes()) {
            assert!((ours / ogre - 1.0).abs() < ROUNDING, "{}: {ours} against {ogre}", case.id);
        }
        let of_case = [case.intermediate.split_near_padded, case.intermediate.split_far_padded];
        assert!(of_case.iter().all(Option::is_some), "{}", case.id);
    }
}
