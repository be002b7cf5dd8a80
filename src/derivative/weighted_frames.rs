//! Weighted sums of what frames and the whole robot do, as one function for the comparison of methods.

use super::function::Function;
use super::positions::{Moved, Positions};
use super::row::{Row, matrix};
use crate::configuration::FreeKinematics;
use crate::error::{EvalError, check_length};
use crate::kinematics::{Kinematics, ReferenceFrame};
use crate::matrix::{Matrix, dot};
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Force, Vec3};
use nalgebra::{Rotation3, Vector3};

/// `(q, v) -> (w.V, w.x, w.e, w.c, w.h)`, from 2n inputs to five outputs: fixed weights times the twists V of
/// frames in all conventions, their positions x and orientation errors e, the centre of mass c, and the
/// momentum h of all links about it. The frames are the last one on each link, and those that a wrench acts
/// on.
///
/// With floating and spherical joints the first n inputs are a direction, as in
/// [`PhaseVelocity`](super::PhaseVelocity).
#[derive(Clone, Debug)]
pub(super) struct WeightedFrames {
    tree: Tree,
    pub positions: Positions,
    frames: Vec<Weighted>,
    /// Of the centre of mass and of momentum.
    centre: [f64; 3],
    momentum: Force<f64>,
    /// Whether there is a centre of mass.
    has_mass: bool,
}

/// A frame and its weights.
#[derive(Clone, Debug)]
struct Weighted {
    frame: usize,
    twists: [Force<f64>; 3],
    position: [f64; 3],
    orientation: [f64; 3],
    /// What the orientation should be.
    desired: Rotation3<f64>,
}

/// Outputs.
const TWISTS: usize = 0;
const POSITIONS: usize = 1;
const ORIENTATIONS: usize = 2;
const CENTRE: usize = 3;
const MOMENTUM: usize = 4;
const OUTPUTS: usize = 5;

/// The first derivatives of each output, 1 x 2n, and the second ones, 2n x 2n.
#[derive(Clone, Debug)]
pub(super) struct WeightedDerivatives<S> {
    pub first: Vec<Matrix<S>>,
    pub second: Vec<Matrix<S>>,
}

impl<S: Scalar> WeightedDerivatives<S> {
    /// Of these entries: (output, column) and (output, row, column).
    pub fn new(n: usize, first: impl Fn(usize, usize) -> S, second: impl Fn([usize; 3]) -> S) -> Self {
        Self {
            first: (0..OUTPUTS).map(|k| matrix(1, 2 * n, |_, j| first(k, j))).collect(),
            second: (0..OUTPUTS).map(|k| matrix(2 * n, 2 * n, |i, j| second([k, i, j]))).collect(),
        }
    }

    /// With other numbers.
    pub fn map<T: Scalar>(&self, lift: impl Fn(&Matrix<S>) -> Matrix<T>) -> WeightedDerivatives<T> {
        let all = |matrices: &[Matrix<S>]| matrices.iter().map(&lift).collect();
        WeightedDerivatives { first: all(&self.first), second: all(&self.second) }
    }
}

/// Numbers between -1 and 1 that belong to no symmetry of a robot.
struct Weights(usize);

impl Weights {
    fn next(&mut self) -> [f64; 3] {
        self.0 += 1;
        [0, 1, 2].map(|part| (1.0 + 2.3 * (3 * (self.0 - 1) + part) as f64).sin())
    }

    fn next_force(&mut self) -> Force<f64> {
        Force { moment: Vec3::constant(self.next()), force: Vec3::constant(self.next()) }
    }
}

/// How derivatives by q and v are scaled, see [`Row`].
const BY_POSITION: &[i8] = &[-1];
const BY_STATE: &[i8] = &[-1, -1];
const PLAIN: &[i8] = &[0];

impl WeightedFrames {
    pub fn new(robot: &Robot) -> Self {
        let last = |i: usize| robot.frames().iter().rposition(|frame| frame.joint == Some(i));
        let mut frames: Vec<usize> = (0..robot.joints().len()).filter_map(last).collect();
        frames.extend(robot.wrenches().iter().map(|applied| applied.frame));
        frames.sort_unstable();
        frames.dedup();
        let (mut weights, tree) = (Weights(0), Tree::from(robot));
        let weighted = |frame| Weighted {
            frame,
            twists: [(); 3].map(|()| weights.next_force()),
            position: weights.next(),
            orientation: weights.next(),
            desired: Rotation3::new(Vector3::from(weights.next())),
        };
        let frames = frames.into_iter().map(weighted).collect();
        Self {
            positions: Positions::new(&tree),
            frames,
            centre: weights.next(),
            momentum: weights.next_force(),
            has_mass: tree.joints().iter().any(|joint| joint.parent.is_none() && joint.subtree_mass > 0.0),
            tree,
        }
    }

