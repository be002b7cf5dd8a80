//! Fixed weights on all kinematic quantities, as one function for the comparison of methods.

use super::function::Function;
use crate::error::{EvalError, check_length};
use crate::kinematics::{Kinematics, ReferenceFrame};
use crate::matrix::Matrix;
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Force, Vec3};
use nalgebra::Rotation3;

/// The first and second derivatives that are compared, by the number of the output; the last two are those of
/// robots with mass.
pub(super) const QUANTITIES: [[&str; 2]; 5] = [
    ["(w.V)_z of frames", "(w.V)_zz of frames"],
    ["(w.x)_z of frames", "(w.x)_zz of frames"],
    ["(w.e)_z of frames", "(w.e)_zz of frames"],
    ["(w.c)_z", "(w.c)_zz"],
    ["(w.h)_z", "(w.h)_zz"],
];

/// Numbers of the outputs.
const TWIST: usize = 0;
const POSITION: usize = 1;
const ORIENTATION: usize = 2;
const CENTRE: usize = 3;
const MOMENTUM: usize = 4;

/// `(q, v)` to sums over frames of `w . V` (in three conventions), `w . x` and `w . e`, then `w . c` and
/// `w . h`: twists, positions, orientation errors, centre of mass and momentum; from 2n inputs to five
/// outputs, or three without mass.
///
/// The frames are the last one on each link, and those that a wrench acts on.
#[derive(Clone, Debug)]
pub(super) struct WeightedMotion {
    tree: Tree,
    weighted: Vec<(usize, ReferenceFrame, Force<f64>)>,
    /// Weights of centre of mass and momentum, which robots without mass do not have.
    whole: Option<Force<f64>>,
    /// An orientation that is a half turn from none of the usual ones.
    desired: Rotation3<f64>,
}

/// First derivatives, one row for each output, and second ones, 2n rows for each output.
pub(super) type Derivatives<S> = [Matrix<S>; 2];

impl WeightedMotion {
    pub fn new(robot: &Robot) -> Self {
        let last = |i: usize| robot.frames().iter().rposition(|frame| frame.joint == Some(i));
        let mut frames: Vec<usize> = (0..robot.joints().len()).filter_map(last).collect();
        frames.extend(robot.wrenches().iter().map(|applied| applied.frame));
        frames.sort_unstable();
        frames.dedup();
        let all = frames.into_iter().flat_map(|frame| ReferenceFrame::ALL.map(|axes| (frame, axes)));
        // Numbers between -1 and 1 that belong to no symmetry of a robot.
        let weight = |k: usize| {
            let three = |k: usize| [0, 1, 2].map(|part| (1.0 + 2.3 * (3 * k + part) as f64).sin());
            Force { moment: Vec3::constant(three(2 * k)), force: Vec3::constant(three(2 * k + 1)) }
        };
        let weighted: Vec<_> = all.enumerate().map(|(k, (frame, axes))| (frame, axes, weight(k))).collect();
        let has_mass = robot.joints().iter().any(|joint| joint.inertia.mass > 0.0);
        Self {
            tree: Tree::from(robot),
            whole: has_mass.then(|| weight(weighted.len())),
            weighted,
            desired: Rotation3::from_euler_angles(0.4, -0.7, 1.1),
        }
    }

