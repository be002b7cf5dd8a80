//! A system that is not a robot: `dx/dt = u`, `l = c_t + u^2/2 + k x^2/2`.

use crate::sharp;
use costate::EvalError;
use costate_control::{
    BoundaryValueProblem, BoundedControls, Certificate, ControlLaw, ExtremalSolution, FinalTime,
    HamiltonianTerms, Homotopy, solve_extremal,
};

/// x from 0 to `to`; `u = y`, `H* = y^2/2 - k x^2/2 - c_t`.
struct Line {
    to: f64,
    stiffness: f64,
    time_cost: f64,
}

impl BoundaryValueProblem for Line {
    fn states(&self) -> usize {
        1
    }

    fn evaluate(
        &mut self,
        z: &[f64],
        _: ControlLaw<'_>,
        g: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        g.copy_from_slice(&[z[1], self.stiffness * z[0]]);
        let cost = self.time_cost + 0.5 * z[1] * z[1] + 0.5 * self.stiffness * z[0] * z[0];
        Ok(HamiltonianTerms { hamiltonian: z[1] * z[1] - cost, cost, ..HamiltonianTerms::default() })
    }

    fn linearise(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        j: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        j.copy_from_slice(&[0.0, 1.0, self.stiffness, 0.0]);
        self.evaluate(z, law, g)
    }

    fn start(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        residual[0] = z[0];
        jacobian.copy_from_slice(&[1.0, 0.0]);
        Ok(())
    }

    fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        residual[0] = z[0] - self.to;
        jacobian.copy_from_slice(&[1.0, 0.0]);
        Ok(())
    }

    fn time_cost(&self) -> f64 {
        self.time_cost
    }

    fn ends_are_fixed(&self) -> bool {
        true
    }
}

impl BoundedControls for Line {
    fn controls(&self) -> usize {
        1
    }

    fn unbounded_controls(&mut self, z: &[f64], u: &mut [f64]) {
        u[0] = z[1];
    }

    fn state_rate(&mut self, _: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        f.copy_from_slice(u);
        Ok(())
    }
}

impl Homotopy for Line {}

fn solve(mut line: Line, time: FinalTime, points: usize) -> ExtremalSolution {
    let to = line.to;
    let options = sharp().with_points(points);
    let motion = solve_extremal(&mut line, time, &options, |s, z| z[0] = s * to);
    assert!(motion.motion.status.is_converged(), "{}", motion.motion.status);
    motion
}

#[test]
fn the_conjugate_time_of_an_inverted_cost_is_pi() {
    for (time, expected) in [(4.0, Some(std::f64::consts::PI)), (3.0, None)] {
        let line = Line { to: 1.0, stiffness: -1.0, time_cost: 0.0 };
        let motion = solve(line, FinalTime::Fixed(time), 4).motion;
        // x = sin t / sin T, J = cot T / 2.
        assert!((motion.cost - 0.5 / time.tan()).abs() < 1e-8 * (1.0 + motion.cost.abs()), "{}", motion.cost);
        match (motion.conjugate_time, expected) {
            (Some(found), Some(expected)) => {
                assert!((found - expected).abs() < 1e-8, "{found}");
                assert_eq!(motion.certificate, Certificate::NotMinimal);
            }
            (None, None) => assert_eq!(motion.certificate, Certificate::LocalMinimum),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn both_orders_reach_the_tolerance() {
    for points in [3, 4] {
        let line = Line { to: 1.0, stiffness: 4.0, time_cost: 0.0 };
        let nodes = solve(line, FinalTime::Fixed(3.0), points).nodes;
        // x = sinh 2t / sinh 2T; y = x'.
        for (t, z) in nodes.t.iter().zip(&nodes.z) {
            let exact = [(2.0 * t).sinh(), 2.0 * (2.0 * t).cosh()].map(|x| x / 6.0_f64.sinh());
            assert!((z[0] - exact[0]).abs() < 1e-9 && (z[1] - exact[1]).abs() < 2e-9, "{z:?} {exact:?}");
        }
    }
}

#[test]
fn the_best_time_balances_the_price_of_time() {
    for guess in [0.05, 1.0, 20.0] {
        let line = Line { to: 1.0, stiffness: 0.0, time_cost: 1.0 };
        let motion = solve(line, FinalTime::Free { guess }, 4).motion;
        assert!((motion.final_time - 0.5_f64.sqrt()).abs() < 1e-9, "{}", motion.final_time);
        assert!((motion.cost - 2.0_f64.sqrt()).abs() < 1e-9 && motion.hamiltonian.abs() < 1e-9);
    }
}

#[test]
fn between_nodes_the_polynomial_has_the_accuracy_of_the_nodes() {
    let line = Line { to: 1.0, stiffness: 4.0, time_cost: 0.0 };
    let nodes = solve(line, FinalTime::Fixed(3.0), 4).nodes;
    for k in 0..=1000 {
        let t = 3.0 * f64::from(k) / 1000.0;
        let exact = [(2.0 * t).sinh(), 2.0 * (2.0 * t).cosh()].map(|x| x / 6.0_f64.sinh());
        let z = nodes.at(t).unwrap();
        assert!((z[0] - exact[0]).abs() < 2e-9 && (z[1] - exact[1]).abs() < 4e-9, "{t}: {z:?} {exact:?}");
    }
    assert_eq!(nodes.at(3.1), None);
}
