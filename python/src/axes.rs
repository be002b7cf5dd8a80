//! The leading axes of arrays, which are broadcast.

/// Most leading axes of an argument.
pub const MOST_AXES: usize = 8;

/// The leading axes of all arguments together.
#[derive(Clone, Copy, Debug, Default)]
pub struct Axes {
    pub count: usize,
    pub lengths: [usize; MOST_AXES],
}

impl Axes {
    /// Axes of these lengths; all states along one axis where there are too many.
    pub fn new(lengths: &[usize]) -> Self {
        let mut axes = Self { count: lengths.len(), lengths: [1; MOST_AXES] };
        match axes.lengths.get_mut(..lengths.len()) {
            Some(own) => own.copy_from_slice(lengths),
            None => (axes.count, axes.lengths[0]) = (1, lengths.iter().product()),
        }
        axes
    }

    /// The lengths of the axes.
    pub fn shape(&self) -> &[usize] {
        &self.lengths[..self.count]
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.shape().iter().fold(1, |product: usize, &length| product.saturating_mul(length))
    }

    /// The index of a state along each axis.
    pub fn index(&self, mut state: usize) -> Vec<usize> {
        let mut index: Vec<usize> = self.shape().to_vec();
        for part in index.iter_mut().rev() {
            let length = *part;
            *part = state % length;
            state /= length;
        }
        index
    }

    /// Adds the axes of one more argument as NumPy broadcasts them; false where they do not fit.
    pub fn include(&mut self, other: &Self) -> bool {
        let count = self.count.max(other.count);
        for k in 1..=count {
            // Aligned at the last axis; an axis that is missing has length 1.
            let of = |axes: &Self| if k <= axes.count { axes.lengths[axes.count - k] } else { 1 };
            let (ours, theirs) = (of(self), of(other));
            if ours != theirs && ours != 1 && theirs != 1 {
                return false;
            }
        }
        let mut lengths = [1; MOST_AXES];
        for k in 1..=count {
            let of = |axes: &Self| if k <= axes.count { axes.lengths[axes.count - k] } else { 1 };
            lengths[count - k] = if of(self) == 1 { of(other) } else { of(self) };
        }
        *self = Self { count, lengths };
        true
    }
}
