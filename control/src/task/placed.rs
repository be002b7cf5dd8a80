//! A robot that is placed at (q, v): frames, and how joints move points that are fixed to links.
//!
//! Joint i with the axis $\omega\_i$ moves a point x of a link beyond it by the column $c\_i$. With i equal
//! to j or nearer to the base than j,
//!
//! $$ x\_{,i} = c\_i = \nu\_i + \omega\_i \times x, \qquad x\_{,ij} = \omega\_i \times c\_j $$
//!
//! ($\nu\_i = o\_i \times \omega\_i$ for a revolute joint through $o\_i$; $\omega\_i = 0$ and $\nu\_i$ the
//! axis for a prismatic one). A direction that is fixed to a link obeys the same rule with $c\_i = \omega\_i
//! \times a$.

use costate::EvalError;
use costate::kinematics::Kinematics;
use costate::robot::{JointKind, Robot};
use nalgebra::{Matrix3, Vector3};

/// A frame of the robot and the joints that move it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Carried {
    /// Its number in [`Robot::frames`].
    pub frame: usize,
    /// The joints from the tip to the base.
    pub path: Vec<usize>,
    /// From the origin of each of them to that of the one before it, the first one to that of the frame, at
    /// q = 0 (m).
    pub lengths: Vec<f64>,
}

impl Carried {
    pub fn new(robot: &Robot, frame: usize) -> Self {
        let joint = robot.frames().get(frame).and_then(|frame| frame.joint);
        let path: Vec<usize> = std::iter::successors(joint, |&joint| robot.joints()[joint].parent).collect();
        let own = robot.frames().get(frame).map_or(0.0, |frame| frame.placement.translation.norm());
        let beyond = path.iter().map(|&joint| robot.joints()[joint].placement.translation.norm());
        let lengths = std::iter::once(own).chain(beyond).take(path.len()).collect();
        Self { frame, path, lengths }
    }
}

/// Angular and linear part of a joint's motion at unit rate, at the origin of the world.
#[derive(Clone, Copy, Debug)]
struct Screw {
    angular: Vector3<f64>,
    linear: Vector3<f64>,
}

/// A joint as the kinematics do not tell it.
#[derive(Clone, Copy, Debug)]
struct Joint {
    kind: JointKind,
    /// Axis in its own frame.
    axis: Vector3<f64>,
    /// The coordinate that moves it, and its own rate over that of the coordinate.
    coordinate: usize,
    ratio: f64,
    /// Its position where that of the coordinate is 0.
    offset: f64,
}

/// A symmetric matrix of derivatives by (q, v), 2n x 2n row by row, to which terms in q are added.
#[derive(Debug)]
pub(super) struct Hessian<'a> {
    pub entries: &'a mut [f64],
    /// 2n.
    pub width: usize,
}

impl Hessian<'_> {
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        self.entries[self.width * i + j] += value;
    }
}

/// The workspace; no call allocates.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub kinematics: Kinematics<f64>,
    joints: Vec<Joint>,
    screws: Vec<Screw>,
    columns: Vec<Vector3<f64>>,
    /// Room for the derivatives of a vector by (q, v).
    pub rates: Vec<Vector3<f64>>,
}

