//! One call of one method, for the runner of gungraun.

use crate::selected;
use costate_routes::cases::Case;
use costate_routes::routes::Call;
use gungraun::{library_benchmark, library_benchmark_group};

/// The call in this place of all that are counted, made ready and called once; None where there is no such
/// method.
fn ready([case, route]: [usize; 2]) -> Option<Call<'static>> {
    let case: &Case = Box::leak(Box::new(Case::files().unwrap().swap_remove(case)));
    let (_, candidate) = selected::counted(case, |place| place == route).unwrap().pop()?;
    let mut work = candidate.work;
    work(None).unwrap();
    Some(work)
}

// Two benches never share a name: `call.CASE_ROUTE`.
#[library_benchmark]
#[benches::ur5(iter = (0..10).map(|route| [0, route]), setup = ready)]
#[benches::panda(iter = (0..10).map(|route| [1, route]), setup = ready)]
#[benches::biped(iter = (0..10).map(|route| [2, route]), setup = ready)]
fn call(work: Option<Call<'static>>) -> Option<Call<'static>> {
    let mut work = work?;
    work(None).unwrap();
    Some(work)
}

library_benchmark_group!(name = routes; benchmarks = call);
gungraun::main!(library_benchmark_groups = routes);

/// To the runner, or, where it is the runner that asks, one call.
pub fn hand_over() {
    main();
}
