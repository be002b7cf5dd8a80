//! A robot with its frames turned the way the kernels want them.
//!
//! Each joint frame is turned so that its z axis is the joint axis, then about z so that the placement in the
//! parent's frame becomes `Rz(gamma) (r + Rx(alpha) .)`. The frame of a revolute parent (or of the world) takes up
//! the gamma of its first child, as in the modified Denavit-Hartenberg convention; q then carries a constant offset.
//! Nothing but constants changes: q, v, p, M and every derivative are those of the original frames.

use super::link::snap;
use super::{Friction, JointKind, Robot, Spring};
use crate::spatial::{ConstantInertia, FixedScrew};
use nalgebra::{DMatrix, Matrix3, Vector3};

/// Constants of one joint and its link, in turned frames.
#[derive(Clone, Debug, PartialEq)]
pub struct JointFrame {
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// Index of the parent joint; `None` for the world.
    pub parent: Option<usize>,
    /// Placement in the parent's frame.
    pub screw: FixedScrew,
    /// Added to q of a revolute joint (rad).
    pub offset: f64,
    /// Inertia of the link about the origin of the frame.
    pub inertia: ConstantInertia,
    /// Mass of the link and everything it carries (kg).
    pub subtree_mass: f64,
    /// Joint spring.
    pub spring: Spring,
    /// Joint friction.
    pub friction: Friction,
}

/// The model that the kernels run on; built from a [`Robot`] once.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    names: Vec<String>,
    joints: Vec<JointFrame>,
    gravity: [f64; 3],
    armature: Vec<(usize, usize, f64)>,
    path_starts: Vec<usize>,
    paths: Vec<usize>,
}

impl Tree {
    /// Number of joints, n.
    #[expect(clippy::len_without_is_empty, reason = "a robot has at least one joint")]
    pub fn len(&self) -> usize {
        self.joints.len()
    }

    /// The joints, parents before children.
    pub fn joints(&self) -> &[JointFrame] {
        &self.joints
    }

    /// Name of joint `i`.
    pub fn name(&self, i: usize) -> &str {
        &self.names[i]
    }

    /// Gravity acceleration in the turned world frame (m/s^2).
    pub fn gravity(&self) -> [f64; 3] {
        self.gravity
    }

    /// Entries `(i, j, A_ij)`, i >= j, of the armature matrix that are not zero.
    pub fn armature(&self) -> &[(usize, usize, f64)] {
        &self.armature
    }

    /// Joint `j`, its parent, and so on down to the world: the indices `i <= j` of tree order.
    pub fn path(&self, j: usize) -> &[usize] {
        &self.paths[self.path_starts[j]..self.path_starts[j + 1]]
    }

    /// Where the path of joint `j` starts among all paths laid end to end.
    pub(crate) fn path_start(&self, j: usize) -> usize {
        self.path_starts[j]
    }

    /// Length of all paths together: the number of ancestor pairs `i <= j`.
    pub fn pairs(&self) -> usize {
        self.paths.len()
    }

    /// Whether no joint has friction.
    pub fn is_conservative(&self) -> bool {
        self.joints.iter().all(|joint| joint.friction.is_none())
    }

    /// The same model with D = 0.
    pub fn without_friction(&self) -> Self {
        let mut tree = self.clone();
        tree.joints.iter_mut().for_each(|joint| joint.friction = Friction::none());
        tree
    }
}

impl From<&Robot> for Tree {
    fn from(robot: &Robot) -> Self {
        let n = robot.len();
        let mut turned = TurnedFrames::new(robot);
        for i in 0..n {
            turned.place(i);
        }
        let (mut path_starts, mut paths) = (vec![0], Vec::new());
        let mut subtree_mass: Vec<f64> = robot.joints().iter().map(|joint| joint.inertia.mass).collect();
        for (j, joint) in robot.joints().iter().enumerate().rev() {
            if let Some(parent) = joint.parent {
                subtree_mass[parent] += subtree_mass[j];
            }
        }
        for j in 0..n {
            let mut at = Some(j);
            while let Some(i) = at {
                paths.push(i);
                at = robot.joints()[i].parent;
            }
            path_starts.push(paths.len());
        }
        let joints = (0..n).map(|i| turned.joint(i, subtree_mass[i])).collect();
        Self {
            names: robot.joints().iter().map(|joint| joint.name.clone()).collect(),
            joints,
            gravity: (turned.world * robot.gravity()).into(),
            armature: nonzero_lower(robot.armature()),
            path_starts,
            paths,
        }
    }
}

fn nonzero_lower(matrix: &DMatrix<f64>) -> Vec<(usize, usize, f64)> {
    let lower = (0..matrix.nrows()).flat_map(|i| (0..=i).map(move |j| (i, j)));
    lower.map(|(i, j)| (i, j, matrix[(i, j)])).filter(|entry| entry.2 != 0.0).collect()
}

