//! What drivers are known to do otherwise than their rules, or WebGPU, have it: each with its figure and its reason. A test that meets one of these passes, and fails once it is
//! mended.

use shadow_gpu::DriverRules;

use crate::renderers::gpu;

/// Something that a driver does.
#[derive(Clone, Copy, Debug)]
pub struct KnownIssue {
    /// Which driver.
    pub driver: DriverRules,
    /// How the failure's text begins: the case.
    pub case: &'static str,
    /// What it has in it: the store, the layer, and how many samples of it differ.
    pub figures: &'static [&'static str],
    /// Why.
    pub reason: &'static str,
}

/// What failures are left after those that are known of the adapter under test, with a sentence for each known one that did not happen.
#[must_use]
pub fn beyond(known: &[KnownIssue], failures: &[String]) -> Vec<String> {
    beyond_of(gpu().adapter().rules, known, failures)
}

fn beyond_of(driver: DriverRules, known: &[KnownIssue], failures: &[String]) -> Vec<String> {
    let is_it = |issue: &KnownIssue, failure: &str| {
        failure.starts_with(issue.case) && issue.figures.iter().all(|figure| failure.contains(figure))
    };
    let of_driver: Vec<_> = known.iter().filter(|issue| issue.driver == driver).collect();
    let mut left: Vec<String> =
        failures.iter().filter(|failure| !of_driver.iter().any(|issue| is_it(issue, failure))).cloned().collect();
    for issue in of_driver {
        if !failures.iter().any(|failure| is_it(issue, failure)) {
            let KnownIssue { driver, case, figures, reason } = issue;
            left.push(format!("{driver:?}, {case}: {figures:?} no longer happens ({reason}); take it from the list"));
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOWN: [KnownIssue; 1] =
        [KnownIssue { driver: DriverRules::SwiftShader, case: "a box", figures: &["2 pixels"], reason: "it is so" }];

    #[test]
    fn what_is_known_is_no_failure_and_must_happen() {
        let left = |driver, failures: &[&str]| {
            let failures: Vec<String> = failures.iter().map(|&failure| failure.into()).collect();
            beyond_of(driver, &KNOWN, &failures)
        };
        assert!(left(DriverRules::SwiftShader, &["a box: 2 pixels differ"]).is_empty());
        assert_eq!(left(DriverRules::SwiftShader, &["a box: 2 pixels differ", "a ball"]), ["a ball"]);
        assert!(left(DriverRules::SwiftShader, &["a box: 3 pixels differ"]).len() == 2, "another figure is another failure");
        assert!(left(DriverRules::SwiftShader, &[])[0].contains("no longer happens"));
        assert_eq!(left(DriverRules::Lavapipe22, &["a box: 2 pixels differ"]).len(), 1);
        assert!(left(DriverRules::Lavapipe22, &[]).is_empty());
    }
}
