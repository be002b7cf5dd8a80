//! Certificates: early conjugate times, Jacobians without second derivatives, and what is not checked.

use crate::sharp;
use costate::EvalError;
use costate_control::{
    BoundaryValueProblem, BoundedControls, Certificate, ControlLaw, ExtremalSolution, FinalTime,
    HamiltonianTerms, Homotopy, JacobianRoute, LagrangianExtremal, Problem, RobotExtremal, solve_extremal,
};

/// `x_i' = u_i, l = sum (u_i^2 - k_i x_i^2) / 2` from 0 to `to`: two states that know nothing of each other
/// where k is constant.
struct Plane {
    to: [f64; 2],
    /// k at a position; constant in parts wherever the state that it multiplies is not zero.
    k: fn([f64; 2]) -> [f64; 2],
    /// Whether `linearise` leaves out the second derivatives of l.
    without_hessian: bool,
    ends_are_fixed: bool,
}

impl Plane {
    fn new(to: [f64; 2], k: fn([f64; 2]) -> [f64; 2]) -> Self {
        Self { to, k, without_hessian: false, ends_are_fixed: true }
    }

    /// From 0 to (`to`, 0) with k_1 = 0: x_1 = t for T = `to`, x_2 = 0.
    fn strip(to: f64, k: fn([f64; 2]) -> [f64; 2]) -> Self {
        Self::new([to, 0.0], k)
    }

    /// The motion of a [`strip`](Self::strip).
    fn solve(mut self) -> ExtremalSolution {
        let (time, to) = (FinalTime::Fixed(self.to[0]), self.to[0]);
        let solution = solve_extremal(&mut self, time, &sharp(), |s, z| {
            z.copy_from_slice(&[s * to, 0.0, 1.0, 0.0]);
        });
        assert!(solution.motion.status.is_converged(), "{}", solution.motion.status);
        solution
    }
}

impl BoundaryValueProblem for Plane {
    fn states(&self) -> usize {
        2
    }

    fn evaluate(
        &mut self,
        z: &[f64],
        _: ControlLaw<'_>,
        g: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        let k = (self.k)([z[0], z[1]]);
        g.copy_from_slice(&[z[2], z[3], -k[0] * z[0], -k[1] * z[1]]);
        let square = z[2] * z[2] + z[3] * z[3];
        let cost = 0.5 * (square - k[0] * z[0] * z[0] - k[1] * z[1] * z[1]);
        Ok(HamiltonianTerms { hamiltonian: square - cost, cost, ..HamiltonianTerms::default() })
    }

    fn linearise(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        j: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        let terms = self.linearise_exactly(z, law, g, j)?;
        if self.without_hessian {
            (j[8], j[13]) = (0.0, 0.0);
        }
        Ok(terms)
    }

    fn linearise_exactly(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        j: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        let k = (self.k)([z[0], z[1]]);
        j.fill(0.0);
        (j[2], j[7], j[8], j[13]) = (1.0, 1.0, -k[0], -k[1]);
        self.evaluate(z, law, g)
    }

    fn start(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        residual.copy_from_slice(&z[..2]);
        jacobian.copy_from_slice(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
        Ok(())
    }

    fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        residual.copy_from_slice(&[z[0] - self.to[0], z[1] - self.to[1]]);
        jacobian.copy_from_slice(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
        Ok(())
    }

    fn ends_are_fixed(&self) -> bool {
        self.ends_are_fixed
    }
}

impl BoundedControls for Plane {
    fn controls(&self) -> usize {
        2
    }

    fn unbounded_controls(&mut self, z: &[f64], u: &mut [f64]) {
        u.copy_from_slice(&z[2..]);
    }

