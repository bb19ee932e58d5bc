//! Conversions against numbers that were computed by hand, and there and back.

use super::*;

/// Parallel rays over 20 m, half-way, at 45 degrees, with texels of a centimetre.
const PARALLEL: Place = Place {
    kind: Kind::Directional,
    is_perspective: false,
    map_size: 1000,
    texel: 0.01,
    near: 0.0,
    far: 20.0,
    at: 10.0,
    angle: std::f64::consts::FRAC_PI_4,
};

/// A cone from 1 m to 100 m, at 10 m.
const CONE: Place = Place { kind: Kind::Spot, is_perspective: true, near: 1.0, far: 100.0, ..PARALLEL };

fn system(name: &str) -> System {
    name.parse().expect(name)
}

fn converted(given: &str, to: &str, place: &Place) -> Conversion {
    convert(&given.parse().expect(given), system(to), place).expect(given)
}

/// What a parameter of the target is.
fn number(given: &str, to: &str, name: &str, place: &Place) -> f64 {
    let conversion = converted(given, to, place);
    let found = conversion.to.iter().find(|(parameter, _)| *parameter == name);
    found.and_then(|(_, number)| *number).unwrap_or(f64::NAN)
}

#[test]
fn numbers_are_those_of_a_hand() {
    for (given, to, name, place, expected) in [
        // 2 cm of 20 m.
        ("bevy:depth=0.02", "three", "bias", &PARALLEL, -0.001),
        // 1.8 diagonals of a centimetre.
        ("bevy:normal=1.8", "three", "normalBias", &PARALLEL, 0.025_455_844),
        // Half a texel times the sine of 45 degrees is a quarter of the diagonal.
        ("filament:normalBias=1", "bevy", "normal", &PARALLEL, 0.25),
        ("filament:polygonOffsetSlope=2", "ogre-13", "slope", &PARALLEL, 2.0),
        // A 20,000th of 20 m is a millimetre, which is a tenth in hundredths of a metre.
        ("babylon:bias=0.00005", "godot", "bias", &PARALLEL, 0.1),
        ("mjp:bias=0.005", "metres", "constant", &PARALLEL, 0.1),
        // 2 / 1000 times one minus the cosine.
        ("mjp:offsetScale=1", "metres", "normal", &PARALLEL, 0.000_585_786_437_6),
        // Half of the range times 0.0005 / 1.0005.
        ("ogre-1.12:fixed=0.0005", "metres", "constant", &PARALLEL, 0.004_997_501_249),
        ("ogre-13:constant=0.5", "metres", "constant", &PARALLEL, 0.000_152_590_219),
        ("ogre-2006:units=1", "bevy", "depth", &PARALLEL, 1.0),
        // 2 texels times (1 - cos) sin².
        ("godot:normal_bias=2", "metres", "normal", &PARALLEL, 0.002_928_932_188),
        // B = 100 / 99: 0.001 100 / (B + 0.01), and B 0.02 / (10 * 9.98).
        ("three:bias=-0.001", "metres", "constant", &CONE, 0.098_029_507_9),
        ("bevy:depth=0.02", "three", "bias", &CONE, -0.000_202_425_052),
        // A whole texel of a spot light.
        ("filament:normalBias=1", "metres", "normal", &CONE, 0.007_071_067_8),
        // A hundredth over the distance is a depth of 0.001: as above.
        ("godot:bias=1", "metres", "constant", &CONE, 0.098_029_507_9),
        // 10 / 1000 times 10 m times one minus the cosine.
        ("godot:normal_bias=1", "metres", "normal", &CONE, 0.029_289_321_88),
        ("babylon:bias=0.001", "metres", "constant", &CONE, 0.099),
        // m (1 - m / 10) of 0.1 m.
        ("metres:constant=0.1", "ogre-2006", "units", &CONE, 0.099),
        ("metres:slope=3", "filament", "polygonOffsetSlope", &CONE, 3.0),
    ] {
        let found = number(given, to, name, place);
        assert!((found - expected).abs() <= 1e-8 * expected.abs(), "{given} to {to}: {name} = {found}, not {expected}");
    }
    // A depth of three texels' fall, B 0.03 / 100, is 0.03 / (1 + 0.03 / 10) m before the surface.
    let slope = converted("ogre-13:slope=3", "metres", &CONE).components[2].metres;
    assert!((slope - 0.029_910_269_19).abs() < 1e-11, "{slope}");
    let around = Place { kind: Kind::Point, ..CONE };
    assert!((number("babylon:bias=0.001", "metres", "constant", &around) - 0.101).abs() < 1e-12);
    assert!((number("three:bias=-0.001", "metres", "constant", &around) - 0.099).abs() < 1e-12);
    assert!((number("godot:bias=0.1", "metres", "constant", &around) - 0.1).abs() < 1e-12);
}

