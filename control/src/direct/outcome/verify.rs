//! The motion integrated again with its torques.

use crate::bvp::collocation::error::defined;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::motion::spline::Spline;
use crate::direct::refine::resolution::Resolution;
use crate::numerics::dormand_prince::{DormandPrince, Stopped};
use crate::options::Verify;
use crate::problem::Problem;
use costate::EvalError;
use costate::lagrangian::Lagrangian;

/// A motion integrated again.
pub(crate) struct Again {
    /// (q, v) at the end.
    pub state: Option<Vec<f64>>,
    /// Largest miss of a given position, rate or pose of a tool at the end.
    pub defect: f64,
    /// Largest distance from the end of the motion, in parts of the largest values along it.
    pub relative: f64,
}

impl Again {
    /// Without an integration.
    pub fn unknown(relative: f64) -> Self {
        Self { state: None, defect: f64::INFINITY, relative }
    }
}

/// The motion integrated again with its torques.
pub(crate) fn integrate_again<D>(
    problem: &Problem,
    verify: Verify,
    interior: &mut Interior<D>,
    resolution: &Resolution,
) -> Again {
    let spline = &interior.spline;
    let n = spline.dof;
    let cut: f64 = resolution.cut.iter().sum();
    match verify {
        Verify::Full => {}
        // What is cut off torques moves the end by about as much, in parts of what moves the robot.
        Verify::Factors => return Again::unknown(cut / spline.duration()),
        Verify::None => return Again::unknown(f64::INFINITY),
    }
    let Ok(state) = integrate(problem, spline) else {
        return Again::unknown(f64::INFINITY);
    };
    let (mut defect, mut relative) = (0.0_f64, 0.0_f64);
    let mut last = vec![0.0; 3 * n];
    spline.in_interval(spline.mesh.intervals() - 1, 1.0, &mut last);
    let largest = |i: usize| {
        let values = (0..interior.points.count()).map(|p| interior.points.z(p)[i].abs());
        values.fold(f64::MIN_POSITIVE, f64::max)
    };
    // A joint that hardly moves is measured by the others.
    let of_all = |group: usize| (group * n..(group + 1) * n).map(largest).fold(0.0, f64::max);
    let least = [0, 1].map(|group| (constants::LEAST_SCALE * of_all(group)).max(constants::REST));
    for i in 0..2 * n {
        let size = largest(i).max(least[i / n]);
        relative = relative.max(defined((state[i] - last[i]).abs() / size));
        let is_given = interior.ends.given[spline.mesh.phases()][i] || interior.ends.tied.contains(&i);
        if is_given {
            defect = defect.max(defined((state[i] - last[i]).abs()));
        }
    }
    defect = defect.max(interior.model.tasks.miss(spline.mesh.phases(), &state));
    Again { state: Some(state), defect, relative }
}

/// The state (q, v) at the end when the torques of a motion, cut to their limits, move the robot from its
/// start.
fn integrate(problem: &Problem, spline: &Spline) -> Result<Vec<f64>, Stopped> {
    let n = spline.dof;
    let limits = problem.joint_limits();
    let robots = problem.robots();
    let models = robots.iter().map(|robot| [0, 1].map(|_| Lagrangian::<f64>::new(robot)));
    let mut models: Vec<_> = models.collect();
    let mut z = vec![0.0; 3 * n];
    spline.in_interval(0, 0.0, &mut z);
    let mut x = z[..2 * n].to_vec();
    let mut tau = vec![0.0; n];
    let mut integrator = DormandPrince::new(2 * n, constants::INTEGRATION);
    for k in 0..spline.mesh.intervals() {
        let (length, [inverse, forward]) = (spline.length(k), &mut models[spline.mesh.phase(k)]);
        integrator.integrate(&mut x, 0.0..length, |t, x, rate| -> Result<(), EvalError> {
            spline.in_interval(k, t / length, &mut z);
            tau.copy_from_slice(inverse.inverse_dynamics(&z[..n], &z[n..2 * n], &z[2 * n..])?);
            for (tau, limit) in tau.iter_mut().zip(&limits) {
                *tau = tau.clamp(limit.torque[0], limit.torque[1]);
            }
            rate.copy_from_slice(forward.evaluate(&x[..n], &x[n..], &tau)?);
            Ok(())
        })?;
    }
    Ok(x)
}