/// The frames while they are being turned; `x_turned = turn x_original`.
struct TurnedFrames<'a> {
    robot: &'a Robot,
    world: Matrix3<f64>,
    world_is_fixed: bool,
    turns: Vec<Matrix3<f64>>,
    is_fixed: Vec<bool>,
    screws: Vec<FixedScrew>,
    offsets: Vec<f64>,
}

impl<'a> TurnedFrames<'a> {
    fn new(robot: &'a Robot) -> Self {
        let n = robot.len();
        let is_fixed = robot.joints().iter().map(|joint| joint.kind == JointKind::Prismatic).collect();
        Self {
            robot,
            world: Matrix3::identity(),
            world_is_fixed: false,
            turns: Vec::with_capacity(n),
            is_fixed,
            screws: Vec::with_capacity(n),
            offsets: vec![0.0; n],
        }
    }

    /// Turns frame `i`; those before it have been turned.
    fn place(&mut self, i: usize) {
        let joint = &self.robot.joints()[i];
        let axes = axes_with_z_along(joint.axis);
        let outer = joint.parent.map_or(self.world, |p| self.turns[p]);
        let rotation = (outer * joint.placement.rotation * axes).map(snap);
        let mut translation = outer * joint.placement.translation;
        let may_turn_parent = !joint.parent.map_or(self.world_is_fixed, |p| self.is_fixed[p]);
        let Screw { mut gamma, alpha, delta } = decompose(&rotation, &translation, may_turn_parent);
        if let Some(turn) = gamma {
            let back = about_z([-turn[0], turn[1]]);
            translation = back * translation;
            if may_turn_parent {
                match joint.parent {
                    None => self.world = back * self.world,
                    Some(parent) => {
                        self.turns[parent] = back * self.turns[parent];
                        self.offsets[parent] += turn[0].atan2(turn[1]);
                    }
                }
                gamma = None;
            }
        }
        match joint.parent {
            None => self.world_is_fixed = true,
            Some(parent) => self.is_fixed[parent] = true,
        }
        self.screws.push(FixedScrew { gamma, alpha, translation: translation.map(snap).into() });
        self.turns.push(about_z(delta) * axes.transpose());
    }

    fn joint(&self, i: usize, subtree_mass: f64) -> JointFrame {
        let joint = &self.robot.joints()[i];
        let turn = self.turns[i];
        let link = &joint.inertia;
        let j = turn * link.inertia_about_origin() * turn.transpose();
        JointFrame {
            kind: joint.kind,
            parent: joint.parent,
            screw: self.screws[i],
            offset: self.offsets[i],
            inertia: ConstantInertia {
                mass: link.mass,
                first_moment: (turn * link.com * link.mass).into(),
                matrix: [j[(0, 0)], j[(1, 1)], j[(2, 2)], j[(0, 1)], j[(0, 2)], j[(1, 2)]],
            },
            subtree_mass,
            spring: joint.spring,
            friction: joint.friction,
        }
    }
}

/// A rotation as `Rz(gamma) Rx(alpha) Rz(delta)`, each by its sine and cosine.
struct Screw {
    gamma: Option<[f64; 2]>,
    alpha: [f64; 2],
    delta: [f64; 2],
}

/// The third column of `Rz(gamma) Rx(alpha) Rz(delta)` is `(sin gamma sin alpha, -cos gamma sin alpha, cos alpha)`.
/// Parallel axes leave gamma free: the common perpendicular is then laid along x if the parent may be turned.
fn decompose(r: &Matrix3<f64>, translation: &Vector3<f64>, may_turn_parent: bool) -> Screw {
    let horizontal = r[(0, 2)].hypot(r[(1, 2)]);
    let gamma = if horizontal > 0.0 {
        (r[(0, 2)] != 0.0).then(|| [r[(0, 2)] / horizontal, -r[(1, 2)] / horizontal])
    } else {
        let (x, y) = (translation.x, translation.y);
        (may_turn_parent && y != 0.0).then(|| [y / x.hypot(y), x / x.hypot(y)])
    };
    let unturned = gamma.map_or(*r, |[sin, cos]| about_z([-sin, cos]) * r);
    let unit = |sin: f64, cos: f64| [sin / sin.hypot(cos), cos / sin.hypot(cos)].map(snap);
    Screw {
        gamma,
        alpha: unit(-unturned[(1, 2)], unturned[(2, 2)]),
        delta: unit(-unturned[(0, 1)], unturned[(0, 0)]),
    }
}

fn about_z([sin, cos]: [f64; 2]) -> Matrix3<f64> {
    Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
}

