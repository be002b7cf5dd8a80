//! Time against the number of joints and the number of nodes.

use crate::fit::Power;
use crate::measure::{Measured, measure, median};
use crate::plot::{Line, Plot};
use crate::problems::{Failure, of_chain, of_file};
use crate::tables::{duration, exponent, markdown};
use costate::codegen::{Coordinates, ProgramOptions, Quantity, robot_program};
use costate::robot::Robot;
use costate_control::{MachineCode, Polish, SolverOptions, Verify};

/// Numbers of joints.
const JOINTS: [usize; 9] = [2, 3, 4, 6, 8, 10, 12, 16, 24];
/// Most joints, and most steps of a program, for which the solver writes machine code.
const COMPILED: (usize, usize) = (14, 16_000);
/// Motions of each chain.
const MOTIONS: u64 = 5;
/// Nodes of the mesh on which Newton steps are timed: 14 intervals.
const NODES: usize = 43;
/// Intervals of the meshes of one arm.
const INTERVALS: [usize; 8] = [7, 14, 28, 56, 112, 224, 448, 667];
const REPEATS: usize = 5;
const COLORS: [&str; 3] = ["#005aa0", "#c85000", "#00825f"];

fn options(machine_code: MachineCode) -> SolverOptions {
    SolverOptions::default()
        .with_tolerance(1e-4)
        .with_verify(Verify::Factors)
        .with_polish(Polish::Never)
        .with_machine_code(machine_code)
}

/// On one mesh, as far as Newton's method goes there.
fn on_mesh(options: SolverOptions, nodes: usize) -> SolverOptions {
    options.with_nodes(nodes).with_max_nodes(nodes)
}

/// Whether there is machine code of the second derivatives of inverse dynamics.
fn is_compiled(robot: &Robot) -> bool {
    let (joints, steps) = COMPILED;
    let options = ProgramOptions::default().with_limit(steps);
    let program = robot_program(robot, Quantity::YTauZZ, Coordinates::Lagrangian, &options);
    robot.dof() <= joints && program.is_ok_and(|program| program.steps() <= steps)
}

/// Table and plot over the number of joints.
pub fn joints(short: bool) -> Result<(String, Plot), Failure> {
    let (counts, motions, repeats) =
        if short { (&JOINTS[..5], 1, 1) } else { (&JOINTS[..], MOTIONS, REPEATS) };
    let mut rows = Vec::new();
    let (mut compiled, mut generic, mut whole) = (Vec::new(), Vec::new(), Vec::new());
    for &n in counts {
        let steps = |machine_code| -> Result<f64, Failure> {
            let each: Result<Vec<f64>, Failure> = (0..motions)
                .map(|seed| {
                    Ok(measure(&of_chain(n, seed)?, &on_mesh(options(machine_code), NODES), repeats)?.step)
                })
                .collect();
            Ok(median(each?))
        };
        let is_compiled = is_compiled(&of_chain(n, 0)?.robot);
        let by_code = if is_compiled { steps(MachineCode::AtOnce)? } else { f64::NAN };
        let by_generic = steps(MachineCode::Never)?;
        let solves: Result<Vec<Measured>, Failure> = (0..motions)
            .map(|seed| Ok(measure(&of_chain(n, seed)?, &options(MachineCode::AtOnce), repeats)?))
            .collect();
        let solves = solves?;
        let of = |value: fn(&Measured) -> f64| median(solves.iter().map(value).collect());
        let (solve, x) = (of(|found| found.solve), n as f64);
        if is_compiled {
            compiled.push((x, by_code));
        }
        generic.push((x, by_generic));
        whole.push((x, solve));
        let solved = solves.iter().filter(|found| found.solved).count();
        rows.push(vec![
            n.to_string(),
            duration(by_code),
            duration(by_generic),
            duration(solve),
            format!("{:.0}", of(|found| found.steps as f64)),
            format!("{:.0}", of(|found| found.nodes as f64)),
            format!("{solved} of {}", solves.len()),
        ]);
        eprintln!("{n} joints: step {}, solve {}", duration(by_generic), duration(solve));
    }
    let [of_compiled, of_generic, of_whole] =
        [&compiled, &generic, &whole].map(|points| Power::through(points));
    rows.push(
        ["exponent".into(), exponent(of_compiled), exponent(of_generic), exponent(of_whole)]
            .into_iter()
            .chain(std::iter::repeat_n(String::new(), 3))
            .collect(),
    );
    let head = ["joints", "Newton step", "by generic code", "whole solve", "steps", "nodes", "solved"];
    let line = |k: usize, name: &str, points, power, dashed| Line {
        name: name.into(),
        points,
        power,
        color: COLORS[k],
        dashed,
    };
    let plot = Plot {
        title: "Time of an optimal motion against the number of joints".into(),
        axis: "joints of a serial chain with general axes; rates and torques limited".into(),
        note: format!(
            "steps on {NODES} nodes; whole solves to a relative error of 1e-4 of the cost; medians, one core"
        ),
        marks: counts.iter().map(|&n| n as f64).collect(),
        lines: vec![
            line(0, "whole solve", whole, of_whole, false),
            line(1, "step, generic code", generic, of_generic, true),
            line(2, "step, machine code", compiled, of_compiled, false),
        ],
    };
    Ok((markdown(&head, &rows), plot))
}

/// Table and plot over the number of nodes: a UR5 that keeps the limits of its joints.
pub fn nodes(short: bool) -> Result<(String, Plot), Failure> {
    let problem = of_file("ur5_limits.toml")?;
    let intervals = if short { &INTERVALS[..4] } else { &INTERVALS[..] };
    let repeats = if short { 1 } else { REPEATS };
    let (mut rows, mut steps, mut whole) = (Vec::new(), Vec::new(), Vec::new());
    for count in intervals {
        let nodes = 3 * count + 1;
        let found = measure(&problem, &on_mesh(options(MachineCode::AtOnce), nodes), repeats)?;
        steps.push((nodes as f64, found.step));
        whole.push((nodes as f64, found.solve));
        let each = [found.step / nodes as f64, found.step, found.solve].map(duration);
        let [per_node, step, solve] = each;
        rows.push(vec![nodes.to_string(), step, per_node, solve, found.steps.to_string()]);
        eprintln!("{nodes} nodes: step {}, solve {}", duration(found.step), duration(found.solve));
    }
    let [of_steps, of_whole] = [&steps, &whole].map(|points| Power::through(points));
    rows.push(vec!["exponent".into(), exponent(of_steps), String::new(), exponent(of_whole), String::new()]);
    let head = ["nodes", "Newton step", "of it, a node", "whole solve", "steps"];
    let line = |k: usize, name: &str, points, power| Line {
        name: name.into(),
        points,
        power,
        color: COLORS[k],
        dashed: false,
    };
    let plot = Plot {
        title: "Time of an optimal motion against the number of nodes".into(),
        axis: "nodes of the mesh; a UR5 with the limits of its joints".into(),
        note: "on one mesh, as far as Newton's method goes there; machine code; medians, one core".into(),
        marks: vec![20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0],
        lines: vec![line(0, "whole solve", whole, of_whole), line(2, "Newton step", steps, of_steps)],
    };
    Ok((markdown(&head, &rows), plot))
}