    /// Compares with the derivatives by the formulas of the workspaces.
    #[inline]
    pub fn rows<S: Scalar>(
        &self,
        (kinematics, free): (&mut Kinematics<S>, &mut FreeKinematics<S>),
        [q, v]: [&[S]; 2],
        to: &WeightedDerivatives<S>,
        rows: &mut Vec<Row<S>>,
    ) -> Result<(), EvalError> {
        if self.positions.is_moved() {
            self.rows_with_free_joints(free, [q, v], to, rows)
        } else {
            self.all_rows(kinematics, [q, v], to, rows)
        }
    }

    /// Of robots without floating and spherical joints.
    #[inline]
    fn all_rows<S: Scalar>(
        &self,
        kinematics: &mut Kinematics<S>,
        [q, v]: [&[S]; 2],
        to: &WeightedDerivatives<S>,
        rows: &mut Vec<Row<S>>,
    ) -> Result<(), EvalError> {
        let n = v.len();
        kinematics.set_state(q, v)?;
        let mut twists = (Matrix::zeros(1, 2 * n), Matrix::zeros(2 * n, 2 * n));
        let mut positions = (Matrix::zeros(1, n), Matrix::zeros(n, n));
        let mut orientations = positions.clone();
        for one in &self.frames {
            for (axes, weight) in ReferenceFrame::ALL.into_iter().zip(&one.twists) {
                let (six, lifted) = (flat(weight), lift(weight));
                add_row(&mut twists.0, 0, &six, kinematics.twist_jacobian(one.frame, axes)?, 0);
                add_row(&mut twists.0, n, &six, kinematics.jacobian(one.frame, axes)?, 0);
                add(&mut twists.1, kinematics.twist_hessian(one.frame, axes, &lifted)?);
            }
            let jacobian = kinematics.jacobian(one.frame, ReferenceFrame::LocalWorldAligned)?;
            add_row(&mut positions.0, 0, &one.position, jacobian, 3);
            let weight = one.position.map(S::from_f64);
            add(&mut positions.1, kinematics.position_hessian(one.frame, &weight)?);
            let weight = one.orientation.map(S::from_f64);
            let all = kinematics.contract_orientation_error(one.frame, &one.desired, &weight)?;
            add_row(&mut orientations.0, 0, &one.orientation, all.jacobian, 0);
            add(&mut orientations.1, all.hessian);
        }
        let mut push = |names: [&'static str; 2], k: usize, found: (Matrix<S>, Matrix<S>), scales| {
            let (first, second) = found;
            let columns = first.columns();
            let expected = [to.first[k].block(0, 0, 1, columns), to.second[k].block(0, 0, columns, columns)];
            rows.push(Row::new([names[0], "analytic"], first.view(), expected[0], [PLAIN, scales]));
            rows.push(Row::new([names[1], "analytic"], second.view(), expected[1], [scales, scales]));
        };
        push(["(w.V)_z of frames", "(w.V)_zz of frames"], TWISTS, twists, BY_STATE);
        push(["(w.x)_q of frames", "(w.x)_qq of frames"], POSITIONS, positions, BY_POSITION);
        push(["(w.e)_q of frames", "(w.e)_qq of frames"], ORIENTATIONS, orientations, BY_POSITION);
        if self.has_mass {
            let mut first = Matrix::zeros(1, n);
            add_row(&mut first, 0, &self.centre, kinematics.centre_of_mass()?.jacobian, 0);
            let second = kinematics.centre_of_mass_hessian(&self.centre.map(S::from_f64))?.clone();
            push(["(w.c)_q", "(w.c)_qq"], CENTRE, (first, second), BY_POSITION);
            let weight = lift::<S>(&self.momentum);
            let [k, l] = [weight.moment, weight.force].map(Vec3::to_array);
            let second = kinematics.momentum_hessian(&k, &l)?.clone();
            let name = ["(w.h)_zz", "analytic"];
            rows.push(Row::new(name, second.view(), to.second[MOMENTUM].view(), [BY_STATE, BY_STATE]));
            self.momentum_row(kinematics.momentum()?.matrix, to, rows);
        }
        Ok(())
    }