    fn state_rate(&mut self, _: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        f.copy_from_slice(u);
        Ok(())
    }
}

impl Homotopy for Plane {}

/// Each conjugate time has the multiplicity two.
#[test]
fn conjugate_times_of_even_multiplicity_are_counted() {
    use std::f64::consts::PI;
    for (time, expected) in [(3.0, None), (4.0, Some(PI)), (7.0, Some(PI)), (40.0, Some(PI))] {
        let guess = |s: f64, z: &mut [f64]| z[..2].copy_from_slice(&[s, 2.0 * s]);
        let mut plane = Plane::new([1.0, 2.0], |_| [1.0, 1.0]);
        let options = sharp();
        let motion = solve_extremal(&mut plane, FinalTime::Fixed(time), &options, guess).motion;
        assert!(motion.status.is_converged(), "{}", motion.status);
        match (motion.conjugate_time, expected) {
            (Some(found), Some(expected)) => {
                assert!((found - expected).abs() < 1e-8, "{found}");
                assert_eq!((motion.conjugate_multiplicity, motion.certificate), (2, Certificate::NotMinimal));
            }
            (None, None) => assert_eq!(motion.certificate, Certificate::LocalMinimum),
            other => panic!("T = {time}: {other:?}"),
        }
    }
}

/// `x'' = -k x` up to 0.03 s, a straight line afterwards, which does not come back to zero within 1 s.
#[test]
fn a_conjugate_time_within_the_first_mesh_interval_is_found() {
    let k = |[s, _]: [f64; 2]| [0.0, if s < 0.03 { 15_555.0 } else { 0.0 }];
    let motion = Plane::strip(1.0, k).solve().motion;
    let expected = std::f64::consts::PI / 15_555.0_f64.sqrt();
    assert!((motion.conjugate_time.unwrap() - expected).abs() < 1e-8, "{:?}", motion.conjugate_time);
    assert_eq!((motion.conjugate_multiplicity, motion.certificate), (1, Certificate::NotMinimal));
    // Less than half a period: the straight line that follows leads away.
    let k = |[s, _]: [f64; 2]| [0.0, if s < 0.01 { 15_555.0 } else { 0.0 }];
    assert_eq!(Plane::strip(1.0, k).solve().motion.certificate, Certificate::LocalMinimum);
}

/// The field turns back within 0.03 s wherever they are.
#[test]
fn a_conjugate_time_within_any_mesh_interval_is_found() {
    let k = |[s, _]: [f64; 2]| [0.0, if (s - 0.515).abs() < 0.015 { 15_555.0 } else { 0.0 }];
    let motion = Plane::strip(1.0, k).solve().motion;
    assert_eq!(motion.certificate, Certificate::NotMinimal);
    let w = 15_555.0_f64.sqrt();
    // x = t up to 0.5 s; then 0.5 cos w s + sin w s / w vanishes at tan w s = -w / 2.
    let expected = 0.5 + (std::f64::consts::PI - (0.5 * w).atan()) / w;
    assert!((motion.conjugate_time.unwrap() - expected).abs() < 1e-8, "{:?}", motion.conjugate_time);
}

#[test]
fn jacobi_fields_have_the_second_derivatives_that_newton_may_leave_out() {
    let strip = Plane { without_hessian: true, ..Plane::strip(4.0, |_| [0.0, 1.0]) };
    let motion = strip.solve().motion;
    assert_eq!(motion.certificate, Certificate::NotMinimal);
    assert!((motion.conjugate_time.unwrap() - std::f64::consts::PI).abs() < 1e-8);
}

#[test]
fn robots_have_an_exact_jacobian_on_every_route() {
    let robot = costate::robot::Robot::from_file("../robots/two_link.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.1, 0.2], &[1.0, -0.4], 1.0);
    let z = [0.3, 0.7, -0.2, 0.4, 0.5, -0.6, 0.9, 0.8];
    fn matrices(extremal: &mut impl BoundaryValueProblem, z: &[f64]) -> [Vec<f64>; 2] {
        let (mut g, mut own, mut exact) = (vec![0.0; 8], vec![0.0; 64], vec![0.0; 64]);
        extremal.linearise(z, ControlLaw::Maximal, &mut g, &mut own).unwrap();
        extremal.linearise_exactly(z, ControlLaw::Maximal, &mut g, &mut exact).unwrap();
        [own, exact]
    }
    let checked = || problem.check().unwrap();
    let routes = [JacobianRoute::Exact, JacobianRoute::WithoutHessian, JacobianRoute::Differences];
    let canonical = routes.map(|route| matrices(&mut RobotExtremal::new(checked(), route).unwrap(), &z));
    let lagrangian =
        routes.map(|route| matrices(&mut LagrangianExtremal::new(checked(), route).unwrap(), &z));
    for [[own, exact], [without, second], [_, third]] in [canonical, lagrangian] {
        assert!(own == exact && own == second && own == third);
        assert_ne!(own, without);
    }
}

#[test]
fn nothing_is_claimed_unless_the_extremal_says_that_its_ends_are_fixed() {
    /// A plane that leaves everything to its defaults.
    struct Plain(Plane);
    impl BoundaryValueProblem for Plain {
        fn states(&self) -> usize {
            2
        }
        fn evaluate(
            &mut self,
            z: &[f64],
            law: ControlLaw<'_>,
            g: &mut [f64],
        ) -> Result<HamiltonianTerms, EvalError> {
            self.0.evaluate(z, law, g)
        }
        fn linearise(
            &mut self,
            z: &[f64],
            law: ControlLaw<'_>,
            g: &mut [f64],
            jacobian: &mut [f64],
        ) -> Result<HamiltonianTerms, EvalError> {
            self.0.linearise(z, law, g, jacobian)
        }
        fn start(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
            self.0.start(z, residual, jacobian)
        }
        fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
            self.0.end(z, residual, jacobian)
        }
    }
    impl BoundedControls for Plain {}
    impl Homotopy for Plain {}
    let mut plain = Plain(Plane::strip(1.0, |_| [0.0, 0.0]));
    let guess = |s: f64, z: &mut [f64]| z.copy_from_slice(&[s, 0.0, 1.0, 0.0]);
    let options = sharp();
    let motion = solve_extremal(&mut plain, FinalTime::Fixed(1.0), &options, guess).motion;
    assert!(motion.status.is_converged(), "{}", motion.status);
    assert_eq!(motion.certificate, Certificate::NotChecked);
    let motion = Plane { ends_are_fixed: false, ..Plane::strip(4.0, |_| [0.0, 1.0]) }.solve().motion;
    assert_eq!((motion.certificate, motion.conjugate_time), (Certificate::NotChecked, None));
}
