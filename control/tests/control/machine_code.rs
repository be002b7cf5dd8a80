//! Optimal motions with machine code in place of the library's equations.

use costate::robot::Robot;
use costate_control::{GeneratedExtremal, Problem, ProgramOf, pontryagin_program, solve_extremal};
use costate_jit::{Compiled, JitError};
use std::f64::consts::FRAC_PI_2;

#[test]
fn the_solver_runs_on_machine_code() {
    let robot = Robot::from_file(format!("{}/../robots/two_link.toml", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.0; 2], &[FRAC_PI_2; 2], 1.0);
    let compiled = ProgramOf::ALL.map(|of| Compiled::new(&pontryagin_program(&problem, of).unwrap()));
    let [rate, linear] = match compiled {
        [Ok(rate), Ok(linear)] => [rate, linear],
        [Err(JitError::Processor { .. }), _] => return,
        [Err(error), _] | [_, Err(error)] => panic!("{error}"),
    };
    // Results lie one after the other: z_t, l, and the Jacobian.
    let (mut short, mut long, mut calls) = ([0.0; 10], [0.0; 74], 0);
    let mut extremal = GeneratedExtremal::new(
        &problem,
        |z, z_t, l| {
            rate.call(z, &mut short).unwrap();
            z_t.copy_from_slice(&short[..8]);
            l.copy_from_slice(&short[8..]);
        },
        |z, z_t, l, z_t_z| {
            calls += 1;
            linear.call(z, &mut long).unwrap();
            z_t.copy_from_slice(&long[..8]);
            l.copy_from_slice(&long[8..10]);
            z_t_z.copy_from_slice(&long[10..]);
        },
    )
    .unwrap();
    let guess = |s: f64, z: &mut [f64]| z[..2].fill(FRAC_PI_2 * s * s * (3.0 - 2.0 * s));
    let motion = solve_extremal(&mut extremal, problem.time, &crate::sharp(), guess);
    assert!(motion.motion.status.is_converged(), "{}", motion.motion.status);
    assert!((motion.motion.cost - 145.131_137_54).abs() < 1e-7, "{}", motion.motion.cost);
    assert!(calls > 100, "{calls}");
}
