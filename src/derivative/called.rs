//! Numbers whose operations are calls.

use super::function::Function;
use crate::scalar::Scalar;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// The number `S`, whose operations are not inlined: the same results from much less machine code.
///
/// An operation of a large dual number is dozens of instructions, and the pipeline has hundreds of
/// operations. Code that serves only as a reference uses these numbers: it takes a fraction of the time to
/// compile and about as long to run.
#[derive(Clone, Copy, Debug)]
pub struct Called<S>(pub S);

macro_rules! operators {
    ($($operator:ident, $apply:ident, $assigning:ident, $assign:ident;)*) => {$(
        impl<S: Scalar> $operator for Called<S> {
            type Output = Self;
            #[inline(never)]
            fn $apply(self, other: Self) -> Self {
                Self(self.0.$apply(other.0))
            }
        }
        impl<S: Scalar> $assigning for Called<S> {
            #[inline(never)]
            fn $assign(&mut self, other: Self) {
                self.0.$assign(other.0);
            }
        }
    )*};
}

operators! {
    Add, add, AddAssign, add_assign;
    Sub, sub, SubAssign, sub_assign;
    Mul, mul, MulAssign, mul_assign;
}

impl<S: Scalar> Div for Called<S> {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
}

impl<S: Scalar> Neg for Called<S> {
    type Output = Self;
    #[inline(never)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

/// Functions that are those of the number inside.
macro_rules! functions {
    ($($function:ident($($argument:ident: $type:ty),*);)*) => {$(
        #[inline(never)]
        fn $function(self $(, $argument: $type)*) -> Self {
            Self(S::$function(self.0 $(, $argument)*))
        }
    )*};
}

impl<S: Scalar> Scalar for Called<S> {
    type Mask = S::Mask;
    type Pack = Self;
    const EPSILON: f64 = S::EPSILON;
    const ORDER: usize = S::ORDER;
    const CHECKED: bool = S::CHECKED;
    const FOLDED: bool = S::FOLDED;
    const FUSED: bool = S::FUSED;
    const INLINED: bool = false;

    #[inline(never)]
    fn from_f64(value: f64) -> Self {
        Self(S::from_f64(value))
    }
    functions! {
        times(factor: f64);
        plus(term: f64);
        recip();
        sqrt();
        exp();
        exp_m1();
        abs();
        tanh();
    }
    #[inline(never)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(self.0.mul_add(factor.0, term.0))
    }
    #[inline(never)]
    fn plus_times(self, term: Self, factor: f64) -> Self {
        Self(self.0.plus_times(term.0, factor))
    }
    #[inline(never)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0.sin_cos();
        (Self(sin), Self(cos))
    }
    #[inline(never)]
    fn less(self, other: Self) -> S::Mask {
        self.0.less(other.0)
    }
    #[inline(never)]
    fn select(mask: S::Mask, if_true: Self, if_false: Self) -> Self {
        Self(S::select(mask, if_true.0, if_false.0))
    }
    fn all(mask: S::Mask) -> bool {
        S::all(mask)
    }
    #[inline(never)]
    fn tanh_and_slope(self) -> (Self, Self) {
        let (tanh, slope) = self.0.tanh_and_slope();
        (Self(tanh), Self(slope))
    }
}

/// A function that is evaluated with [`Called`] numbers, whatever the numbers of its caller.
#[derive(Clone, Debug)]
pub struct ByCalls<F>(pub F);

impl<F: Function> Function for ByCalls<F> {
    type Workspace<S: Scalar> = (F::Workspace<Called<S>>, [Vec<Called<S>>; 2]);
    type Error = F::Error;

    fn inputs(&self) -> usize {
        self.0.inputs()
    }

    fn outputs(&self) -> usize {
        self.0.outputs()
    }

    fn workspace<S: Scalar>(&self) -> Self::Workspace<S> {
        let zeros = |count| vec![Called(S::zero()); count];
        (self.0.workspace(), [zeros(self.inputs()), zeros(self.outputs())])
    }

    fn evaluate<S: Scalar>(
        &self,
        (workspace, [called, results]): &mut Self::Workspace<S>,
        x: &[S],
        y: &mut [S],
    ) -> Result<(), F::Error> {
        called.iter_mut().zip(x).for_each(|(called, &x)| *called = Called(x));
        self.0.evaluate(workspace, called, results)?;
        y.iter_mut().zip(results).for_each(|(y, result)| *y = result.0);
        Ok(())
    }
}
