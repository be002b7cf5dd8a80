//! What the equations of every extremal of a robot must satisfy.

use costate_control::{BoundaryValueProblem, ControlLaw};

/// g = (dH*/dy, -dH*/dx), by differences of order four, relative to its size and that of H*.
pub fn assert_canonical<E: BoundaryValueProblem>(extremal: &mut E, z: &[f64], tolerance: f64, name: &str) {
    let m = z.len();
    let (mut g, mut beside) = (vec![0.0; m], vec![0.0; m]);
    let terms = extremal.evaluate(z, ControlLaw::Maximal, &mut g).unwrap();
    let size = g.iter().fold(terms.magnitude(), |size, g| size.max(g.abs()));
    for i in 0..m {
        let mut at = |h: f64| {
            let mut z = z.to_vec();
            z[i] += h;
            extremal.evaluate(&z, ControlLaw::Maximal, &mut beside).unwrap().hamiltonian
        };
        let slope = (8.0 * (at(1e-4) - at(-1e-4)) - at(2e-4) + at(-2e-4)) / 1.2e-3;
        let expected = if i < m / 2 { -g[m / 2 + i] } else { g[i - m / 2] };
        assert!((slope - expected).abs() < tolerance * size, "{name}: {i}: {slope} {expected}");
    }
}

/// The exact Jacobian is that of central differences, and both routes give the g of an evaluation.
pub fn assert_jacobians_agree<E: BoundaryValueProblem>(
    exact: &mut E,
    differences: &mut E,
    z: &[f64],
    name: &str,
) {
    let m = z.len();
    let [exact, differences] = [exact, differences].map(|extremal| {
        let (mut g, mut h, mut jacobian) = (vec![0.0; m], vec![0.0; m], vec![0.0; m * m]);
        let linear = extremal.linearise(z, ControlLaw::Maximal, &mut g, &mut jacobian).unwrap();
        let plain = extremal.evaluate(z, ControlLaw::Maximal, &mut h).unwrap();
        assert!((linear.hamiltonian - plain.hamiltonian).abs() < 1e-12 * plain.magnitude());
        let size = g.iter().fold(1.0_f64, |size, g| size.max(g.abs()));
        assert!(g.iter().zip(&h).all(|(g, h)| (g - h).abs() < 1e-12 * size));
        jacobian
    });
    let size = differences.iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
    for (i, (exact, difference)) in exact.iter().zip(&differences).enumerate() {
        let (row, column) = (i / m, i % m);
        assert!((exact - difference).abs() < 1e-7 * size, "{name}: {row} {column}: {exact} {difference}");
    }
}
