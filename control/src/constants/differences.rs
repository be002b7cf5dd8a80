//! Differences of the rows of a motion, which are built anew for other values of a number
//! ([`crate::direct::again`]).
//!
//! A difference over steps h is off by a power of h and by the rounding of the rows, about 1e-16 over h. The
//! steps are near those at which both are equally large.

/// By what displaces links (m, rad), rows are smooth to both sides: the difference of fourth order over this
/// step is off by about `h^4 / 30` of their fifth derivative, 3e-14, and rounded by 1e-13.
pub const DISPLACEMENT: f64 = 1e-3;
/// Its steps, with what the value there counts over the step.
pub const FOURTH_ORDER: [[f64; 2]; 4] =
    [[-2.0, 1.0 / 12.0], [-1.0, -8.0 / 12.0], [1.0, 8.0 / 12.0], [2.0, -1.0 / 12.0]];

/// A radius, a margin or a largest value may be zero and is never negative: the difference of second order
/// above it, over this part of the number, is off by about `h^2 / 3` of the third derivative. Rows are linear
/// in such a number or nearly so.
pub const PART_OF_NUMBER: f64 = 1e-4;
/// Numbers count as at least this large (m, rad, m/s, m/s^2), so that the step is above rounding.
pub const SMALLEST_NUMBER: f64 = 1e-2;
/// Its steps, with what the value there counts over the step.
pub const SECOND_ORDER_ABOVE: [[f64; 2]; 3] = [[0.0, -1.5], [1.0, 2.0], [2.0, -0.5]];
