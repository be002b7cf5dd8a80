//! Derivatives by parameters against dual and hyper-dual numbers as parameters, through programs that the
//! pipeline records with parameters as arguments.

use super::{of_acceleration, of_regressor, of_state_equation};
use costate::codegen::{Coordinates, Program, ProgramOptions, Quantity, parameter_values, robot_program};
use costate::parameters::{HamiltonianParameters, LagrangianParameters, ParameterSet, Regressor};
use costate::robot::Robot;
use costate::scalar::Scalar;
use costate_test_support::properties;
use costate_test_support::random_robot::cases;
use costate_test_support::rounding::close;
use num_dual::{Dual64, HyperDual64};

/// A quantity with the parameters of the robot as arguments.
fn program(robot: &Robot, quantity: Quantity, coordinates: Coordinates) -> Program {
    let options = ProgramOptions::default().with_parameters(true).with_only(true);
    robot_program(robot, quantity, coordinates, &options).unwrap()
}

fn outputs<S: Scalar>(program: &Program, inputs: &[S]) -> Vec<S> {
    let mut outputs = vec![S::zero(); program.outputs()];
    program.evaluate(inputs, &mut outputs, &mut Vec::new()).unwrap();
    outputs
}

/// Derivatives of all outputs by each parameter, row by row.
fn by_parameters(program: &Program, state: &[&[f64]], robot: &Robot) -> Vec<f64> {
    let parameters = parameter_values(robot);
    let inputs = [&state.concat()[..], &parameters].concat();
    let start = inputs.len() - parameters.len();
    let mut inputs: Vec<_> = inputs.into_iter().map(Dual64::from_re).collect();
    let mut rows = vec![vec![0.0; parameters.len()]; program.outputs()];
    for k in 0..parameters.len() {
        inputs[start + k].eps = 1.0;
        let column = outputs(program, &inputs);
        rows.iter_mut().zip(column).for_each(|(row, output)| row[k] = output.eps);
        inputs[start + k].eps = 0.0;
    }
    rows.concat()
}

properties! {
    48;

    #[test]
    fn dual_parameters_give_the_derivatives_of_inverse_dynamics(case in cases(5)) {
        let (robot, w) = (case.robot(), &case.y[..case.n()]);
        let set = ParameterSet::new(&robot).model();
        let mut regressor = Regressor::<f64>::new(&set);
        let program = program(&robot, Quantity::InverseDynamics, Coordinates::Lagrangian);
        let expected = by_parameters(&program, &[&case.q, &case.v, &case.u], &robot);
        let tau = regressor.inverse_dynamics(&case.q, &case.v, &case.u).unwrap().as_slice().to_vec();
        let [of_tau, of_w_tau, ..] = of_regressor(&set, [&case.q, &case.v, &case.u, w]);
        close("tau_theta", &tau, &expected, of_tau)?;
        let along: Vec<f64> = (0..set.len())
            .map(|k| (0..case.n()).map(|i| w[i] * expected[i * set.len() + k]).sum())
            .collect();
        let w_tau = regressor.adjoint(&case.q, &case.v, &case.u, w).unwrap();
        // Weights are at most 1: each of the n terms rounds as an entry of tau_theta does.
        close("w'tau_theta", w_tau, &along, of_w_tau.max(case.n() as f64 * of_tau))?;
    }

    #[test]
    fn dual_parameters_give_the_derivatives_of_energy(case in cases(5)) {
        let robot = case.robot();
        let set = ParameterSet::new(&robot).model();
        let program = program(&robot, Quantity::Energy, Coordinates::Lagrangian);
        let both = by_parameters(&program, &[&case.q, &case.v], &robot);
        let expected: Vec<f64> = (0..set.len()).map(|k| both[k] + both[set.len() + k]).collect();
        let mut regressor = Regressor::<f64>::new(&set);
        let [.., of_energy] = of_regressor(&set, [&case.q, &case.v, &case.u, &case.u]);
        close("E_theta", regressor.energy(&case.q, &case.v).unwrap(), &expected, of_energy)?;
    }

    #[test]
    fn dual_parameters_give_the_derivatives_of_forward_dynamics(case in cases(5)) {
        let (robot, y) = (case.robot(), &case.y[..case.n()]);
        let set = ParameterSet::new(&robot).model();
        let mut parameters = LagrangianParameters::<f64>::new(&set);
        let program = program(&robot, Quantity::F, Coordinates::Lagrangian);
        let expected = by_parameters(&program, &[&case.q, &case.v, &case.u], &robot);
        let [of_a, of_y_a] = of_acceleration(&set, [&case.q, &case.v, &case.u, y]);
        let linear = parameters.linearise_forward_dynamics(&case.q, &case.v, &case.u).unwrap();
        close("a_theta", linear.a_theta.as_slice(), &expected, of_a)?;
        let along: Vec<f64> = (0..set.len())
            .map(|k| (0..case.n()).map(|i| y[i] * expected[i * set.len() + k]).sum())
            .collect();
        let y_a = parameters.adjoint_forward_dynamics(&case.q, &case.v, &case.u, y).unwrap();
        close("y'a_theta", y_a, &along, of_y_a.max(case.n() as f64 * of_a))?;
    }

    #[test]
    fn hyper_dual_parameters_give_the_derivatives_of_the_state_equation(case in cases(4)) {
        let (robot, n) = (case.robot(), case.n());
        let (p, set) = (case.p(&robot), ParameterSet::new(&robot).model());
        let program = program(&robot, Quantity::F, Coordinates::Hamiltonian);
        let inputs = [&case.q[..], &p, &case.u, set.values()].concat();
        let mut inputs: Vec<_> = inputs.into_iter().map(HyperDual64::from_re).collect();
        let len = set.len();
        let (mut f_theta, mut y_f_x_theta) = (vec![0.0; 2 * n * len], vec![0.0; 2 * n * len]);
        let mut y_f_theta = vec![0.0; len];
        for k in 0..len {
            inputs[3 * n + k].eps2 = 1.0;
            for i in 0..2 * n {
                inputs[i].eps1 = 1.0;
                let f = outputs(&program, &inputs);
                inputs[i].eps1 = 0.0;
                f_theta[i * len + k] = f[i].eps2;
                y_f_theta[k] += case.y[i] * f[i].eps2;
                y_f_x_theta[i * len + k] = case.y.iter().zip(&f).map(|(y, f)| y * f.eps1eps2).sum();
            }
            inputs[3 * n + k].eps2 = 0.0;
        }
        let [of_f, of_y_f, of_y_f_x] = of_state_equation(&set, [&case.q, &case.v, &case.y]);
        let mut parameters = HamiltonianParameters::<f64>::new(&set);
        let all = parameters.contract(&case.q, &p, &case.y).unwrap();
        close("F_theta", all.f_theta().as_slice(), &f_theta, of_f)?;
        let of_y_f = of_y_f.max(2.0 * n as f64 * of_f);
        close("y'F_theta", all.y_f_theta(), &y_f_theta, of_y_f)?;
        close("y'F_x,theta", all.y_f_x_theta().as_slice(), &y_f_x_theta, of_y_f_x)?;
        close("y'F_theta alone", parameters.adjoint(&case.q, &p, &case.y).unwrap(), &y_f_theta, of_y_f)?;
        close("F_theta alone", parameters.linearise(&case.q, &p).unwrap().as_slice(), &f_theta, of_f)?;
    }
}
