//! Properties: all methods for derivatives agree on random trees.

use costate::configuration::ConfigurationSpace;
use costate::derivative::{Directional, Figure, Function, Hessian, Jacobian, PhaseVelocity, Routes, Verdict};
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::matrix::Block;
use costate::robot::Robot;
use costate::scalar::Scalar;
use costate::step::{StepError, StepRoutes};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, cases, free_cases};
use costate_test_support::rounding::{Bounds, close, of_inverse, terms};
use proptest::prelude::*;
use std::convert::Infallible;

fn flat(block: Block<'_, f64>) -> Vec<f64> {
    block.iter_rows().flatten().copied().collect()
}

/// Whether a figure exceeds the bound that it states, and what the constants of a robot leave, which are
/// taken as exact there: a rotation that is orthogonal to rounding alone makes routes differ that turn a
/// body and that do not.
fn exceeds(figure: &Figure, of_constants: f64) -> bool {
    figure.verdict(1.0) == Verdict::Differs && figure.difference > figure.bound + of_constants
}

/// Everything that [`Routes`] compares.
fn routes_agree(case: &Case) -> Result<(), TestCaseError> {
    let robot = case.robot();
    let report = Routes::new(&robot).compare(&case.x(&robot), &case.u, &case.y).unwrap();
    let of_constants = of_inverse(&robot, &case.q);
    let failures: Vec<_> = report.failures(1.0).filter(|figure| exceeds(figure, of_constants)).collect();
    prop_assert!(failures.is_empty(), "{failures:#?}");
    Ok(())
}

/// The same of [`StepRoutes`]; near a singular M an implicit step may have no solution.
fn steps_agree(case: &Case) -> Result<(), TestCaseError> {
    let (robot, mut figures) = (case.robot(), Vec::new());
    match StepRoutes::new(&robot).compare(&case.x(&robot), &case.u, STEP, &case.y, &mut figures) {
        Ok(()) => prop_assert_eq!(figures.len(), 8, "two rows of four schemes"),
        Err(StepError::NotConverged { .. } | StepError::Inaccurate { .. }) => {
            return Err(TestCaseError::reject("no implicit step"));
        }
        Err(error) => prop_assert!(false, "{error}"),
    }
    let of_constants = of_inverse(&robot, &case.q);
    figures.retain(|figure| exceeds(figure, of_constants));
    prop_assert!(figures.is_empty(), "{figures:#?}");
    Ok(())
}

/// Duration of a step (s).
const STEP: f64 = 1e-3;

/// Robots a property.
const CASES: u32 = 320;

properties! {
    CASES;

    #[test]
    fn routes_agree_on_random_trees(case in cases(12)) {
        routes_agree(&case)?;
    }

    #[test]
    fn routes_agree_for_one_joint(case in cases(1)) {
        routes_agree(&case)?;
    }

    /// The contraction of the whole tensor, and the derivative of F_x' y along a direction.
    #[test]
    fn tensor_and_directional_derivative_contract_alike(case in cases(5)) {
        let robot = case.robot();
        let (x, n) = (case.x(&robot), case.n());
        let bounds = Bounds::new(&robot, [&case.q, &case.v, &case.u, &case.y]);
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
        let analytic = second.contract(&case.q, &x[n..], &case.u, &case.y).unwrap();
        let mut hessian = Hessian::new(PhaseVelocity::new(&robot).under(&case.u));
        let tensor = hessian.hessian_tensor(&x).unwrap();
        let mut contracted = Vec::new();
        for i in 0..2 * n {
            for j in 0..2 * n {
                contracted.push((0..2 * n).map(|k| case.y[k] * tensor.entry(k, i, j)).sum::<f64>());
            }
        }
        // Entries of y are at most 1, so each of the 2n products rounds as an entry of the tensor does.
        close("y'F_xx", &flat(analytic.matrix()), &contracted, bounds.y_f_xx)?;
        let mut directional = Directional::new(PhaseVelocity::new(&robot).under(&case.u));
        let along = directional.jacobian_product(&x, &case.y).unwrap();
        let f_x = analytic.linearisation();
        let product: Vec<f64> =
            f_x.matrix().iter_rows().map(|row| row.iter().zip(&case.y).map(|(a, b)| a * b).sum()).collect();
        close("F", along.value, f_x.f(), bounds.f)?;
        close("F_x y", along.derivative, &product, 2.0 * n as f64 * bounds.f_x)?;
    }

    /// F and F_x do not depend on how they are asked for.
    #[test]
    fn one_sweep_gives_what_single_calls_give(case in cases(8)) {
        let robot = case.robot();
        let p = case.p(&robot);
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        let f = hamiltonian.evaluate(&case.q, &p, &case.u).unwrap().to_vec();
        let linear = hamiltonian.linearise(&case.q, &p, &case.u).unwrap();
        prop_assert_eq!(linear.f(), &f[..]);
        let (f_x, minv) = (flat(linear.matrix()), flat(linear.qp()));
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
        let all = second.contract(&case.q, &p, &case.u, &case.y).unwrap();
        let bounds = Bounds::new(&robot, [&case.q, &case.v, &case.u, &case.y]);
        close("F", all.linearisation().f(), &f, bounds.f)?;
        close("F_x", &flat(all.linearisation().matrix()), &f_x, bounds.f_x)?;
        prop_assert_eq!(hamiltonian.inverse_mass_matrix(&case.q).unwrap().as_slice(), &minv[..]);
    }

    /// Dual numbers of any chunk length give the same Jacobian: of a small function, which compiles fast.
    #[test]
    fn chunks_of_any_length_agree(x in prop::collection::vec(0.1..3.0, 1..40)) {
        let function = Ring(x.len());
        let one = Jacobian::<_, 1>::chunked(function).linearise(&x).unwrap().jacobian.clone();
        let three = Jacobian::<_, 3>::chunked(function).linearise(&x).unwrap().jacobian.clone();
        let many = Jacobian::<_, 16>::chunked(function).linearise(&x).unwrap().jacobian.clone();
        prop_assert!(one.as_slice().iter().any(|entry| *entry != 0.0));
        // An entry is rounded by at most ten operations: sine, cosine and sum, quotients, and products of 3.
        let bound = terms(10, &[3.0]);
        close("chunks of three", three.as_slice(), one.as_slice(), bound)?;
        close("chunks of sixteen", many.as_slice(), one.as_slice(), bound)?;
    }
}

