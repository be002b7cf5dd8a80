//! The calls that are counted.

use costate_routes::cases::Case;
use costate_routes::routes::{Candidate, Failure};
use costate_routes::{FIRST, FUNCTION, SECOND, wanted};

/// What is counted, for one state each.
pub const COUNTED: [(&str, &str); 10] = [
    (FUNCTION, "analytic"),
    (FUNCTION, "generated Rust"),
    (FUNCTION, "machine code (jit)"),
    (FIRST, "analytic"),
    (FIRST, "generated Rust"),
    (FIRST, "machine code (jit)"),
    (SECOND, "2n+1 rule"),
    (SECOND, "one dual pass through F_x"),
    (SECOND, "generated Rust"),
    (SECOND, "machine code (jit)"),
];

/// The methods of a case that are counted, each with its place in [`COUNTED`], as far as that place is asked
/// for.
pub fn counted(case: &Case, places: impl Fn(usize) -> bool) -> Result<Vec<(usize, Candidate<'_>)>, Failure> {
    let place = |quantity: &str, route: &str| {
        COUNTED.iter().position(|&counted| counted == (quantity, route)).filter(|&place| places(place))
    };
    let list = wanted(case, &|quantity, route| place(quantity, route).is_some())?;
    Ok(list.into_iter().filter_map(|c| Some((place(c.quantity, c.route)?, c))).collect())
}