    /// Of robots with floating or spherical joints, whose kinematics has fewer second derivatives.
    #[inline]
    fn rows_with_free_joints<S: Scalar>(
        &self,
        kinematics: &mut FreeKinematics<S>,
        [q, v]: [&[S]; 2],
        to: &WeightedDerivatives<S>,
        rows: &mut Vec<Row<S>>,
    ) -> Result<(), EvalError> {
        let n = v.len();
        kinematics.set_state(q, v)?;
        let (mut by_velocity, mut along) = (Matrix::zeros(1, n), Matrix::zeros(1, 1));
        let (mut by_position, mut positions) = (Matrix::zeros(1, n), Matrix::zeros(n, n));
        for one in &self.frames {
            for (axes, weight) in ReferenceFrame::ALL.into_iter().zip(&one.twists) {
                add_row(&mut by_velocity, 0, &flat(weight), kinematics.jacobian(one.frame, axes)?, 0);
                along[(0, 0)] += lift::<S>(weight).dot(kinematics.acceleration(one.frame, axes)?);
            }
            let jacobian = kinematics.jacobian(one.frame, ReferenceFrame::LocalWorldAligned)?;
            add_row(&mut by_position, 0, &one.position, jacobian, 3);
            add(&mut positions, kinematics.position_hessian(one.frame, &one.position.map(S::from_f64))?);
        }
        let mut push = |name, found: &Matrix<S>, expected, scales| {
            rows.push(Row::new([name, "analytic"], found.view(), expected, scales));
        };
        let (first, second) = (&to.first, &to.second);
        let row = [PLAIN, BY_POSITION];
        push("(w.V)_v of frames", &by_velocity, first[TWISTS].block(0, n, 1, n), row);
        let rate = matrix(1, 1, |_, _| dot(first[TWISTS].row(0), v));
        push("(w.V)_q v of frames", &along, rate.view(), [PLAIN, PLAIN]);
        push("(w.x)_q of frames", &by_position, first[POSITIONS].block(0, 0, 1, n), row);
        let expected = second[POSITIONS].block(0, 0, n, n);
        push("(w.x)_qq of frames", &positions, expected, [BY_POSITION, BY_POSITION]);
        if self.has_mass {
            let mut by_position = Matrix::zeros(1, n);
            add_row(&mut by_position, 0, &self.centre, kinematics.centre_of_mass()?.jacobian, 0);
            push("(w.c)_q", &by_position, first[CENTRE].block(0, 0, 1, n), row);
            self.momentum_row(kinematics.momentum()?.matrix, to, rows);
        }
        Ok(())
    }

    /// The centroidal momentum matrix.
    fn momentum_row<S: Scalar>(
        &self,
        found: &Matrix<S>,
        to: &WeightedDerivatives<S>,
        rows: &mut Vec<Row<S>>,
    ) {
        let n = found.columns();
        let mut by_velocity = Matrix::zeros(1, n);
        add_row(&mut by_velocity, 0, &flat(&self.momentum), found, 0);
        let expected = to.first[MOMENTUM].block(0, n, 1, n);
        rows.push(Row::new(["(w.h)_v", "analytic"], by_velocity.view(), expected, [PLAIN, BY_POSITION]));
    }
}

/// Adds the sum of weighted rows of a matrix, from one on, to a row, from a column on.
#[inline]
fn add_row<S: Scalar>(to: &mut Matrix<S>, column: usize, weights: &[f64], rows: &Matrix<S>, from: usize) {
    for j in 0..rows.columns() {
        for (k, &weight) in weights.iter().enumerate() {
            to[(0, column + j)] += rows[(from + k, j)].times(weight);
        }
    }
}

#[inline]
fn add<S: Scalar>(to: &mut Matrix<S>, terms: &Matrix<S>) {
    *to = matrix(to.rows(), to.columns(), |i, j| to[(i, j)] + terms[(i, j)]);
}

fn flat(weight: &Force<f64>) -> [f64; 6] {
    let ([a, b, c], [d, e, f]) = (weight.moment.to_array(), weight.force.to_array());
    [a, b, c, d, e, f]
}

fn lift<S: Scalar>(weight: &Force<f64>) -> Force<S> {
    Force { moment: Vec3::constant(weight.moment.to_array()), force: Vec3::constant(weight.force.to_array()) }
}

/// `w . x`.
fn weighted<S: Scalar>(weight: [f64; 3], x: [S; 3]) -> S {
    Vec3::<S>::constant(weight).dot(Vec3::from(x))
}

impl Function for WeightedFrames {
    type Workspace<S: Scalar> = (FreeKinematics<S>, Moved<S>);
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.tree.dof()
    }

    fn outputs(&self) -> usize {
        OUTPUTS
    }

    fn workspace<S: Scalar>(&self) -> Self::Workspace<S> {
        (FreeKinematics::from_tree(self.tree.clone()), self.positions.room())
    }

    fn evaluate<S: Scalar>(
        &self,
        (kinematics, moved): &mut Self::Workspace<S>,
        z: &[S],
        outputs: &mut [S],
    ) -> Result<(), EvalError> {
        check_length("z", z, self.inputs())?;
        check_length("outputs", outputs, self.outputs())?;
        let (q, v) = z.split_at(self.tree.dof());
        kinematics.set_state(self.positions.of(moved, q)?, v)?;
        outputs.fill(S::zero());
        for one in &self.frames {
            for (axes, weight) in ReferenceFrame::ALL.into_iter().zip(&one.twists) {
                outputs[TWISTS] += lift::<S>(weight).dot(kinematics.twist(one.frame, axes)?);
            }
            outputs[POSITIONS] += weighted(one.position, kinematics.pose(one.frame)?.position);
            let error = kinematics.orientation_error(one.frame, &one.desired)?;
            outputs[ORIENTATIONS] += weighted(one.orientation, error.vector);
        }
        if self.has_mass {
            outputs[CENTRE] = weighted(self.centre, kinematics.centre_of_mass()?.position);
            let momentum = kinematics.momentum()?;
            let [angular, linear] = [self.momentum.moment, self.momentum.force].map(Vec3::to_array);
            outputs[MOMENTUM] = weighted(angular, momentum.angular) + weighted(linear, momentum.linear);
        }
        Ok(())
    }
}