/// Every parameter of every engine into every other that has one for the same, and back, at many places.
#[test]
fn there_and_back_is_where_it_was() {
    let systems: Vec<System> = [System::Metres].into_iter().chain(Engine::ALL.map(System::Engine)).collect();
    let mut count = 0;
    for kind in Kind::ALL {
        let base = Place { kind, is_perspective: kind != Kind::Directional, ..CONE };
        let places = [(1.5, 0.1), (10.0, 0.8), (99.0, 1.5)].map(|(at, angle)| Place { at, angle, texel: 0.001 * at, ..base });
        for (from, to) in systems.iter().flat_map(|from| systems.iter().map(move |to| (*from, *to))) {
            for (index, parameter) in from.parameters().iter().enumerate() {
                for (place, size) in places.iter().flat_map(|place| [1e-4, 3e-3].map(|size| (place, size))) {
                    let there = to.parameters().iter().any(|other| other.component == parameter.component);
                    // Of two parameters for the same the second is not set.
                    let is_set = from.parameters().iter().position(|other| other.component == parameter.component) == Some(index);
                    if !there || !is_set {
                        continue;
                    }
                    let mut values = vec![0.0; from.parameters().len()];
                    values[index] = if parameter.is_negative { -size } else { size };
                    let given = GivenBias { system: from, values: Some(values) };
                    let conversion = convert(&given, to, place).expect("so small a bias is a length");
                    let problem = conversion.components.iter().find(|other| other.component == parameter.component);
                    if problem.is_some_and(|component| component.problem.is_some()) {
                        // Shares of depth run out close to the light.
                        assert!(place.at < 2.0, "{given:?} to {to:?} at {place:?}: {problem:?}");
                        continue;
                    }
                    let values = conversion.to.iter().map(|(_, number)| number.unwrap_or_default()).collect();
                    let back = convert(&GivenBias { system: to, values: Some(values) }, from, place).expect("it came from there");
                    let found = back.to[index].1.unwrap_or(f64::NAN).abs();
                    assert!((found - size).abs() <= 1e-9 * size, "{given:?} to {to:?} at {place:?}: {found}");
                    count += 1;
                }
            }
        }
    }
    assert!(count > 1000, "only {count} were tried");
}

#[test]
fn what_a_target_has_no_parameter_for_is_said() {
    let problem = |given: &str, to: &str, component: Component, place: &Place| {
        let conversion = converted(given, to, place);
        conversion.components.into_iter().find(|other| other.component == component).and_then(|other| other.problem)
    };
    let said = |given: &str, to: &str, component: Component| problem(given, to, component, &PARALLEL).unwrap_or_default();
    assert!(said("filament", "bevy", Component::Slope).contains("bevy has no parameter"));
    assert!(said("bevy", "ogre-1.12", Component::Normal).contains("ogre-1.12 has no parameter"));
    assert!(said("metres:slope=1", "ogre-2006", Component::Slope).contains("always adds 0.0025 m"));
    assert!(said("ogre-2006", "three", Component::Slope).contains("three has no parameter"));
    assert_eq!(said("metres:slope=0.25", "ogre-2006", Component::Slope), "");
    assert_eq!(said("bevy", "three", Component::Slope), "", "there is nothing to drop");
    let facing = Place { angle: 0.0, ..PARALLEL };
    assert!(
        problem("bevy", "filament", Component::Normal, &facing)
            .is_some_and(|problem| problem.contains("normalBias: at this angle"))
    );
    assert!(
        problem("metres:constant=11", "mjp", Component::Constant, &CONE)
            .is_some_and(|problem| problem.contains("back to the light"))
    );
    assert!(
        problem("metres:constant=6", "ogre-2006", Component::Constant, &CONE).is_some_and(|problem| problem.contains("half"))
    );
    assert!(
        problem("metres:constant=9.5", "ogre-1.12", Component::Constant, &CONE)
            .is_some_and(|problem| problem.contains("near plane"))
    );
    let far = convert(&"ogre-2006:units=3".parse().expect("it is a number"), System::Metres, &CONE);
    assert!(far.is_err_and(|problem| problem.contains("units=3") && problem.contains("2.5 m")));
}

#[test]
fn an_engine_by_itself_has_its_defaults() {
    let point = Place { kind: Kind::Point, ..CONE };
    assert_eq!(converted("bevy", "metres", &PARALLEL).from, [("depth", 0.02), ("normal", 1.8)]);
    assert_eq!(converted("bevy", "metres", &point).from, [("depth", 0.08), ("normal", 0.6)]);
    for engine in Engine::ALL {
        let count = System::Engine(engine).parameters().len();
        assert!(Kind::ALL.iter().all(|kind| engine.defaults(*kind).len() == count), "{}", engine.name());
    }
}

#[test]
fn what_is_wrong_is_refused_with_the_choices() {
    for (text, parts) in [
        ("unity", ["unity", "babylon"]),
        ("unity:bias=1", ["unity", "metres"]),
        ("metres", ["metres", "constant"]),
        ("bevy:bias=1", ["bevy has no parameter `bias`", "depth, normal"]),
        ("bevy:depth", ["`depth`", "NAME=VALUE"]),
        ("bevy:depth=-1", ["depth=-1", "at least 0"]),
        ("three:bias=0.1", ["bias=0.1", "at most 0"]),
        ("bevy:depth=inf", ["depth=inf", "finite"]),
        ("bevy:depth=nan", ["depth=nan", "finite"]),
        ("bevy:depth=x", ["depth=x", "finite"]),
        ("bevy:depth=1;depth=2", ["depth", "twice"]),
        ("bevy:", ["no number", "depth, normal"]),
    ] {
        let problem = text.parse::<GivenBias>().expect_err(text);
        assert!(parts.iter().all(|part| problem.contains(part)), "{text}: {problem}");
    }
}
