//! The tasks of the comparison.

use super::problem::Problem;
use super::reach::{Coordinates, Reach};
use costate::EvalError;
use costate::dynamics::{AutomaticCost, QuadraticCost};
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::robot::Robot;
use costate::step::{RungeKutta4, Step};
use nalgebra::DVector;
use std::error::Error;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::path::{Path, PathBuf};

/// A problem with its start and description.
pub struct Task<P, L, T> {
    pub title: String,
    pub about: &'static str,
    pub problem: Problem<P, L, T>,
    /// The initial state.
    pub x: Vec<f64>,
    /// The initial controls.
    pub u: Vec<DVector<f64>>,
}

/// One step of a robot with state (q, p).
pub type WithMomenta = RungeKutta4<f64, HamiltonianSecondOrder<f64>>;
/// One step of a robot with state (q, v).
pub type WithVelocities = RungeKutta4<f64, LagrangianSecondOrder<f64>>;
/// The cost of effort and of posture.
pub type Quadratic = QuadraticCost<f64>;

fn robot(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../robots").join(file)
}

/// The two-link arm from `from` to rest at `to` (rad) in two seconds, in 100 steps, from zero controls.
fn two_link(
    [title, about]: [&'static str; 2],
    gravity: f64,
    [from, to]: [[f64; 2]; 2],
    effort: f64,
    limit: f64,
) -> Result<Task<WithMomenta, Quadratic, Quadratic>, Box<dyn Error>> {
    let robot = Robot::from_file(robot("two_link.toml"))?.with_gravity([0.0, -gravity, 0.0])?;
    let running = QuadraticCost::running(&[0.0; 4], &[effort; 2]);
    let terminal = QuadraticCost::terminal(&[100.0; 4]).about(&[to[0], to[1], 0.0, 0.0], &[]);
    let step = RungeKutta4::new(HamiltonianSecondOrder::new(&robot));
    Ok(Task {
        title: title.to_owned(),
        about,
        problem: Problem::new(step, (running, terminal), 0.02, [&[-limit; 2], &[limit; 2]]),
        x: vec![from[0], from[1], 0.0, 0.0],
        u: vec![DVector::zeros(2); 100],
    })
}

/// A large motion of the two-link arm in the horizontal plane.
///
/// # Errors
/// An unreadable robot file; likewise below.
pub fn large_motion() -> Result<Task<WithMomenta, Quadratic, Quadratic>, Box<dyn Error>> {
    let about = "Two-link arm in the horizontal plane, state (q, p), from rest at (0, 0) towards rest at (2, 1) rad in\n\
                 2 s, 100 steps. Cost: integral of u'u/2, plus 50 times the squared distance from the goal at the\n\
                 end, in rad and N m s. The end is soft and effort is most of the cost: the costate does not vanish\n\
                 at the solution, nor does what Gauss-Newton drops.";
    two_link(["two-link arm, large motion", about], 0.0, [[0.0, 0.0], [2.0, 1.0]], 1.0, f64::INFINITY)
}

/// The same with active bounds.
pub fn large_motion_with_bounds() -> Result<Task<WithMomenta, Quadratic, Quadratic>, Box<dyn Error>> {
    let about = "The same with |u| <= 4 N m: both joints saturate for a large part of the motion.";
    two_link(["two-link arm, large motion, bounds", about], 0.0, [[0.0, 0.0], [2.0, 1.0]], 1.0, 4.0)
}

/// Swing-up of the two-link arm with motors that cannot lift it statically.
pub fn swing_up() -> Result<Task<WithMomenta, Quadratic, Quadratic>, Box<dyn Error>> {
    let about = "Two-link arm in the vertical plane, state (q, p), from hanging towards rest upright in 2 s, 100 steps,\n\
                 |u| <= 10 N m: a quarter of the 39 N m that hold the arm stretched out, so it must swing. Cost:\n\
                 integral of u'u/20, plus 50 times the squared distance from the goal at the end.";
    two_link(
        ["two-link arm, swing-up, bounds", about],
        9.81,
        [[-FRAC_PI_2, 0.0], [FRAC_PI_2, 0.0]],
        0.1,
        10.0,
    )
}

const UR5: Arm<6> = Arm {
    file: "ur5.urdf",
    tip: [0.0, 0.0, 0.1],
    start: [0.0, -1.2, 1.6, -2.0, -FRAC_PI_2, 0.0],
    goal: [-0.3, 0.5, 0.6],
};
const PANDA: Arm<7> = Arm {
    file: "panda.urdf",
    tip: [0.0, 0.0, 0.2],
    start: [0.0, -FRAC_PI_4, 0.0, -3.0 * FRAC_PI_4, 0.0, FRAC_PI_2, FRAC_PI_4],
    goal: [0.1, 0.5, 0.4],
};

/// UR5, state (q, p).
pub fn ur5_with_momenta() -> Result<Task<WithMomenta, Quadratic, AutomaticCost<Reach>>, Box<dyn Error>> {
    let about = "UR5 with the torque limits of its description: its tip from rest towards rest at a point 0.8 m away\n\
                 in 1 s, 100 steps. Cost: integral of 0.005 |u - u_hold|^2 + 0.5 |q - q_start|^2, where u_hold holds\n\
                 the first posture, plus at the end 500 times the squared distance of the tip from the point (m)\n\
                 and 10 times the kinetic energy (J). The search starts from u_hold. State (q, p).";
    let step = |robot: &Robot| RungeKutta4::new(HamiltonianSecondOrder::new(robot));
    UR5.reach(["UR5, reaching, momenta", about], Coordinates::Momenta, step)
}

/// UR5, state (q, v).
pub fn ur5_with_velocities() -> Result<Task<WithVelocities, Quadratic, AutomaticCost<Reach>>, Box<dyn Error>>
{
    let about = "The same task with state (q, v).";
    let step = |robot: &Robot| RungeKutta4::new(LagrangianSecondOrder::new(robot));
    UR5.reach(["UR5, reaching, velocities", about], Coordinates::Velocities, step)
}

/// Panda, state (q, p).
pub fn panda_with_momenta() -> Result<Task<WithMomenta, Quadratic, AutomaticCost<Reach>>, Box<dyn Error>> {
    let about = "Panda with the torque limits of its description, its tip towards a point 0.6 m away; duration and\n\
                 costs as for the UR5. State (q, p).";
    let step = |robot: &Robot| RungeKutta4::new(HamiltonianSecondOrder::new(robot));
    PANDA.reach(["Panda, reaching, momenta", about], Coordinates::Momenta, step)
}

/// A reaching task for the tip of a robot.
struct Arm<const N: usize> {
    file: &'static str,
    /// In the frame of the last joint (m).
    tip: [f64; 3],
    /// Posture at the start (rad).
    start: [f64; N],
    /// In the world (m).
    goal: [f64; 3],
}

impl<const N: usize> Arm<N> {
    /// In one second, in 100 steps, from the torques that hold the arm where it is.
    fn reach<P: Step<f64>>(
        &self,
        [title, about]: [&'static str; 2],
        coordinates: Coordinates,
        step: impl Fn(&Robot) -> P,
    ) -> Result<Task<P, Quadratic, AutomaticCost<Reach>>, Box<dyn Error>> {
        let robot = Robot::from_file(robot(self.file))?;
        let limits: Vec<f64> = robot.independent_joints().map(|joint| joint.limits.effort).collect();
        let hold = holding(&robot, &self.start)?;
        let below: Vec<f64> = limits.iter().map(|limit| -limit).collect();
        let mut x = self.start.to_vec();
        x.resize(2 * N, 0.0);
        let mut posture = vec![1.0; N];
        posture.resize(2 * N, 0.0);
        let running = QuadraticCost::running(&posture, &[0.01; N]).about(&x, hold.as_slice());
        let terminal = AutomaticCost::terminal(Reach {
            robot: robot.clone(),
            tip: self.tip,
            goal: self.goal,
            distance_weight: 1000.0,
            energy_weight: 10.0,
            coordinates,
        });
        Ok(Task {
            title: title.to_owned(),
            about,
            problem: Problem::new(step(&robot), (running, terminal), 0.01, [&below, &limits]),
            x,
            u: vec![hold; 100],
        })
    }
}

/// The torques that hold a robot in a posture.
fn holding(robot: &Robot, q: &[f64]) -> Result<DVector<f64>, EvalError> {
    Ok(DVector::from_column_slice(Lagrangian::<f64>::new(robot).gravity(q)?))
}