    /// The derivatives by the formulas of the workspace.
    #[inline]
    pub fn derivatives<S: Scalar>(
        &self,
        kinematics: &mut Kinematics<S>,
        q: &[S],
        v: &[S],
    ) -> Result<Derivatives<S>, EvalError> {
        let (n, outputs) = (q.len(), self.outputs());
        let mut found = [Matrix::zeros(outputs, 2 * n), Matrix::zeros(2 * n * outputs, 2 * n)];
        let [first, second] = &mut found;
        kinematics.set_state(q, v)?;
        for (frame, axes, weight) in &self.weighted {
            let (frame, axes, lifted) = (*frame, *axes, lift(weight));
            let [moment, force] = parts(weight);
            add_rows(first, [TWIST, 0], [moment, force], kinematics.twist_jacobian(frame, axes)?);
            add_rows(first, [TWIST, n], [moment, force], kinematics.jacobian(frame, axes)?);
            add_square(second, TWIST, kinematics.twist_hessian(frame, axes, &lifted)?);
            if axes != ReferenceFrame::LocalWorldAligned {
                continue;
            }
            add_rows(first, [POSITION, 0], [[0.0; 3], force], kinematics.jacobian(frame, axes)?);
            add_square(second, POSITION, kinematics.position_hessian(frame, &lifted.force.to_array())?);
            let moments = lifted.moment.to_array();
            let error = kinematics.contract_orientation_error(frame, &self.desired, &moments)?;
            add_rows(first, [ORIENTATION, 0], [moment, [0.0; 3]], error.jacobian);
            add_square(second, ORIENTATION, error.hessian);
        }
        if let Some(weight) = &self.whole {
            let ([moment, force], lifted) = (parts(weight), lift(weight));
            let [moments, forces] = [lifted.moment, lifted.force].map(Vec3::to_array);
            add_rows(first, [CENTRE, 0], [force, [0.0; 3]], kinematics.centre_of_mass()?.jacobian);
            add_square(second, CENTRE, kinematics.centre_of_mass_hessian(&forces)?);
            add_rows(first, [MOMENTUM, n], [moment, force], kinematics.momentum()?.matrix);
            let hessian = kinematics.momentum_hessian(&moments, &forces)?;
            // The momentum is linear in v: its derivative by q is that of the mixed block times v.
            for i in 0..n {
                let terms = v.iter().enumerate();
                first[(MOMENTUM, i)] = terms.fold(S::zero(), |sum, (j, &v)| sum + hessian[(i, n + j)] * v);
            }
            add_square(second, MOMENTUM, hessian);
        }
        Ok(found)
    }
}

/// Adds weighted rows of a Jacobian to a row, from a column on.
fn add_rows<S: Scalar>(
    first: &mut Matrix<S>,
    [row, start]: [usize; 2],
    weights: [[f64; 3]; 2],
    jacobian: &Matrix<S>,
) {
    let weights = weights.as_flattened();
    for j in 0..jacobian.columns() {
        let terms = weights.iter().take(jacobian.rows()).enumerate();
        first[(row, start + j)] += terms.fold(S::zero(), |sum, (k, &w)| sum + jacobian[(k, j)].times(w));
    }
}

/// Adds a matrix, of q or of (q, v), to the second derivatives of an output.
fn add_square<S: Scalar>(second: &mut Matrix<S>, output: usize, hessian: &Matrix<S>) {
    let start = output * second.columns();
    for i in 0..hessian.rows() {
        for j in 0..hessian.columns() {
            second[(start + i, j)] += hessian[(i, j)];
        }
    }
}

fn parts(weight: &Force<f64>) -> [[f64; 3]; 2] {
    [weight.moment.to_array(), weight.force.to_array()]
}

fn lift<S: Scalar>(weight: &Force<f64>) -> Force<S> {
    let [moment, force] = parts(weight);
    Force { moment: Vec3::constant(moment), force: Vec3::constant(force) }
}

impl Function for WeightedMotion {
    type Workspace<S: Scalar> = Kinematics<S>;
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.tree.dof()
    }

    fn outputs(&self) -> usize {
        if self.whole.is_some() { QUANTITIES.len() } else { CENTRE }
    }

    fn workspace<S: Scalar>(&self) -> Kinematics<S> {
        Kinematics::from_tree(self.tree.clone())
    }

    fn evaluate<S: Scalar>(
        &self,
        kinematics: &mut Kinematics<S>,
        z: &[S],
        outputs: &mut [S],
    ) -> Result<(), EvalError> {
        check_length("z", z, self.inputs())?;
        check_length("outputs", outputs, self.outputs())?;
        let (q, v) = z.split_at(self.tree.dof());
        kinematics.set_state(q, v)?;
        outputs.fill(S::zero());
        for (frame, axes, weight) in &self.weighted {
            let weight = lift::<S>(weight);
            outputs[TWIST] += weight.dot(kinematics.twist(*frame, *axes)?);
            if *axes == ReferenceFrame::LocalWorldAligned {
                let error = kinematics.orientation_error(*frame, &self.desired)?;
                outputs[POSITION] += weight.force.dot(Vec3::from(kinematics.pose(*frame)?.position));
                outputs[ORIENTATION] += weight.moment.dot(Vec3::from(error.vector));
            }
        }
        if let Some(weight) = &self.whole {
            let weight = lift::<S>(weight);
            outputs[CENTRE] = weight.force.dot(Vec3::from(kinematics.centre_of_mass()?.position));
            let momentum = kinematics.momentum()?;
            let (angular, linear) = (Vec3::from(momentum.angular), Vec3::from(momentum.linear));
            outputs[MOMENTUM] = weight.moment.dot(angular) + weight.force.dot(linear);
        }
        Ok(())
    }
}
