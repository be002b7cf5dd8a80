//! Values passed from joint to joint in a sweep.

/// The contribution of joint i to its parent in an inward sweep. If the parent is next, as in a chain, it is
/// passed on directly; else it is added to the record of the parent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inward<T>(Option<(usize, T)>);

impl<T: Copy> Inward<T> {
    /// Before the first joint.
    #[inline(always)]
    pub fn new() -> Self {
        Self(None)
    }

    /// The sum for joint i: its record, which `kept` looks up, plus the value passed on last.
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

    /// Passes a value to joint `to`, after [`total`](Self::total).
    #[inline(always)]
    pub fn hand(&mut self, to: usize, value: T) {
        self.0 = Some((to, value));
    }
}

/// The value of the previous joint in an outward sweep, for its children.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outward<T>(Option<(usize, T)>);

impl<T: Copy> Outward<T> {
    /// Before the first joint.
    #[inline(always)]
    pub fn new() -> Self {
        Self(None)
    }

    /// The value of the parent; `kept` looks it up in the record.
    #[inline(always)]
    pub fn of<B>(&self, parent: usize, records: &[B], kept: impl Fn(&B) -> T) -> T {
        match self.0 {
            Some((from, value)) if from == parent => value,
            _ => kept(&records[parent]),
        }
    }

    /// Stores the value of joint i.
    #[inline(always)]
    pub fn leave(&mut self, i: usize, value: T) {
        self.0 = Some((i, value));
    }
}
