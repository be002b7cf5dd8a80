//! Groups of forces that are transformed together, in blocks of several lanes.

use crate::matrix::Matrix;
use crate::robot::Tree;
use crate::scalar::{Pack, Scalar};
use std::ops::Range;

/// Layout of the forces of all joints beyond a joint during the inward pass, several to a block.
///
/// Joint i has one force for each j of its subtree: those of its children, transformed one frame inward, and
/// its own. A block keeps its lanes during the pass, so that whole blocks are transformed at once. They are
/// filled from the last lane on: the force of joint i goes before that of the next joint, else to any block
/// that is not full, else to a new one. Unused lanes are zero.
#[derive(Clone, Debug)]
pub(super) struct Blocks {
    starts: Vec<usize>,
    /// The joints in the lanes of each block, from the last lane on, block after block, and where they begin.
    joints: Vec<usize>,
    firsts: Vec<usize>,
    /// The joint in lane 0, if those in the next lanes follow it one by one.
    rows: Vec<Option<usize>>,
    /// Block and lane of the force of joint i in frame i.
    own: Vec<(usize, usize)>,
}

impl Blocks {
    /// For blocks of this many lanes.
    pub fn new(tree: &Tree, lanes: usize) -> Self {
        let n = tree.joints().len();
        // Joints of each block, joint by joint, from the tips inward.
        let mut blocks: Vec<Vec<Vec<usize>>> = vec![Vec::new(); n];
        let mut own = vec![(0, 0); n];
        for i in (0..n).rev() {
            let mut here: Vec<Vec<usize>> = Vec::new();
            if tree.joints()[i].parent.is_some() {
                tree.children(i).iter().for_each(|&child| here.extend(blocks[child].iter().cloned()));
            }
            let free = |block: &Vec<usize>| block.len() < lanes;
            let before_next = |block: &Vec<usize>| free(block) && block.last() == Some(&(i + 1));
            let block = here.iter().position(before_next).or_else(|| here.iter().position(free));
            let block = block.unwrap_or(here.len());
            if block == here.len() {
                here.push(Vec::new());
            }
            here[block].push(i);
            own[i] = (block, lanes - here[block].len());
            blocks[i] = here;
        }
        let ends = blocks.iter().scan(0, |end, blocks| {
            *end += blocks.len();
            Some(*end)
        });
        let starts: Vec<usize> = std::iter::once(0).chain(ends).collect();
        own.iter_mut().zip(&starts).for_each(|((block, _), start)| *block += start);
        let (mut lane_joints, mut firsts, mut rows) = (Vec::new(), vec![0], Vec::new());
        for joints in blocks.into_iter().flatten() {
            let follow = joints.windows(2).all(|pair| pair[0] == pair[1] + 1);
            rows.push(joints.last().copied().filter(|_| follow && joints.len() == lanes));
            lane_joints.extend(joints);
            firsts.push(lane_joints.len());
        }
        Self { starts, joints: lane_joints, firsts, rows, own }
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// The blocks of joint i.
    #[inline(always)]
    pub fn of(&self, i: usize) -> Range<usize> {
        self.starts[i]..self.starts[i + 1]
    }

    /// For each child of joint i, which has a parent: the child, its blocks, and the first of those blocks of
    /// i that hold the same forces.
    #[inline(always)]
    pub fn inherited(&self, tree: &Tree, i: usize) -> impl Iterator<Item = (usize, Range<usize>, usize)> {
        let mut next = self.starts[i];
        tree.children(i).iter().map(move |&child| {
            let (beyond, first) = (self.of(child), next);
            next += beyond.len();
            (child, beyond, first)
        })
    }

    /// Block and lane of the force of joint i in frame i.
    #[inline(always)]
    pub fn own(&self, i: usize) -> (usize, usize) {
        self.own[i]
    }

    /// Entries (i, j) and (j, i) of a symmetric matrix, j the joints of a block.
    #[inline(always)]
    pub fn store_both<S: Scalar, P: Pack<S>>(&self, i: usize, block: usize, entries: P, m: &mut Matrix<S>) {
        self.store(i, block, [entries, entries], m);
    }

    /// Entries (i, j) and (j, i) of a matrix, j the joints of a block; (i, i) comes from the row.
    #[inline(always)]
    pub fn store<S: Scalar, P: Pack<S>>(
        &self,
        i: usize,
        block: usize,
        [row, column]: [P; 2],
        m: &mut Matrix<S>,
    ) {
        if let Some(first) = self.rows[block] {
            m.write_column(first, i, column);
            row.write(&mut m.row_mut(i)[first..first + P::LANES]);
            return;
        }
        let joints = &self.joints[self.firsts[block]..self.firsts[block + 1]];
        for (k, &j) in joints.iter().enumerate() {
            let lane = P::LANES - 1 - k;
            m[(j, i)] = column.lane(lane);
            m[(i, j)] = row.lane(lane);
        }
    }
}
