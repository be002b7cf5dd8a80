//! The verdict, generated from the numbers.

use super::compare::{Comparison, Goal, Reached, ending, order, rate, reached};
use super::problem::Solution;

/// The goals that are timed.
const GOALS: [(&str, Goal); 3] = [
    ("cost within 1 %", Goal::Cost(0.01)),
    ("gradient 1e-4", Goal::Gradient(1e-4)),
    ("gradient 1e-10", Goal::Gradient(1e-10)),
];

/// Times whose ratio is closer to 1 are called equal, since timings vary by this much.
const EQUAL: f64 = 1.2;

/// The paragraph below the table of a task.
pub fn of_task(comparison: &Comparison) -> String {
    let Comparison { exact, twin, .. } = comparison;
    let mut text = String::new();
    for (name, solution) in [("exact DDP", exact), ("iLQR", twin)] {
        text += &format!("{name:9} {}\n", summary(solution));
    }
    if !comparison.agree() {
        let (better, by) = if exact.trajectory.cost < twin.trajectory.cost {
            ("exact DDP", twin.trajectory.cost - exact.trajectory.cost)
        } else {
            ("iLQR", exact.trajectory.cost - twin.trajectory.cost)
        };
        text += &format!("The two end at different costs: that of {better} is lower by {by:.1e}.\n");
    }
    text += &format!("\n{:16} {:>10} {:>10}   {}\n", "to reach", "exact DDP", "iLQR", "time");
    for (what, goal) in GOALS {
        let [exact, twin] = [exact, twin].map(|solution| reached(solution, goal));
        let iterations = |reached: Option<Reached>| {
            reached.map_or_else(|| "never".to_owned(), |reached| format!("{} it", reached.iteration))
        };
        text += &format!(
            "{what:16} {:>10} {:>10}   {}\n",
            iterations(exact),
            iterations(twin),
            times(exact, twin)
        );
    }
    text
}

/// One search as a line.
fn summary(solution: &Solution) -> String {
    let count = solution.count;
    let last = solution.log.len() - 1;
    let order = match (order(solution), rate(solution)) {
        (Some(order), Some(rate)) => format!("order {order:.1}, gradient times {rate:.0e} in each iteration"),
        _ => "too few whole steps to tell an order".to_owned(),
    };
    format!(
        "{} after {last} iterations, cost {:.6}\n{:9} at the end: {order}\n{:9} steps evaluated: {} values, {} \
         linearisations, {} contractions",
        ending(solution.status),
        solution.trajectory.cost,
        "",
        "",
        count.advances,
        count.linearisations,
        count.contractions
    )
}

/// Which of the two was first.
fn times(exact: Option<Reached>, twin: Option<Reached>) -> String {
    match (exact, twin) {
        (Some(exact), Some(twin)) => {
            let ratio = twin.seconds / exact.seconds;
            if ratio >= EQUAL {
                format!("exact DDP {ratio:.1} times faster")
            } else if ratio <= 1.0 / EQUAL {
                format!("iLQR {:.1} times faster", 1.0 / ratio)
            } else {
                "equal".to_owned()
            }
        }
        (Some(_), None) => "only exact DDP".to_owned(),
        (None, Some(_)) => "only iLQR".to_owned(),
        (None, None) => "neither".to_owned(),
    }
}

/// The table of all tasks and the sentences below it.
pub fn of_all(comparisons: &[Comparison]) -> String {
    let mut text = String::new();
    text += &format!("{:37}  order at end   it. to 1e-10      time of iLQR / of exact DDP\n", "");
    text += &format!("{:37}   DDP   iLQR     DDP   iLQR    to 1 % cost    to 1e-4   to 1e-10\n", "task");
    text += &format!("{}\n", "-".repeat(103));
    for comparison in comparisons {
        let Comparison { title, exact, twin, .. } = comparison;
        let [order_exact, order_twin] = [exact, twin]
            .map(|solution| order(solution).map_or("-".to_owned(), |order| format!("{order:.1}")));
        let both = GOALS.map(|(_, goal)| [exact, twin].map(|solution| reached(solution, goal)));
        let [it_exact, it_twin] =
            both[2].map(|reached| reached.map_or("-".to_owned(), |reached| reached.iteration.to_string()));
        let ratio = both.map(|[exact, twin]| match (exact, twin) {
            (Some(exact), Some(twin)) => format!("{:.1}", twin.seconds / exact.seconds),
            (Some(_), None) => "only DDP".to_owned(),
            (None, Some(_)) => "only iLQR".to_owned(),
            (None, None) => "neither".to_owned(),
        });
        text += &format!(
            "{title:37} {order_exact:>5} {order_twin:>6} {it_exact:>7} {it_twin:>6} {:>14} {:>10} {:>10}\n",
            ratio[0], ratio[1], ratio[2]
        );
    }
    text.push('\n');
    for (k, (what, _)) in GOALS.iter().enumerate() {
        text += &sentence(comparisons, what, GOALS[k].1);
    }
    text += &orders(comparisons);
    text
}

/// How often each method was first.
fn sentence(comparisons: &[Comparison], what: &str, goal: Goal) -> String {
    let (mut wins, mut losses, mut equal) = (0, 0, 0);
    for comparison in comparisons {
        let [exact, twin] = [&comparison.exact, &comparison.twin]
            .map(|solution| reached(solution, goal).map_or(f64::INFINITY, |reached| reached.seconds));
        match twin / exact {
            ratio if ratio >= EQUAL => wins += 1,
            ratio if ratio <= 1.0 / EQUAL => losses += 1,
            _ => equal += 1,
        }
    }
    let all = comparisons.len();
    format!(
        "{what}: exact DDP is there first in {wins} of {all} tasks, iLQR in {losses}, neither in {equal}.\n"
    )
}

/// The orders of convergence.
fn orders(comparisons: &[Comparison]) -> String {
    let of = |pick: fn(&Comparison) -> &Solution| {
        let orders: Vec<f64> = comparisons.iter().filter_map(|comparison| order(pick(comparison))).collect();
        let [low, high] =
            [f64::min as fn(f64, f64) -> f64, f64::max].map(|f| orders.iter().copied().reduce(f));
        let quadratic = orders.iter().filter(|&&order| order > 1.5).count();
        match (low, high) {
            (Some(low), Some(high)) => format!(
                "{low:.1} to {high:.1} in the {} tasks that tell: {quadratic} nearer to quadratic, {} to linear",
                orders.len(),
                orders.len() - quadratic
            ),
            _ => "not to be told".to_owned(),
        }
    };
    let [exact, twin] = [of(|comparison| &comparison.exact), of(|comparison| &comparison.twin)];
    format!("Order at the end, exact DDP: {exact}.\nOrder at the end, iLQR: {twin}.\n")
}
