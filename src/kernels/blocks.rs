//! Groups of forces that are transformed together, in blocks of several lanes.

use crate::matrix::Matrix;
use crate::robot::Tree;
use crate::scalar::{Pack, Scalar};
use std::ops::Range;

/// Layout of the forces of all joints beyond a joint during the inward pass, several to a block.
///
/// Joint i has one force for each j of its subtree: those of its children, transformed one frame inward, and
/// its own. A block keeps its lanes during the pass, so that whole blocks are transformed at once; the force
/// of joint i takes the first free lane, or a new block. Unused lanes are zero.
#[derive(Clone, Debug)]
pub(super) struct Blocks {
    starts: Vec<usize>,
    sources: Vec<Source>,
    /// The joints in the lanes of each block, block after block, and the offset of each block.
    joints: Vec<usize>,
    firsts: Vec<usize>,
    /// Block and lane of the force of joint i in frame i.
    own: Vec<(usize, usize)>,
}

/// The source of a block.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    /// The joint of the block.
    Own,
    /// This block of this child of the joint.
    Child(usize, usize),
}

impl Blocks {
    /// For blocks of this many lanes.
    pub fn new(tree: &Tree, lanes: usize) -> Self {
        let n = tree.joints().len();
        // Lanes and source of each block, joint by joint, from the tips inward.
        let mut blocks: Vec<Vec<(Vec<usize>, Source)>> = vec![Vec::new(); n];
        let mut own = vec![(0, 0); n];
        for i in (0..n).rev() {
            let inherits = tree.joints()[i].parent.is_some();
            let mut here: Vec<(Vec<usize>, Source)> = Vec::new();
            for &child in tree.children(i).iter().filter(|_| inherits) {
                let beyond = blocks[child].iter().enumerate();
                here.extend(beyond.map(|(k, (joints, _))| (joints.clone(), Source::Child(child, k))));
            }
            let free = here.iter().position(|(joints, _)| joints.len() < lanes);
            let block = free.unwrap_or(here.len());
            if free.is_none() {
                here.push((Vec::new(), Source::Own));
            }
            own[i] = (block, here[block].0.len());
            here[block].0.push(i);
            blocks[i] = here;
        }
        let ends = blocks.iter().scan(0, |end, blocks| {
            *end += blocks.len();
            Some(*end)
        });
        let starts: Vec<usize> = std::iter::once(0).chain(ends).collect();
        let (mut sources, mut lane_joints, mut firsts) = (Vec::new(), Vec::new(), vec![0]);
        for (joints, source) in blocks.into_iter().flatten() {
            lane_joints.extend(joints);
            firsts.push(lane_joints.len());
            sources.push(match source {
                Source::Own => Source::Own,
                Source::Child(child, k) => Source::Child(child, starts[child] + k),
            });
        }
        own.iter_mut().zip(&starts).for_each(|((block, _), start)| *block += start);
        Self { starts, sources, joints: lane_joints, firsts, own }
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        self.sources.len()
    }

    /// The blocks of joint i.
    #[inline(always)]
    pub fn of(&self, i: usize) -> Range<usize> {
        self.starts[i]..self.starts[i + 1]
    }

    /// The source of this block.
    #[inline(always)]
    pub fn source(&self, block: usize) -> Source {
        self.sources[block]
    }

    /// Block and lane of the force of joint i in frame i.
    #[inline(always)]
    pub fn own(&self, i: usize) -> (usize, usize) {
        self.own[i]
    }

    /// The joints of a block, with their lanes.
    #[inline(always)]
    fn joints(&self, block: usize) -> impl Iterator<Item = (usize, usize)> {
        self.joints[self.firsts[block]..self.firsts[block + 1]].iter().copied().enumerate()
    }

    /// Entries (i, j) and (j, i) of a symmetric matrix, j the joints of a block.
    #[inline(always)]
    pub fn store_both<S: Scalar, P: Pack<S>>(&self, i: usize, block: usize, entries: P, m: &mut Matrix<S>) {
        for (lane, j) in self.joints(block) {
            let entry = entries.lane(lane);
            m[(i, j)] = entry;
            m[(j, i)] = entry;
        }
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
        for (lane, j) in self.joints(block) {
            m[(j, i)] = column.lane(lane);
            m[(i, j)] = row.lane(lane);
        }
    }
}
