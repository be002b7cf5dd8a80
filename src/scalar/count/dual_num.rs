//! [`Count`] as a number of num-dual's: operations that the pipeline uses are counted by kind, as by
//! [`Scalar`]; each other function counts as one [`other`](super::Operations::other).

use super::Count;
use crate::scalar::dual_num::dual_num;
use crate::scalar::number::Scalar;

impl Count {
    fn real_part(&self) -> f64 {
        self.value()
    }

    fn map(self, function: impl Fn(f64) -> f64) -> Self {
        self.other(function(self.value()))
    }

    fn combine(self, second: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        self.other_of_two(second, function(self.value(), second.value()))
    }
}

dual_num!(Count);

#[cfg(test)]
mod tests {
    use super::Count;
    use crate::scalar::{Operations, Scalar, count};
    use num_dual::{Dual, DualNum, DualSVec, HyperDual};
    use num_traits::Signed;

    /// Every function of num-dual's numbers.
    fn functions<T: DualNum<Primitive = f64> + Copy>(x: T, y: T) -> Vec<T> {
        let (sin, cos) = x.sin_cos();
        let mut changed = x;
        changed /= y;
        changed *= 3.0;
        changed += 0.5;
        changed -= 0.25;
        changed /= 2.0;
        changed %= y;
        changed %= 0.3;
        let (one, zero) = (T::one(), T::zero());
        vec![
            sin,
            cos,
            x.sin(),
            x.cos(),
            x.tan(),
            x.recip(),
            x.inv(),
            x.sqrt(),
            x.cbrt(),
            x.exp(),
            x.exp2(),
            x.exp_m1(),
            x.ln(),
            x.log(3.0),
            x.log2(),
            x.log10(),
            x.ln_1p(),
            x.asin(),
            x.acos(),
            x.atan(),
            x.atan2(y),
            x.sinh(),
            x.cosh(),
            x.tanh(),
            x.asinh(),
            (x + 1.0).acosh(),
            x.atanh(),
            x.sph_j0(),
            x.sph_j1(),
            x.sph_j2(),
            x.powi(3),
            x.powf(1.7),
            x.powd(y),
            x.mul_add(y, x),
            x % y,
            x / 3.0,
            x - 2.0,
            changed,
            (-x).abs(),
            x.abs_sub(&y),
            y.abs_sub(&x),
            x.signum(),
            x.mul(&y).sub(&y),
            [x, y, x].into_iter().sum(),
            [x, y, x].into_iter().product(),
            one,
            zero,
        ]
    }

    #[test]
    fn values_are_those_of_f64() {
        let (x, y) = (0.7, 0.4);
        let (found, _) = count(|| functions(Count::variable(x), Count::variable(y)));
        for (k, (found, expected)) in found.iter().zip(functions(x, y)).enumerate() {
            assert!((found.value() - expected).abs() <= 4e-16 * expected.abs(), "{k}: {found} {expected}");
        }
        let (constants, none) = count(|| functions(Count::constant(x), Count::constant(y)));
        assert!(constants.iter().all(|value| value.is_constant()) && none == Operations::default());
        let one = Count::constant(1.0);
        assert!(one.is_positive() && !one.is_negative() && num_traits::Zero::is_zero(&(one - one)));
        assert!(Count::variable(x) > 0.5 && Count::variable(x) < Count::variable(0.8));
    }

    /// `(a + b e)(c + d e) = a c + (b c + a d) e`, and the same with parts that are known to vanish.
    #[test]
    fn dual_numbers_over_it_count_what_they_do() {
        let variable = Count::variable;
        let (a, b) = (Dual::new(variable(2.0), variable(3.0)), Dual::new(variable(5.0), variable(7.0)));
        let (product, o) = count(|| a * b);
        assert_eq!((product.re.value(), product.eps.value(), o.mul, o.add), (10.0, 29.0, 3, 1));
        let seed = Dual::from_re(variable(2.0)).derivative();
        assert_eq!(count(|| seed * seed).1, Operations { mul: 1, add: 1, ..Operations::default() });
        let (_, o) = count(|| a.times(3.0));
        assert_eq!((o.mul, o.add), (2, 0));
        let x = DualSVec::<_, 3>::from_re(variable(2.0)).derivative(1);
        let (square, o) = count(|| x * x);
        assert_eq!((square.eps.0.map(|eps| eps[1].value()), o.mul), (Some(4.0), 1));
        let h = HyperDual::new(variable(0.3), Scalar::one(), Scalar::one(), Scalar::zero());
        let (root, o) = count(|| Scalar::sqrt(h));
        assert!((root.eps1eps2.value() + 0.25 * 0.3_f64.powf(-1.5)).abs() < 1e-14);
        assert_eq!((o.sqrt, o.div), (1, 1));
    }
}
