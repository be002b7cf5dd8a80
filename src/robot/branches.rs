//! Which joints lie beyond which.

use std::ops::Range;

/// The order of the joints of a tree, parents before children.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Branches {
    roots: Vec<usize>,
    children: Vec<Vec<usize>>,
    /// Prefix sums of the sizes of the subtrees.
    starts: Vec<usize>,
    /// The joints depth first: a subtree is a part of it.
    depth_first: Vec<usize>,
    /// The place of each joint in `depth_first`.
    places: Vec<usize>,
}

/// Some joints of a tree.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Marked {
    /// Depth first.
    joints: Vec<usize>,
    /// How many of them come before each place of the joints depth first, and how many there are.
    before: Vec<usize>,
}

impl Branches {
    /// From the parent of each joint; `None` is the base.
    pub fn new(parents: &[Option<usize>]) -> Self {
        let n = parents.len();
        let (mut children, mut sizes) = (vec![Vec::new(); n], vec![1; n]);
        for (j, parent) in parents.iter().enumerate() {
            parent.iter().for_each(|&parent| children[parent].push(j));
        }
        for (j, parent) in parents.iter().enumerate().rev() {
            parent.iter().for_each(|&parent| sizes[parent] += sizes[j]);
        }
        let ends = sizes.iter().scan(0, |end, size| {
            *end += size;
            Some(*end)
        });
        let starts = std::iter::once(0).chain(ends).collect();
        let (mut depth_first, mut places) = (Vec::with_capacity(n), vec![0; n]);
        let roots: Vec<usize> = (0..n).filter(|&i| parents[i].is_none()).collect();
        let mut next: Vec<usize> = roots.iter().rev().copied().collect();
        while let Some(i) = next.pop() {
            places[i] = depth_first.len();
            depth_first.push(i);
            next.extend(children[i].iter().rev());
        }
        Self { roots, children, starts, depth_first, places }
    }

    /// The joints attached to the base.
    pub fn roots(&self) -> &[usize] {
        &self.roots
    }

    /// The joints attached to the link of joint `i`.
    pub fn children(&self, i: usize) -> &[usize] {
        &self.children[i]
    }

    /// Joint `i` and all joints beyond it, depth first.
    pub fn subtree(&self, i: usize) -> &[usize] {
        let start = self.places[i];
        &self.depth_first[start..start + self.pairs_of(i).len()]
    }

    /// Some of the joints.
    pub fn marked(&self, is_marked: impl Fn(usize) -> bool) -> Marked {
        let mut marked = Marked { joints: Vec::new(), before: vec![0] };
        for &i in &self.depth_first {
            marked.joints.extend(is_marked(i).then_some(i));
            marked.before.push(marked.joints.len());
        }
        marked
    }

    /// The marked ones among joint `i` and all joints beyond it, depth first.
    pub fn marked_in_subtree<'a>(&self, marked: &'a Marked, i: usize) -> &'a [usize] {
        let start = self.places[i];
        &marked.joints[marked.before[start]..marked.before[start + self.pairs_of(i).len()]]
    }

    /// Positions of the pairs `(i, j)`, j in the subtree of i, among all pairs of tree order.
    pub fn pairs_of(&self, i: usize) -> Range<usize> {
        self.starts[i]..self.starts[i + 1]
    }

    /// Number of pairs of a joint and one in its subtree.
    pub fn pairs(&self) -> usize {
        self.starts.last().copied().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::Branches;

    #[test]
    fn marked_joints_of_subtrees_are_parts_of_the_marked_ones() {
        let branches = Branches::new(&[None, Some(0), None, Some(0), Some(1), Some(2)]);
        let marked = branches.marked(|i| i >= 3);
        let found: Vec<&[usize]> = (0..6).map(|i| branches.marked_in_subtree(&marked, i)).collect();
        let expected: [&[usize]; 6] = [&[4, 3], &[4], &[5], &[3], &[4], &[5]];
        assert_eq!(found, expected);
    }

    #[test]
    fn subtrees_are_parts_of_the_joints_depth_first() {
        let branches = Branches::new(&[None, Some(0), None, Some(0), Some(1), Some(2)]);
        assert_eq!((branches.roots(), branches.children(0)), (&[0, 2][..], &[1, 3][..]));
        let subtrees: [&[usize]; 6] = [&[0, 1, 4, 3], &[1, 4], &[2, 5], &[3], &[4], &[5]];
        for (i, expected) in subtrees.into_iter().enumerate() {
            assert_eq!(branches.subtree(i), expected);
            assert_eq!(branches.pairs_of(i).len(), expected.len());
        }
        assert_eq!((branches.pairs(), branches.pairs_of(2)), (11, 6..8));
        assert_eq!(Branches::new(&[]).pairs(), 0);
    }
}
