use super::{Entry, logarithms, step_of_limit};

#[test]
fn steps_lead_to_the_distance_and_to_the_product_that_is_aimed_at() {
    for (slack, multiplier, distance, aim) in
        [(0.3, 2.0, -0.1, 0.05), (1e-6, 40.0, 2e-6, 1e-7), (2.0, 1e-9, 1.5, 0.1)]
    {
        let [of_slack, of_multiplier, falls, dual_falls] =
            step_of_limit(Entry { slack, multiplier, distance }, aim);
        let product = slack * multiplier + slack * of_multiplier + multiplier * of_slack;
        assert!((slack + of_slack - distance).abs() < 1e-15 * slack.max(distance));
        assert!((product - aim).abs() < 1e-14 * aim.max(slack * multiplier), "{product} {aim}");
        assert!((falls + of_slack / slack).abs() < 1e-14 * falls.abs());
        assert!((dual_falls + of_multiplier / multiplier).abs() < 1e-14 * dual_falls.abs());
    }
}

#[test]
fn a_multiplier_of_zero_falls_by_all_of_it_or_not_at_all() {
    let of = |aim| step_of_limit(Entry { slack: 0.5, multiplier: 0.0, distance: 0.4 }, aim);
    let ([_, rises, _, up], [_, sinks, _, down]) = (of(0.1), of(-0.1));
    assert_eq!([rises, sinks, up, down], [0.2, -0.2, 0.0, f64::INFINITY]);
}

#[test]
fn what_is_no_limit_stays() {
    for slack in [0.0, f64::INFINITY] {
        assert_eq!(step_of_limit(Entry { slack, multiplier: 0.0, distance: 0.1 }, 0.3), [0.0; 4]);
    }
}

/// Weights change within vectors and between them, some entries are off or equations, and products of slacks
/// leave the range of numbers.
#[test]
fn logarithms_are_summed_entry_by_entry() {
    let mut random = fastrand::Rng::with_seed(3);
    for of_one in [1, 5, 8, 40] {
        let weight: Vec<f64> = (0..203).map(|at| 0.1 + f64::from(at / of_one % 3)).collect();
        let mut slack: Vec<f64> = weight.iter().map(|_| 10f64.powf(200.0 * random.f64() - 150.0)).collect();
        (slack[17], slack[18], slack[90]) = (f64::INFINITY, 0.0, f64::INFINITY);
        let on = slack.iter().zip(&weight).filter(|(s, _)| **s > 0.0 && s.is_finite());
        let terms: Vec<f64> = on.map(|(s, w)| w * s.ln()).collect();
        let [sum, size] = [terms.iter().sum(), terms.iter().map(|term| term.abs()).sum::<f64>()];
        let found = logarithms(&slack, &weight);
        assert!((found - sum).abs() < 1e-13 * size, "{of_one}: {found} {sum}");
    }
}