properties! {
    48;

    #[test]
    fn routes_and_steps_agree_with_free_joints(case in free_cases(3)) {
        routes_agree(&case)?;
        steps_agree(&case)?;
    }
}

/// `y_i = x_i sin x_(i+1) / (2 + cos x_(i+2))`, indices modulo n: a function that compiles fast.
#[derive(Clone, Copy)]
struct Ring(usize);

impl Function for Ring {
    type Workspace<S: Scalar> = ();
    type Error = Infallible;
    fn inputs(&self) -> usize {
        self.0
    }
    fn outputs(&self) -> usize {
        self.0
    }
    fn workspace<S: Scalar>(&self) {}
    fn evaluate<S: Scalar>(&self, (): &mut (), x: &[S], y: &mut [S]) -> Result<(), Infallible> {
        let at = |i: usize| x[i % self.0];
        for (i, y) in y.iter_mut().enumerate() {
            *y = at(i) * at(i + 1).sin_cos().0 / at(i + 2).sin_cos().1.plus(2.0);
        }
        Ok(())
    }
}

/// In every row, a relative change of 1e-8 of the largest entry of any block fails the comparison.
#[test]
fn a_wrong_entry_is_detected() {
    for name in ["two_link.toml", "cart_pole.toml", "puma560.toml", "ur5.urdf", "panda.urdf", "biped.toml"] {
        let robot = Robot::from_file(format!("{}/robots/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap();
        wrong_entries_are_detected(&robot);
    }
}

/// The same with a floating joint and spherical ones.
#[test]
fn a_wrong_entry_is_detected_with_free_joints() {
    let path = format!("{}/tests/fixtures/free_tree.toml", env!("CARGO_MANIFEST_DIR"));
    wrong_entries_are_detected(&Robot::from_file(path).unwrap());
}

fn wrong_entries_are_detected(robot: &Robot) {
    let n = robot.dof();
    let numbers = |count: usize, factor: f64| -> Vec<f64> {
        (0..count).map(|i| (factor * (i + 1) as f64).sin()).collect()
    };
    let (d, v, u, y) = (numbers(n, 1.3), numbers(n, 0.9), numbers(n, 2.1), numbers(2 * n, 1.7));
    let space = ConfigurationSpace::new(robot);
    let mut q = space.neutral();
    space.integrate(&space.neutral(), &d, &mut q).unwrap();
    let p = Hamiltonian::<f64>::new(robot).momentum(&q, &v).unwrap().to_vec();
    let x = [q, p].concat();
    let (nothing, name): ([[&str; 2]; 0], _) = ([], robot.name());
    assert_eq!(Routes::new(robot).undetected(&x, &u, &y, 1e-8).unwrap(), nothing, "{name}");
    assert_eq!(StepRoutes::new(robot).undetected(&x, &u, STEP, &y, 1e-8).unwrap(), nothing, "{name}");
}
