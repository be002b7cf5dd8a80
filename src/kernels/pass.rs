//! Values handed from joint to joint.

/// What joint i hands to its parent on the way inward. Where the parent comes next, as in a chain, it does so without a detour
/// through memory; else it is added to what is kept for the parent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inward<T>(Option<(usize, T)>);

impl<T: Copy> Inward<T> {
    /// Before the first joint.
    #[inline(always)]
    pub fn new() -> Self {
        Self(None)
    }

    /// The sum of what is kept for joint i and what was handed to it last.
    #[inline(always)]
    pub fn total(&mut self, i: usize, kept: &mut [T], add: impl Fn(T, T) -> T) -> T {
        match self.0.take() {
            Some((to, value)) if to == i => add(kept[i], value),
            Some((to, value)) => {
                kept[to] = add(kept[to], value);
                kept[i]
            }
            None => kept[i],
        }
    }

    /// Hands a value to joint `to`, after [`total`](Self::total).
    #[inline(always)]
    pub fn hand(&mut self, to: usize, value: T) {
        self.0 = Some((to, value));
    }
}

/// What the joint before has left for its children on the way outward.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outward<T>(Option<(usize, T)>);

impl<T: Copy> Outward<T> {
    /// Before the first joint.
    #[inline(always)]
    pub fn new() -> Self {
        Self(None)
    }

    /// The value of the parent, which `kept` holds too.
    #[inline(always)]
    pub fn of(&self, parent: usize, kept: &[T]) -> T {
        match self.0 {
            Some((from, value)) if from == parent => value,
            _ => kept[parent],
        }
    }

    /// Leaves the value of joint i.
    #[inline(always)]
    pub fn leave(&mut self, i: usize, value: T) {
        self.0 = Some((i, value));
    }
}

impl<T: Copy, U: Copy> Outward<(T, U)> {
    /// The two values of the parent, which the arrays hold too.
    #[inline(always)]
    pub fn of_pair(&self, parent: usize, kept: (&[T], &[U])) -> (T, U) {
        match self.0 {
            Some((from, values)) if from == parent => values,
            _ => (kept.0[parent], kept.1[parent]),
        }
    }
}