/// A right-handed frame (its axes are the columns) with z along the unit vector `axis`.
pub(super) fn axes_with_z_along(axis: Vector3<f64>) -> Matrix3<f64> {
    let helper = match axis.iamin() {
        0 => Vector3::x(),
        1 => Vector3::y(),
        _ => Vector3::z(),
    };
    let x = (helper - axis * axis.dot(&helper)).normalize();
    Matrix3::from_columns(&[x, axis.cross(&x), axis])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{JointSpec, LinkInertia, Placement};

    /// Position of each turned frame in the turned world at q, by 4 x 4 products.
    fn positions(tree: &Tree, q: &[f64]) -> Vec<(Matrix3<f64>, Vector3<f64>)> {
        let mut frames: Vec<(Matrix3<f64>, Vector3<f64>)> = Vec::new();
        for (joint, q) in tree.joints().iter().zip(q) {
            let (outer, origin) = joint.parent.map_or((Matrix3::identity(), Vector3::zeros()), |p| frames[p]);
            let [s, c] = joint.screw.alpha;
            let rx = Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c);
            let rz = about_z(joint.screw.gamma.unwrap_or([0.0, 1.0]));
            let (turn, slide) = match joint.kind {
                JointKind::Revolute => (about_z([(q + joint.offset).sin(), (q + joint.offset).cos()]), 0.0),
                JointKind::Prismatic => (Matrix3::identity(), *q),
            };
            let local = rz * (Vector3::from(joint.screw.translation) + rx * Vector3::new(0.0, 0.0, slide));
            frames.push((outer * rz * rx * turn, origin + outer * local));
        }
        frames
    }

    #[test]
    fn turned_frames_put_every_centre_of_mass_where_it_was() {
        let placed = |x, r: [f64; 3]| Placement::from_xyz_rpy([x, -0.2, 0.4], r);
        let link = LinkInertia::about_com(2.0, [0.1, 0.2, -0.3], Matrix3::identity());
        let half_turn = [std::f64::consts::PI, 0.0, 0.0];
        let robot = Robot::builder("branched")
            .joint(
                JointSpec::revolute("a")
                    .axis([1.0, -2.0, 0.5])
                    .placed(placed(0.1, [0.3, 1.0, -2.0]))
                    .carrying(link),
            )
            .joint(
                JointSpec::prismatic("b")
                    .on("a")
                    .axis([0.0, -1.0, 0.0])
                    .placed(placed(0.2, [0.0; 3]))
                    .carrying(link),
            )
            .joint(JointSpec::revolute("c").on("b").placed(placed(0.3, [-1.0, 0.2, 0.1])).carrying(link))
            .joint(
                JointSpec::revolute("d")
                    .on("a")
                    .axis([0.0, 0.0, -1.0])
                    .placed(placed(0.4, half_turn))
                    .carrying(link),
            )
            .joint(
                JointSpec::revolute("e")
                    .on("d")
                    .axis([0.0, 0.0, 1.0])
                    .placed(placed(0.5, [0.0; 3]))
                    .carrying(link),
            )
            .joint(
                JointSpec::revolute("f")
                    .on("d")
                    .axis([1.0, 0.0, 0.0])
                    .placed(placed(0.6, [0.0, 0.0, 9.0]))
                    .carrying(link),
            )
            .build()
            .unwrap();
        let tree = Tree::from(&robot);
        assert_eq!(tree.path(2), [2, 1, 0]);
        assert_eq!((tree.pairs(), tree.joints()[0].subtree_mass), (1 + 2 + 3 + 2 + 3 + 3, 12.0));
        let q = [0.7, -0.4, 2.0, -1.1, 0.0, 30.0];
        let turned = TurnedFrames::new(&robot);
        assert_eq!(turned.turns.len(), 0);
        let ours = positions(&tree, &q);
        let world = tree.gravity();
        let mut frames: Vec<Placement> = Vec::new();
        for (i, joint) in robot.joints().iter().enumerate() {
            let moved = match joint.kind {
                JointKind::Revolute => Placement {
                    rotation: *nalgebra::Rotation3::from_axis_angle(
                        &nalgebra::Unit::new_normalize(joint.axis),
                        q[i],
                    )
                    .matrix(),
                    translation: Vector3::zeros(),
                },
                JointKind::Prismatic => {
                    Placement { rotation: Matrix3::identity(), translation: joint.axis * q[i] }
                }
            };
            let outer = joint.parent.map_or(Placement::identity(), |p| frames[p]);
            frames.push(outer.then(&joint.placement).then(&moved));
            let expected = frames[i].rotation * link.com + frames[i].translation;
            let h = Vector3::from(tree.joints()[i].inertia.first_moment) / 2.0;
            let found = ours[i].0 * h + ours[i].1;
            assert!((found.norm() - expected.norm()).abs() < 1e-14, "joint {i}");
            let height = -found.dot(&Vector3::from(world)) / 9.81;
            assert!((height - expected.z).abs() < 1e-14, "height of joint {i}");
        }
    }

    #[test]
    fn frames_along_any_axis_are_right_handed() {
        for axis in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.6, 0.0, -0.8]] {
            let axes = axes_with_z_along(Vector3::from(axis));
            assert!((axes.determinant() - 1.0).abs() < 1e-15 && axes.column(2) == Vector3::from(axis));
        }
    }
}
