//! Certificates: early conjugate times, Jacobians without second derivatives, and what is not checked.

use costate::EvalError;
use costate_control::{
    BoundaryValueProblem, BoundedControls, Certificate, ControlLaw, ExtremalSolution, FinalTime,
    HamiltonianTerms, Homotopy, JacobianRoute, LagrangianExtremal, Problem, RobotExtremal, SolverOptions,
    solve_extremal,
};

/// `s' = u_1, x' = u_2, l = (u_1^2 + u_2^2 - k(s) x^2) / 2`, s from 0 to `to`, x from 0 to 0: s = t for T =
/// `to`, x = 0.
struct Strip {
    to: f64,
    k: fn(f64) -> f64,
    /// Whether `linearise` leaves out the second derivatives of l.
    without_hessian: bool,
    ends_are_fixed: bool,
}

impl Strip {
    fn new(to: f64, k: fn(f64) -> f64) -> Self {
        Self { to, k, without_hessian: false, ends_are_fixed: true }
    }

    fn solve(mut self) -> ExtremalSolution {
        let (time, to) = (FinalTime::Fixed(self.to), self.to);
        let solution = solve_extremal(&mut self, time, &SolverOptions::default(), |s, z| {
            z.copy_from_slice(&[s * to, 0.0, 1.0, 0.0]);
        });
        assert!(solution.motion.status.is_converged(), "{}", solution.motion.status);
        solution
    }
}

impl BoundaryValueProblem for Strip {
    fn states(&self) -> usize {
        2
    }

    fn evaluate(
        &mut self,
        z: &[f64],
        _: ControlLaw<'_>,
        g: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        // k is constant where x is not zero.
        let k = (self.k)(z[0]);
        g.copy_from_slice(&[z[2], z[3], 0.0, -k * z[1]]);
        let (square, cost) = (z[2] * z[2] + z[3] * z[3], -0.5 * k * z[1] * z[1]);
        let cost = 0.5 * square + cost;
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
            j[13] = 0.0;
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
        j.fill(0.0);
        (j[2], j[7], j[13]) = (1.0, 1.0, -(self.k)(z[0]));
        self.evaluate(z, law, g)
    }

    fn start(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        residual.copy_from_slice(&z[..2]);
        jacobian.copy_from_slice(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
        Ok(())
    }

    fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        residual.copy_from_slice(&[z[0] - self.to, z[1]]);
        jacobian.copy_from_slice(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
        Ok(())
    }

    fn ends_are_fixed(&self) -> bool {
        self.ends_are_fixed
    }
}

impl BoundedControls for Strip {
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

impl Homotopy for Strip {}

/// `x'' = -k x` up to 0.03 s, a straight line afterwards, which does not come back to zero within 1 s.
#[test]
fn a_conjugate_time_within_the_first_mesh_interval_is_found() {
    let k = |s: f64| if s < 0.03 { 15_555.0 } else { 0.0 };
    let motion = Strip::new(1.0, k).solve().motion;
    let expected = std::f64::consts::PI / 15_555.0_f64.sqrt();
    assert!((motion.conjugate_time.unwrap() - expected).abs() < 1e-8, "{:?}", motion.conjugate_time);
    assert_eq!((motion.conjugate_multiplicity, motion.certificate), (1, Certificate::NotMinimal));
    // Less than half a period: the straight line that follows leads away.
    let k = |s: f64| if s < 0.01 { 15_555.0 } else { 0.0 };
    assert_eq!(Strip::new(1.0, k).solve().motion.certificate, Certificate::LocalMinimum);
}

/// The field turns back within 0.03 s wherever they are.
#[test]
fn a_conjugate_time_within_any_mesh_interval_is_found() {
    let k = |s: f64| if (s - 0.515).abs() < 0.015 { 15_555.0 } else { 0.0 };
    let motion = Strip::new(1.0, k).solve().motion;
    assert_eq!(motion.certificate, Certificate::NotMinimal);
    let w = 15_555.0_f64.sqrt();
    // x = t up to 0.5 s; then 0.5 cos w s + sin w s / w vanishes at tan w s = -w / 2.
    let expected = 0.5 + (std::f64::consts::PI - (0.5 * w).atan()) / w;
    assert!((motion.conjugate_time.unwrap() - expected).abs() < 1e-8, "{:?}", motion.conjugate_time);
}

#[test]
fn jacobi_fields_have_the_second_derivatives_that_newton_may_leave_out() {
    let strip = Strip { without_hessian: true, ..Strip::new(4.0, |_| 1.0) };
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
    /// A strip that leaves everything to its defaults.
    struct Plain(Strip);
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
    let mut plain = Plain(Strip::new(1.0, |_| 0.0));
    let guess = |s: f64, z: &mut [f64]| z.copy_from_slice(&[s, 0.0, 1.0, 0.0]);
    let options = SolverOptions::default();
    let motion = solve_extremal(&mut plain, FinalTime::Fixed(1.0), &options, guess).motion;
    assert!(motion.status.is_converged(), "{}", motion.status);
    assert_eq!(motion.certificate, Certificate::NotChecked);
    let motion = Strip { ends_are_fixed: false, ..Strip::new(4.0, |_| 1.0) }.solve().motion;
    assert_eq!((motion.certificate, motion.conjugate_time), (Certificate::NotChecked, None));
}
