//! Loops compiled for the widest vectors of the processor.

/// Runs `work` compiled for the widest vectors of this processor: AVX-512 (F, VL, DQ), else AVX2 with FMA,
/// else what the crate is compiled for. On architectures other than x86-64 it only calls `work`.
///
/// A build for any x86-64 processor uses vectors of two doubles. Within `work`, plain loops over slices are
/// compiled three times, and the copy for vectors of eight, four or two doubles is chosen at run time, which
/// takes about a nanosecond. Results are the same to the bit in all three: the compiler neither fuses
/// products with sums nor changes their order. Products and sums over contiguous rows of a dozen numbers and
/// more become faster; sums into one number do not, unless written as several sums.
///
/// Only code that is inlined into the closure is compiled so. Mark the closure and all functions with loops
/// that it calls `#[inline(always)]`; other functions run as they were compiled.
///
/// ```
/// use costate_numerics::widest;
///
/// #[inline(always)]
/// fn add(factor: f64, from: &[f64], to: &mut [f64]) {
///     to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
/// }
///
/// let (from, mut to) = (vec![1.0; 100], vec![2.0; 100]);
/// widest(
///     #[inline(always)]
///     || add(0.5, &from, &mut to),
/// );
/// assert_eq!(to, [2.5; 100]);
/// ```
#[inline]
pub fn widest<R>(work: impl FnOnce() -> R) -> R {
    widest_fused(
        #[inline(always)]
        |_| work(),
    )
}

/// As [`widest`], for `work` that fuses products and sums: its argument is whether [`f64::mul_add`] is one
/// instruction, a constant of each copy. Otherwise it would be a slow function, so write `a * b + c` then.
///
/// Twice as fast where the operations count, but results differ by rounding from processor to processor.
///
/// ```
/// use costate_numerics::widest_fused;
///
/// #[inline(always)]
/// fn add<const FUSED: bool>(factor: f64, from: &[f64], to: &mut [f64]) {
///     for (to, from) in to.iter_mut().zip(from) {
///         *to = if FUSED { factor.mul_add(*from, *to) } else { factor * from + *to };
///     }
/// }
///
/// let (from, mut to) = (vec![1.0; 100], vec![2.0; 100]);
/// widest_fused(
///     #[inline(always)]
///     |fused| if fused { add::<true>(0.5, &from, &mut to) } else { add::<false>(0.5, &from, &mut to) },
/// );
/// assert_eq!(to, [2.5; 100]);
/// ```
#[inline]
pub fn widest_fused<R>(work: impl FnOnce(bool) -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::is_x86_feature_detected as detected;
        let fused = detected!("avx2") && detected!("fma");
        if fused && detected!("avx512f") && detected!("avx512vl") && detected!("avx512dq") {
            // SAFETY: the processor has these instructions, and the system saves their registers.
            return unsafe { with_avx512(work) };
        }
        if fused {
            // SAFETY: as above.
            return unsafe { with_avx2(work) };
        }
    }
    work(cfg!(target_feature = "fma"))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,fma")]
fn with_avx512<R>(work: impl FnOnce(bool) -> R) -> R {
    work(true)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn with_avx2<R>(work: impl FnOnce(bool) -> R) -> R {
    work(true)
}

#[cfg(test)]
mod tests {
    use super::{widest, widest_fused};

    /// Row by row, as in an elimination; loops of all lengths.
    #[inline(always)]
    fn eliminate(matrix: &mut [f64], size: usize) {
        for i in 1..size {
            let (above, row) = matrix.split_at_mut(i * size);
            for (l, above) in above.chunks_exact(size).enumerate() {
                let factor = row[l] / above[l];
                row[..size].iter_mut().zip(above).skip(l).for_each(|(entry, above)| *entry -= factor * above);
            }
        }
    }

    #[test]
    fn every_copy_gives_the_same_bits() {
        for size in 1..40 {
            let value = |k: usize| if k.is_multiple_of(size + 1) { 9.0 } else { (k as f64 * 0.7).sin() };
            let matrix: Vec<f64> = (0..size * size).map(value).collect();
            let (mut plain, mut widened) = (matrix.clone(), matrix);
            eliminate(&mut plain, size);
            let moved = String::from("values move in and out");
            let back = widest(
                #[inline(always)]
                || {
                    eliminate(&mut widened, size);
                    moved
                },
            );
            assert_eq!(back.len(), 22);
            let bits = |matrix: &[f64]| matrix.iter().map(|entry| entry.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&plain), bits(&widened), "size {size}");
            #[cfg(target_arch = "x86_64")]
            if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
                let mut narrower: Vec<f64> = (0..size * size).map(value).collect();
                // SAFETY: the processor has these instructions.
                unsafe {
                    super::with_avx2(
                        #[inline(always)]
                        |_| eliminate(&mut narrower, size),
                    );
                }
                assert_eq!(bits(&plain), bits(&narrower), "size {size}");
            }
        }
    }

    #[test]
    fn fused_products_round_once() {
        let (a, b) = (1.0 + f64::EPSILON, 1.0 - f64::EPSILON);
        // a b = 1 - eps^2, which rounds to 1.
        let fused = widest_fused(|fused| (fused, if fused { a.mul_add(b, -1.0) } else { a * b - 1.0 }));
        assert_eq!(fused.1, if fused.0 { -f64::EPSILON * f64::EPSILON } else { 0.0 });
    }

    #[test]
    fn a_panic_passes_through() {
        let caught = std::panic::catch_unwind(|| {
            widest(|| {
                if true {
                    panic!("of the work")
                }
            })
        });
        assert!(caught.is_err());
    }
}
