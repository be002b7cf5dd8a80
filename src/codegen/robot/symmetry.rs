//! The symmetry of a tree with equal branches, as the two legs and the two arms of a humanoid.

use crate::robot::{Branches, Joint, Robot};
use std::collections::HashMap;

/// For each independent joint the one that stands in its place when equal branches are exchanged, itself
/// where nothing is; `None` where no branches are equal.
///
/// Branches from one joint are equal if they have the same joint types and branches; their numbers are not
/// compared. Of several equal ones, the first half is exchanged with the second half.
pub(super) fn exchanged_joints(robot: &Robot) -> Option<Vec<usize>> {
    let shapes = Shapes::new(robot.joints());
    let mut images: Vec<usize> = (0..robot.joints().len()).collect();
    shapes.exchange(shapes.branches.roots(), &mut images);
    let independent = robot.independent_indices();
    let place = |joint: usize| independent.iter().position(|&other| other == joint);
    let images: Option<Vec<usize>> = independent.iter().map(|&joint| place(images[joint])).collect();
    images.filter(|images| images.iter().enumerate().any(|(joint, &image)| joint != image))
}

/// The branches of a robot, and for each joint the shape of the branch that begins with it.
struct Shapes {
    branches: Branches,
    of: Vec<usize>,
}

impl Shapes {
    fn new(joints: &[Joint]) -> Self {
        let parents: Vec<_> = joints.iter().map(|joint| joint.parent).collect();
        let branches = Branches::new(&parents);
        let mut known = HashMap::new();
        let mut of = vec![0; joints.len()];
        for (j, joint) in joints.iter().enumerate().rev() {
            let mut on: Vec<usize> = branches.children(j).iter().map(|&child| of[child]).collect();
            on.sort_unstable();
            let next = known.len();
            of[j] = *known.entry((joint.kind.name(), on)).or_insert(next);
        }
        Self { branches, of }
    }

    /// Exchanges equal branches among these, or else within each of them.
    fn exchange(&self, siblings: &[usize], images: &mut [usize]) {
        let mut groups: HashMap<usize, Vec<usize>> = HashMap::new();
        siblings.iter().for_each(|&joint| groups.entry(self.of[joint]).or_default().push(joint));
        for group in groups.into_values() {
            let half = group.len() / 2;
            for (&a, &b) in group[..half].iter().zip(&group[half..]) {
                self.swap(a, b, images);
            }
            if group.len() % 2 == 1 {
                self.exchange(self.branches.children(group[2 * half]), images);
            }
        }
    }

    /// Exchanges two equal branches, joint by joint.
    fn swap(&self, a: usize, b: usize, images: &mut [usize]) {
        (images[a], images[b]) = (b, a);
        let sorted = |joint: usize| {
            let mut children = self.branches.children(joint).to_vec();
            children.sort_by_key(|&child| (self.of[child], child));
            children
        };
        sorted(a).into_iter().zip(sorted(b)).for_each(|(a, b)| self.swap(a, b, images));
    }
}

#[cfg(test)]
mod tests {
    use super::exchanged_joints;
    use crate::robot::{JointSpec, LinkInertia, Robot};

    /// Joints by the positions of those that carry them.
    fn tree(carriers: &[Option<usize>]) -> Robot {
        let joint = |(j, carrier): (usize, &Option<usize>)| {
            let joint =
                JointSpec::revolute(format!("j{j}")).carrying(LinkInertia::point(1.0, [0.1, 0.0, 0.0]));
            carrier.map_or(joint.clone(), |carrier| joint.on(format!("j{carrier}")))
        };
        carriers
            .iter()
            .enumerate()
            .map(joint)
            .fold(Robot::builder("tree"), |robot, joint| robot.joint(joint))
            .build()
            .unwrap()
    }

    #[test]
    fn equal_branches_are_exchanged_as_wholes() {
        // A torso with a head of one joint and two arms, each with two fingers.
        let robot = tree(&[None, Some(0), Some(0), Some(2), Some(2), Some(0), Some(5), Some(5)]);
        assert_eq!(exchanged_joints(&robot), Some(vec![0, 1, 5, 6, 7, 2, 3, 4]));
        // Three equal legs on the base: the third one stays, but its two toes are exchanged.
        let leg = |k: usize| [None, Some(3 * k), Some(3 * k)];
        let robot = tree(&[leg(0), leg(1), leg(2)].concat());
        assert_eq!(exchanged_joints(&robot), Some(vec![3, 4, 5, 0, 1, 2, 6, 8, 7]));
        assert_eq!(exchanged_joints(&tree(&[None, Some(0), Some(1)])), None);
        assert_eq!(exchanged_joints(&tree(&[None, Some(0), Some(1), Some(0)])), None);
    }
}
