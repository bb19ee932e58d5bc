//! Error against cost: a dot for each technique, and the line of those that no other beats in both.

use crate::plot::{Axis, Plot, short};

/// A technique in the plot.
pub(super) struct Dot<'a> {
    pub(super) name: &'a str,
    /// Milliseconds a frame.
    pub(super) cost: f64,
    /// The root of the mean squared error.
    pub(super) error: f64,
}

/// The techniques that no other is both cheaper and better than, from the cheapest to the dearest.
pub(super) fn pareto_front(dots: &[Dot<'_>]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..dots.len()).collect();
    order.sort_by(|&a, &b| dots[a].cost.total_cmp(&dots[b].cost).then(dots[a].error.total_cmp(&dots[b].error)));
    let mut best = f64::INFINITY;
    order.retain(|&index| {
        let is_better = dots[index].error < best;
        best = best.min(dots[index].error);
        is_better
    });
    order
}

/// The plot as SVG.
pub(super) fn svg(dots: &[Dot<'_>]) -> String {
    let x = Axis::linear("milliseconds a frame", dots.iter().map(|dot| dot.cost), short);
    let y = Axis::linear("RMSE of visibility", dots.iter().map(|dot| dot.error), short);
    let mut plot = Plot::new("error against cost", x, y);
    let front = pareto_front(dots);
    plot.line("front", front.iter().map(|&index| (dots[index].cost, dots[index].error)));
    for (index, dot) in dots.iter().enumerate() {
        let class = if front.contains(&index) { "dot on-front" } else { "dot" };
        plot.dot(class, 5.0, (dot.cost, dot.error), dot.name);
        plot.name((dot.cost, dot.error), dot.name);
    }
    plot.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_what_no_other_beats() {
        let dots =
            [(3.0, 0.1), (1.0, 0.5), (2.0, 0.6), (2.0, 0.2), (4.0, 0.1)].map(|(cost, error)| Dot { name: "x", cost, error });
        assert_eq!(pareto_front(&dots), [1, 3, 0]);
        assert_eq!(pareto_front(&[]), [0_usize; 0]);
    }
}
