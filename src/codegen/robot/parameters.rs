//! Programs whose masses, lengths and other constants are arguments.
//!
//! The kernels take the constants of a model as `f64`. Here each of them is a label: a number that represents
//! an expression of the parameters. Where a label becomes part of the recording, the expression replaces it.
//! Products and differences that the kernels form before that (mass times length, half the difference of two
//! moments of inertia) have labels too. Any other number that is neither a small literal nor made from the
//! directions of joints is an error, so no constant is missed.

use super::labels::{Labels, turned};
use super::wrenches;
use crate::codegen::error::CodegenError;
use crate::codegen::record::{Expr, replace_labels};
use crate::robot::parameters::{Directions, Group, groups};
use crate::robot::{JointMap, Robot, Tree};
use crate::scalar::Scalar;
use nalgebra::Matrix3;

/// The parameters of a robot in the order of the argument `parameters` of a program with
/// [`ProgramOptions::parameters`].
///
/// For each joint 13 numbers: mass (kg), first moment (kg m) and inertia (kg m^2: xx, yy, zz, xy, xz, yz) of
/// its link about the origin of the joint frame, in the axes of that frame, translation of its placement (m).
/// After them, where the joint has it: stiffness and rest position of its spring; viscous friction; limit and
/// transition velocity of Coulomb friction; armature. Then the armature of pairs of joints, where it is not
/// zero, and gravity (m/s^2). At last, for each frame with wrenches from outside, those of joints apart, its
/// translation in the frame of its joint (m), and for each wrench moment (N m) and force (N).
///
/// A program recorded from one robot is right for the parameters of any other one with the same joints,
/// directions, ratios and offsets of mimic joints, orientations of frames with wrenches, axes of these, and
/// kinds of parameters: the same [`parameter_names`].
///
/// [`ProgramOptions::parameters`]: super::ProgramOptions::parameters
pub fn parameter_values(robot: &Robot) -> Vec<f64> {
    all_groups(robot).flat_map(|group| group.entries).map(|(_, value)| value).collect()
}

/// The names of the [`parameter_values`], such as `shoulder.mass`.
pub fn parameter_names(robot: &Robot) -> Vec<String> {
    let name = |of: &str, entry: &str| if of.is_empty() { entry.into() } else { format!("{of}.{entry}") };
    let of_group = |Group { of, entries, .. }: Group| {
        entries.into_iter().map(move |(entry, _)| name(&of, entry)).collect::<Vec<_>>()
    };
    all_groups(robot).flat_map(of_group).collect()
}

/// A line for each group of parameters.
pub(super) fn layout(robot: &Robot) -> Vec<String> {
    let mut start = 0;
    let line = |Group { of, entries, .. }: Group| {
        let names: Vec<_> = entries.iter().map(|(name, _)| *name).collect();
        let line = format!("  parameters[{start}..{}]: {of}: {}", start + names.len(), names.join(" "));
        start += names.len();
        line.replace(": :", ":")
    };
    all_groups(robot).map(line).collect()
}

/// The constants of the robot, then those of its wrenches.
fn all_groups(robot: &Robot) -> impl Iterator<Item = Group> {
    groups(robot).into_iter().chain(wrenches::groups(robot))
}

/// `A J A'` for a symmetric matrix: xx, yy, zz, xy, xz, yz.
fn turned_matrix(turn: &Matrix3<f64>, [xx, yy, zz, xy, xz, yz]: [Expr; 6]) -> [Expr; 6] {
    let columns = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(|column| turned(turn, column));
    let rows = [0, 1, 2].map(|i| turned(turn, [columns[0][i], columns[1][i], columns[2][i]]));
    [rows[0][0], rows[1][1], rows[2][2], rows[0][1], rows[0][2], rows[1][2]]
}

/// The model whose constants are labels of these parameters, for the recording that runs.
pub(super) fn labelled(robot: &Robot, parameters: &[Expr]) -> Result<Tree, CodegenError> {
    let Directions { mut joints, turns, arms, world, mut armature } = Directions::from(robot);
    let mut rest = parameters.iter().copied();
    let mut next = || rest.next().unwrap_or(Expr::zero());
    let mut labels = Labels::new();
    let mut numbers = Vec::new();
    let mut masses = Vec::new();
    for (i, joint) in joints.iter_mut().enumerate() {
        let mass = next();
        let h = turned(&turns[i], [0; 3].map(|_| next()));
        let j = turned_matrix(&turns[i], [0; 6].map(|_| next()));
        let r = turned(&arms[i], [0; 3].map(|_| next()));
        masses.push((mass, r));
        joint.inertia.mass = labels.label(mass);
        joint.inertia.first_moment = labels.all(h);
        joint.inertia.matrix = labels.all(j);
        for k in [0, 2] {
            let [label, yy] = [k, 1].map(|k| joint.inertia.matrix[k]);
            labels.derived(0.5 * (label - yy), (j[k] - j[1]).times(0.5));
        }
        joint.lumped = joint.inertia;
        joint.screw.translation = labels.all(r);
        joint.screw.rise = 0.0;
        if joint.spring.stiffness != 0.0 {
            let (stiffness, rest) = (next(), next());
            joint.spring.stiffness = labels.label(stiffness);
            joint.spring.rest = labels.label(rest);
            labels.derived(0.5 * joint.spring.stiffness, stiffness.times(0.5));
        }
        if joint.friction.viscous != 0.0 {
            joint.friction.viscous = labels.label(next());
        }
        if joint.friction.coulomb != 0.0 {
            let (limit, velocity) = (next(), next());
            let sharpness = velocity.recip();
            let law = &mut joint.friction;
            (law.coulomb, law.coulomb_velocity) = (labels.label(limit), labels.label(velocity));
            let sharp = law.coulomb_velocity.recip();
            labels.derived(sharp, sharpness);
            labels.derived(law.coulomb * sharp, limit * sharpness);
            labels.derived(2.0 * law.coulomb * sharp * sharp, (limit * sharpness * sharpness).times(2.0));
        }
        for entry in armature.iter_mut().filter(|(row, column, _)| (*row, *column) == (i, i)) {
            entry.2 = labels.label(next());
        }
        numbers.push(joint.offset);
        for [sin, cos] in joint.screw.gamma.iter().chain([&joint.screw.alpha]).map(|turn| turn.sin_cos()) {
            numbers.extend([sin, cos, cos + sin, sin - cos, 2.0 * cos]);
        }
    }
    for entry in armature.iter_mut().filter(|(row, column, _)| row != column) {
        entry.2 = labels.label(next());
    }
    let gravity = labels.all(turned(&world, [0; 3].map(|_| next())));
    for i in (0..joints.len()).rev() {
        let (mass, r) = masses[i];
        if let Some(parent) = joints[i].parent {
            masses[parent].0 += mass;
        }
        let label = labels.label(mass);
        joints[i].lumped_mass = label;
        joints[i].subtree_mass = label;
        for (r, length) in r.into_iter().zip(joints[i].screw.translation) {
            labels.derived(label * length, mass * r);
            labels.derived(0.5 * label * length, (mass * r).times(0.5));
        }
    }
    let tree = Tree::from_parts(robot, joints, gravity, armature);
    let acting = wrenches::labelled(robot, &turns, &mut next, &mut labels);
    numbers.extend(acting.numbers(&world));
    let tree = tree.under(acting.frames, acting.wrenches, world);
    // Ratios and offsets of mimic joints are no parameters.
    numbers.extend(tree.joint_map().into_iter().flat_map(JointMap::constants));
    replace_labels(labels.table, numbers)?;
    Ok(tree)
}
