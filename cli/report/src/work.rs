//! Powers of the joints, and the work that they do.

use crate::limits;
use crate::motion::Motion;
use crate::plot::{Curve, Group, Look, NEUTRAL, Panel, Plot};

/// tau v of each joint (W); rows are times.
pub fn powers(motion: &Motion<'_>) -> Vec<Vec<f64>> {
    let rows = motion.samples.tau.iter().zip(&motion.samples.v);
    rows.map(|(tau, v)| tau.iter().zip(v).map(|(tau, v)| tau * v).collect()).collect()
}

/// The power of all joints together, and the work that they have done.
pub fn sums(motion: &Motion<'_>, powers: &[Vec<f64>]) -> [Panel; 2] {
    let t = &motion.samples.t;
    let over_time = |values: Vec<f64>| t.iter().copied().zip(values).collect::<Vec<_>>();
    let curve = |name: &str, color, points| Curve { name: name.into(), color, points, look: Look::Line };
    let total: Vec<f64> = powers.iter().map(|row| row.iter().sum()).collect();
    // What motors deliver that take nothing back, as in the cost of energy.
    let delivered: Vec<f64> = powers.iter().map(|row| row.iter().map(|power| power.max(0.0)).sum()).collect();
    let mut power = Plot::over_time("Power of all joints", "\u{3a3} \u{3c4} v", Group::Actuation);
    power.limits = limits::of_total_power(motion);
    let mut energy = Plot::over_time("Work", "W", Group::Actuation);
    energy.curves = vec![
        curve("work", NEUTRAL, over_time(integral(t, &total))),
        curve("delivered, nothing taken back", 0, over_time(integral(t, &delivered))),
    ];
    power.curves = vec![curve("all joints", NEUTRAL, over_time(total))];
    (power.unit, energy.unit) = ("W".into(), "J".into());
    [("total_power".into(), power), ("energy".into(), energy)]
}

/// The integral from the start to each time, by trapezia.
fn integral(t: &[f64], values: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = t.windows(2).zip(values.windows(2));
    let steps = steps.map(|(t, y)| 0.5 * (t[1] - t[0]) * (y[0] + y[1]));
    let later = steps.map(|step| {
        sum += step;
        sum
    });
    std::iter::once(0.0).take(values.len()).chain(later).collect()
}

#[cfg(test)]
mod tests {
    use super::integral;

    #[test]
    fn work_is_the_integral_of_power() {
        assert_eq!(integral(&[0.0, 1.0, 1.0, 3.0], &[0.0, 2.0, -1.0, -1.0]), [0.0, 1.0, 1.0, -1.0]);
        assert!(integral(&[], &[]).is_empty());
    }
}
