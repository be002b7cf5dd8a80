//! Random states.

use costate::EvalError;
use costate::configuration::ConfigurationSpace;
use costate::hamiltonian::Hamiltonian;
use costate::robot::{Joint, JointKind, Robot};
use fastrand::Rng;

/// A state, what acts on it, and the costate to contract with.
pub(super) struct Sample {
    pub x: Vec<f64>,
    pub u: Vec<f64>,
    pub y: Vec<f64>,
}

/// q uniform over its range, of floating and spherical joints a direction from the neutral configuration; v,
/// u and y uniform in +-1.
pub(super) fn random_sample(
    robot: &Robot,
    hamiltonian: &mut Hamiltonian<f64>,
    rng: &mut Rng,
    zero: bool,
) -> Result<Sample, EvalError> {
    let n = robot.dof();
    let mut within = |low: f64, high: f64| low + (high - low) * rng.f64();
    let mut d = Vec::with_capacity(n);
    for joint in robot.independent_joints() {
        let (low, high) = range(joint);
        let position = within(low, high);
        d.push(if zero { 0.0 } else { position });
    }
    let space = ConfigurationSpace::new(robot);
    let mut q = vec![0.0; space.nq()];
    space.integrate(&space.neutral(), &d, &mut q)?;
    let mut uniform = |count: usize| (0..count).map(|_| within(-1.0, 1.0)).collect::<Vec<_>>();
    let (v, u, y) = (uniform(n), uniform(n), uniform(2 * n));
    let p = hamiltonian.momentum(&q, &v)?;
    q.extend_from_slice(p);
    Ok(Sample { x: q, u, y })
}

/// Where a joint is sampled: between its limits; +-pi rad or +-1 m without (limits that coincide are none),
/// as much beyond or before a single one.
fn range(joint: &Joint) -> (f64, f64) {
    let reach = if joint.kind == JointKind::Revolute { std::f64::consts::PI } else { 1.0 };
    let (lower, upper) = (joint.limits.lower, joint.limits.upper);
    match (lower.is_finite(), upper.is_finite()) {
        (true, true) if lower < upper => (lower, upper),
        (true, false) => (lower, lower + 2.0 * reach),
        (false, true) => (upper - 2.0 * reach, upper),
        _ => (-reach, reach),
    }
}