impl Placed {
    pub fn new(robot: &Robot) -> Self {
        let coordinate = |joint: usize| robot.independent_indices().iter().position(|&i| i == joint);
        let joints: Vec<Joint> = robot
            .joints()
            .iter()
            .enumerate()
            .map(|(i, joint)| {
                let (master, ratio, offset) =
                    joint.mimic.as_ref().map_or((i, 1.0, 0.0), |m| (m.joint, m.ratio, m.offset));
                let coordinate = coordinate(master).unwrap_or_default();
                Joint { kind: joint.kind, axis: joint.axis, coordinate, ratio, offset }
            })
            .collect();
        let zero = Vector3::zeros();
        Self {
            kinematics: Kinematics::new(robot),
            screws: vec![Screw { angular: zero, linear: zero }; joints.len()],
            columns: vec![zero; joints.len()],
            rates: vec![zero; 2 * robot.dof()],
            joints,
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.kinematics.dof()
    }

    /// Places the robot for values.
    pub fn place(&mut self, q: &[f64], v: &[f64]) -> Result<(), EvalError> {
        self.kinematics.set_state(q, v)
    }

    /// The screws of all joints where the robot is.
    pub fn fill_screws(&mut self) -> Result<(), EvalError> {
        for (i, (joint, screw)) in self.joints.iter().zip(&mut self.screws).enumerate() {
            // After the frame of the world come those of the joints.
            let (rotation, origin) = frame(&self.kinematics, 1 + i)?;
            let axis = rotation * joint.axis;
            *screw = match joint.kind {
                JointKind::Revolute => Screw { angular: axis, linear: origin.cross(&axis) },
                JointKind::Prismatic => Screw { angular: Vector3::zeros(), linear: axis },
            };
        }
        Ok(())
    }

    /// Rotation and origin of a frame in the world.
    pub fn frame(&self, number: usize) -> Result<(Matrix3<f64>, Vector3<f64>), EvalError> {
        frame(&self.kinematics, number)
    }

    /// The column `c_j` of a point x that joint j moves.
    pub fn point(&self, j: usize, x: &Vector3<f64>) -> Vector3<f64> {
        let Screw { angular, linear } = &self.screws[j];
        linear + angular.cross(x)
    }

    /// The column of a direction.
    pub fn turned(&self, j: usize, a: &Vector3<f64>) -> Vector3<f64> {
        self.screws[j].angular.cross(a)
    }

    /// The coordinate that moves a joint, and the joint's rate at the unit rate of the coordinate.
    pub fn coordinate(&self, j: usize) -> (usize, f64) {
        (self.joints[j].coordinate, self.joints[j].ratio)
    }

    /// Whether a joint is prismatic.
    pub fn slides(&self, j: usize) -> bool {
        self.joints[j].kind == JointKind::Prismatic
    }

    /// The position of a joint where that of its coordinate is 0.
    pub fn offset(&self, j: usize) -> f64 {
        self.joints[j].offset
    }

    /// Fills the columns of a point of a link that this path carries.
    pub fn see_point(&mut self, path: &[usize], x: &Vector3<f64>) {
        for &j in path {
            self.columns[j] = self.point(j, x);
        }
    }

    /// Fills the columns of a direction.
    pub fn see_direction(&mut self, path: &[usize], a: &Vector3<f64>) {
        for &j in path {
            self.columns[j] = self.turned(j, a);
        }
    }

    /// Adds `f . x_q` for what was seen last, at most 2n entries.
    pub fn add_gradient(&self, path: &[usize], f: &Vector3<f64>, gradient: &mut [f64]) {
        for &j in path {
            let (at, ratio) = self.coordinate(j);
            gradient[at] += ratio * f.dot(&self.columns[j]);
        }
    }

    /// Adds the second derivatives of a function of what was seen last (the vector x), with its gradient f
    /// and, unless it is linear, its Hessian F in x: `(f x w_i) . c_j + c_i'F c_j`, i nearer to the base.
    pub fn add_second(
        &self,
        path: &[usize],
        f: &Vector3<f64>,
        second: Option<&Matrix3<f64>>,
        hessian: &mut Hessian<'_>,
    ) {
        for (place, &j) in path.iter().enumerate() {
            let (column, (at_j, ratio_j)) = (&self.columns[j], self.coordinate(j));
            let weighted = second.map(|second| second * column);
            for &i in &path[place..] {
                let (at_i, ratio_i) = self.coordinate(i);
                let mut entry = f.cross(&self.screws[i].angular).dot(column);
                if let Some(weighted) = &weighted {
                    entry += weighted.dot(&self.columns[i]);
                }
                entry *= ratio_i * ratio_j;
                hessian.add(at_i, at_j, entry);
                if i != j {
                    hessian.add(at_j, at_i, entry);
                }
            }
        }
    }
}

fn frame(kinematics: &Kinematics<f64>, number: usize) -> Result<(Matrix3<f64>, Vector3<f64>), EvalError> {
    let pose = kinematics.pose(number)?;
    let [a, b, c] = pose.rotation;
    let rotation = Matrix3::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
    Ok((rotation, Vector3::from(pose.position)))
}
