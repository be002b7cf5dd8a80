//! Generated Rust, compiled with this program: one state, and lanes of four and eight.

use crate::cases::Case;
use crate::names::{FIRST, FUNCTION, SECOND};
use crate::routes::{Candidate, Failure};
use crate::texts::{Arrays, Call, Text};
use costate::scalar::{Lanes, Scalar, Vector};
use std::hint::black_box;

const ONE: &str = "generated Rust";
const FOUR: &str = "generated Rust over F64x4: one of 4 states";
const EIGHT: &str = "generated Rust over F64x8: one of 8 states";

/// States that one call of a method computes, where it is one of these.
pub fn states(route: &str) -> Option<usize> {
    [(ONE, 1), (FOUR, 4), (EIGHT, 8)].into_iter().find_map(|(name, states)| (name == route).then_some(states))
}

/// For F, F_x and y'F_xx, as far as there is a text for the robot.
pub fn candidates<'a>(case: &'a Case, list: &mut Vec<Candidate<'a>>) {
    for (label, quantity) in [(FUNCTION, "f"), (FIRST, "f_x"), (SECOND, "y_f_xx")] {
        let Some(text) = Text::of(case.robot.name(), quantity) else { continue };
        add([label, ONE], case, text.one, |x| x, |&x| x, list);
        lanes([label, FOUR], case, text.four, list);
        lanes([label, EIGHT], case, text.eight, list);
    }
}

/// The first lane holds the state of all other methods.
fn lanes<'a, V: Vector + 'a>(
    names: [&'static str; 2],
    case: &'a Case,
    call: Call<Lanes<V>>,
    list: &mut Vec<Candidate<'a>>,
) {
    let spread = |x: f64| Lanes::from_lanes(&std::array::from_fn::<_, 8, _>(|k| x * (1.0 - 0.05 * k as f64)));
    add(names, case, call, spread, |x| x.lane(0), list);
}

fn add<'a, T: Scalar + 'a>(
    [quantity, route]: [&'static str; 2],
    case: &'a Case,
    call: Call<T>,
    from: impl Fn(f64) -> T,
    first: impl Fn(&T) -> f64 + 'a,
    list: &mut Vec<Candidate<'a>>,
) {
    let state = &case.state;
    let [x, u, y] = [&state.x, &state.u, &state.y].map(|a| a.iter().map(|&a| from(a)).collect::<Vec<T>>());
    let mut arrays = Arrays::new(&x, &u, &y);
    let work = move |to: Option<&mut Vec<f64>>| -> Result<(), Failure> {
        call(black_box(&mut arrays))?;
        if let Some(to) = to {
            let result = match quantity {
                FUNCTION => &arrays.f,
                FIRST => &arrays.f_x,
                _ => &arrays.y_f_xx,
            };
            to.extend(result.iter().map(&first));
        }
        Ok(())
    };
    list.push(Candidate { quantity, route, work: Box::new(work) });
}
