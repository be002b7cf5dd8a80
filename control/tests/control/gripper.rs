//! A parallel gripper with two loops closes: in five coordinates with four constraints its motion costs what
//! that of one mass does, whose energies are written by hand below.

use super::reduced::{Energies, Reduced, between};
use costate::dynamics::Automatic;
use costate::robot::LoadOptions;
use costate::scalar::Scalar;
use costate_control::{DirectDynamics, ProblemFile, Solver, SolverOptions, Status};

/// By the angle of the motor. Outer and inner links turn by it, fingers go along circles: the mass is
/// constant.
#[derive(Clone, Copy)]
struct Motor {
    mass: f64,
    /// Masses times y and z of their places at zero (kg m), by which the weights have potential energy.
    moment: [f64; 2],
}

impl Motor {
    /// From the figures of `robots/gripper.toml`, of both sides.
    fn new() -> Self {
        let [outer, finger, inner] = [0.023_093_03, 0.016_022_2, 0.022_164_2];
        let places = [[0.027_984_44, 0.012_088_52], [0.0376, 0.043], [0.018_162_4, 0.021_265_8]];
        let (mut mass, mut moment) = (1e-3 + 2.0 * (8.575_765e-6 + 6.717_33e-6), [0.0; 2]);
        for (m, [y, z]) in [outer, finger, inner].into_iter().zip(places) {
            mass += 2.0 * m * (y * y + z * z);
            moment = [moment[0] + 2.0 * m * y, moment[1] + 2.0 * m * z];
        }
        Self { mass, moment }
    }
}

impl Energies for Motor {
    fn energies<S: Scalar>(&self, angle: S) -> [S; 2] {
        let (sin, cos) = angle.sin_cos();
        let [y, z] = self.moment;
        [S::from_f64(self.mass), sin.times(9.81 * y) + cos.times(9.81 * z)]
    }
}

#[test]
fn a_gripper_costs_what_the_one_mass_of_its_motor_does() {
    let read = ProblemFile::read("../examples/problems/gripper_close.toml", LoadOptions::default()).unwrap();
    let problem = read.problem;
    let options = SolverOptions::default().with_tolerance(1e-8);
    let solution = Solver::new(&problem, options.clone()).unwrap().solve();
    assert_eq!(solution.motion.status, Status::Converged);
    let mut alone =
        DirectDynamics::new(Automatic::<Reduced<_>>::new(Reduced(Motor::new())), &between([0.0, 0.6], 0.4))
            .unwrap()
            .with_state_limits(&[0.0, -2.0], &[0.81, 2.0])
            .unwrap();
    let alone = alone.solve(&options).unwrap();
    assert!(alone.status.is_converged(), "{:?}", alone.status);
    let cost = solution.total();
    assert!((cost / alone.cost - 1.0).abs() < 1e-7, "{cost} {}", alone.cost);
    // The rate limit is kept for a part of the way.
    let fastest = solution.trajectory.v.iter().fold(0.0, |most: f64, v| most.max(v[0]));
    assert!(fastest > 2.0 - 1e-6 && fastest < 2.0 + 1e-6, "{fastest}");
    for one in &solution.constraints {
        assert!(one.drift < 1e-10, "{}: {}", one.name, one.drift);
    }
    // The fingers stay parallel to the base, and the sides mirror each other.
    for q in &solution.trajectory.q {
        let off = [q[0] + q[1], q[0] - q[2], q[0] + q[3], q[0] - q[4]];
        assert!(off.iter().all(|off| off.abs() < 1e-9), "{q:?}");
    }
    assert!(solution.end_defect < 1e-6, "{}", solution.end_defect);
}
