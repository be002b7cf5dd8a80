//! Which entries of the factors of the mass matrix can be other than zero.

use super::tree::Tree;

impl Tree {
    /// The columns `i < k` of the entries (k, i) of L in `M = L' D L`, n x n, for each row k, rising.
    ///
    /// An entry of M is zero unless one of its joints carries the other, or armature couples them; with mimic
    /// joints, unless this holds for any two joints of its coordinates. The pattern is closed under the
    /// elimination from the last row to the first, which adds nothing for a tree in its order.
    pub(crate) fn factor_pattern(&self) -> Vec<Vec<usize>> {
        let n = self.dof();
        let mut filled = vec![vec![false; n]; n];
        if let Some(map) = self.joint_map() {
            map.entries().for_each(|([r, s], _)| filled[r][s] = r != s);
        } else {
            (0..n).for_each(|i| self.subtree(i).iter().for_each(|&k| filled[k][i] = k != i));
            self.armature().iter().for_each(|&(i, j, _)| filled[i][j] |= j < i);
        }
        let mut rows = vec![Vec::new(); n];
        for k in (0..n).rev() {
            let row: Vec<usize> = (0..k).filter(|&i| filled[k][i]).collect();
            for (a, &i) in row.iter().enumerate() {
                row[..a].iter().for_each(|&j| filled[i][j] = true);
            }
            rows[k] = row;
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use crate::robot::{JointSpec, LinkInertia, Robot, Tree};

    #[test]
    fn mimic_joints_couple_branches() {
        let link = LinkInertia::about_com(1.0, [0.1, 0.0, 0.2], nalgebra::Matrix3::identity());
        let joint = |name: &str| JointSpec::revolute(name).carrying(link);
        let robot = Robot::builder("two arms")
            .joint(joint("a"))
            .joint(joint("b").on("a"))
            .joint(joint("c").on("a"))
            .joint(joint("d").on("c"))
            .joint(joint("e").on("b").mimicking("d", -1.0, 0.0))
            .joint(joint("f"));
        let pattern = Tree::from(&robot.build().unwrap()).factor_pattern();
        // d carries what its mimic e carries, beyond b; b and c couple by elimination of d.
        assert_eq!(pattern, [vec![], vec![0], vec![0, 1], vec![0, 1, 2], vec![]]);
    }
}
