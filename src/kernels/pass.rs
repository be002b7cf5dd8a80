//! Values handed from joint to joint.

/// What joint i hands to its parent on the way inward. Where the parent comes next, as in a chain, it does so
/// without a detour through memory; else it is added to what is kept for the parent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inward<T>(Option<(usize, T)>);

impl<T: Copy> Inward<T> {
    /// Before the first joint.
    #[inline(always)]
    pub fn new() -> Self {
        Self(None)
    }

    /// The sum of what is kept for joint i and what was handed to it last; `kept` finds it in a record.
    #[inline(always)]
    pub fn total<B>(
        &mut self,
        i: usize,
        records: &mut [B],
        kept: impl Fn(&mut B) -> &mut T,
        add: impl Fn(T, T) -> T,
    ) -> T {
        let here = *kept(&mut records[i]);
        match self.0.take() {
            Some((to, value)) if to == i => add(here, value),
            Some((to, value)) => {
                let other = kept(&mut records[to]);
                *other = add(*other, value);
                here
            }
            None => here,
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

    /// The value of the parent, which `kept` finds in its record too.
    #[inline(always)]
    pub fn of<B>(&self, parent: usize, records: &[B], kept: impl Fn(&B) -> T) -> T {
        match self.0 {
            Some((from, value)) if from == parent => value,
            _ => kept(&records[parent]),
        }
    }

    /// Leaves the value of joint i.
    #[inline(always)]
    pub fn leave(&mut self, i: usize, value: T) {
        self.0 = Some((i, value));
    }
}
