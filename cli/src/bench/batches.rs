//! Batches: many states at once, from and to node-major arrays, by vector lanes and threads.

use super::names::{LANES_4, LANES_8, states};
use super::routes::{Candidate, F, FIRST, Failure, SECOND, State};
use costate::batch::{Batch, FirstOrderArrays, Model, Packed, SecondOrderArrays};
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::robot::Robot;
use costate::scalar::{F64x4, F64x8};
use std::hint::black_box;

pub fn candidates(robot: &Robot, state: &State, list: &mut Vec<Candidate<'_>>, notes: &mut Vec<String>) {
    for quantity in [F, FIRST, SECOND] {
        let four = Batch::<F64x4, _>::new(Model(HamiltonianSecondOrder::new(robot)));
        list.push(candidate([quantity, LANES_4], four, state));
        let eight = Batch::<F64x8, _>::new(Model(HamiltonianSecondOrder::new(robot)));
        list.push(candidate([quantity, LANES_8], eight, state));
        #[cfg(feature = "rayon")]
        list.push(over_threads(robot, quantity, state));
    }
    notes.push(match cfg!(feature = "rayon") {
        true => {
            "Batches over threads use all threads of the machine; the time per state is that of all threads together."
                .into()
        }
        false => "No batches over threads: built without the feature rayon.".into(),
    });
}

#[cfg(feature = "rayon")]
fn over_threads(robot: &Robot, quantity: &'static str, state: &State) -> Candidate<'static> {
    let batch = Batch::<costate::batch::Native, _>::parallel(|| Model(HamiltonianSecondOrder::new(robot)));
    candidate([quantity, super::names::THREADS], batch, state)
}

/// As many states as one call of the method computes; the first is the state of all other methods.
fn candidate<S: Packed<Lane = f64>>(
    [quantity, route]: [&'static str; 2],
    mut batch: Batch<S, Model<HamiltonianSecondOrder<S>>>,
    state: &State,
) -> Candidate<'static> {
    let states = states(route);
    let spread = |entries: &[f64]| -> Vec<f64> {
        let scale = |k: usize| 1.0 - 0.5 * k as f64 / states as f64;
        (0..states).flat_map(|k| entries.iter().map(move |entry| entry * scale(k))).collect()
    };
    let [x, u, y] = [&state.x, &state.u, &state.y].map(|entries| spread(entries));
    let square = state.x.len() * state.x.len();
    let [mut f, mut f_x, mut xx] = [state.x.len(), square, square].map(|entries| vec![0.0; states * entries]);
    let work = move |to: Option<&mut Vec<f64>>| -> Result<(), Failure> {
        let x = black_box(x.as_slice());
        let first = FirstOrderArrays { f: &mut f, f_x: &mut f_x, ..Default::default() };
        let failures = match quantity {
            F => batch.evaluate(x, &u, &mut f)?,
            FIRST => batch.linearise(x, &u, first)?,
            _ => {
                batch.contract([x, &u, &y], first, SecondOrderArrays { xx: &mut xx, ..Default::default() })?
            }
        };
        if let Some(failure) = failures.first() {
            return Err(failure.to_string().into());
        }
        let result = black_box(match quantity {
            F => &f[..f.len() / states],
            FIRST => &f_x[..square],
            _ => &xx[..square],
        });
        if let Some(to) = to {
            to.extend(result);
        }
        Ok(())
    };
    Candidate { quantity, route, work: Box::new(work) }
}
