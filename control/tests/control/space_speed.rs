//! The speed at which a biped in space has its least cost of transport.

use super::gaits::{example, solved};
use super::space_walk::check;
use costate_control::{Certificate, FinalTime, Problem, Solution, SolverOptions, Status, Verify};

fn solve(problem: &Problem, options: &SolverOptions) -> Solution {
    let solution = solved(problem, options.clone());
    assert_eq!(solution.motion.status, Status::Converged);
    solution
}

/// J/(m g L), which a free time makes least: faster and slower steps of the same length have more of it.
#[test]
fn a_biped_finds_the_speed_of_its_least_cost_of_transport() {
    let file = example("biped_best_speed");
    let (problem, options) = (file.problem, file.options.with_verify(Verify::Factors));
    let best = solve(&problem, &options);
    assert_eq!(best.motion.certificate, Certificate::LocalMinimumOnMesh);
    check(&problem, &best);
    let gait = best.gait.as_ref().unwrap();
    let (time, least) = (best.motion.final_time, best.total() / gait.weight_times_length);
    assert!((gait.speed - 0.3 / time).abs() < 1e-9);
    // The motors' work is a part of all that is spent.
    assert!(gait.cost_of_transport > 0.0 && gait.cost_of_transport < least, "{gait:?} {least}");
    println!("{} m/s, J/(m g L) {least}, cost of transport {}", gait.speed, gait.cost_of_transport);
    for factor in [0.93, 1.07] {
        let at = problem.clone().with_time(FinalTime::Fixed(time / factor));
        let other = solve(&at, &options);
        let gait = other.gait.as_ref().unwrap();
        let cost = other.total() / gait.weight_times_length;
        println!("{} m/s, J/(m g L) {cost}", gait.speed);
        // Near the least value: above it, by little.
        assert!(cost > least && cost < 1.05 * least, "{factor}: {cost} {least}");
    }
}
