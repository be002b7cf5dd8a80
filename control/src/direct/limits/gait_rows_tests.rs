use super::{Derivatives, GaitRows};
use crate::direct::points::values::Points;
use crate::problem::{Gait, MotionLimits, Objective, Problem, SoleContact};
use costate_test_support::robots::file;

/// A step of RABBIT with its multipliers.
pub(in crate::direct) fn rabbit() -> Problem {
    rabbit_step().with_multipliers().unwrap()
}

/// One that begins on both feet, for a part of its time.
pub(in crate::direct) fn rabbit_on_both_feet() -> Problem {
    on_both_feet(rabbit_step(), SoleContact::Toe)
}

/// The same of the biped with feet, whose foot behind stands so.
pub(in crate::direct) fn seven_link_on_both_feet(trailing: SoleContact) -> Problem {
    on_both_feet(seven_link_step(), trailing)
}

fn on_both_feet(problem: Problem, trailing: SoleContact) -> Problem {
    let gait = problem.gait.clone().unwrap().with_double_support(0.2).with_trailing(trailing);
    problem.with_gait(gait).with_multipliers().unwrap()
}

fn rabbit_step() -> Problem {
    let q = [-0.25, 0.72, 0.1, 0.1, 0.3, -0.6, 0.3];
    let gait = Gait::new(&["right_foot"], &["left_foot"], "base_x", 0.5)
        .with_clearance(0.05)
        .with_mirror(&[["left_hip", "right_hip"], ["left_knee", "right_knee"]]);
    let most = [[0.0; 3].as_slice(), &[150.0; 4]].concat();
    let effort = [[0.0; 3].as_slice(), &[1.0; 4]].concat();
    Problem::rest_to_rest(file("rabbit.toml"), &q, &q, 0.7)
        .with_cost(Objective::new(0.0, effort))
        .with_limits(MotionLimits::none().with_torque_max(most))
        .with_gait(gait)
}

/// A step of the biped with feet, with its multipliers.
pub(in crate::direct) fn seven_link() -> Problem {
    seven_link_step().with_multipliers().unwrap()
}

fn seven_link_step() -> Problem {
    let q = [-0.25, 0.9, 0.05, 0.2, 0.15, -0.35, -0.4, 0.2, 0.2];
    let gait = Gait::new(&["right_foot"], &["left_foot"], "base_x", 0.5)
        .with_clearance(0.05)
        .with_sole(-0.0665, 0.125)
        .with_mirror(&[
            ["left_hip", "right_hip"],
            ["left_knee", "right_knee"],
            ["left_ankle", "right_ankle"],
        ]);
    let most = [[0.0; 3].as_slice(), &[200.0; 6]].concat();
    let effort = [[0.0; 3].as_slice(), &[1.0; 6]].concat();
    Problem::rest_to_rest(file("seven_link.toml"), &q, &q, 0.6)
        .with_cost(Objective::new(0.0, effort))
        .with_limits(MotionLimits::none().with_torque_max(most))
        .with_gait(gait)
}

/// A step of the biped in space, with its multipliers.
pub(in crate::direct) fn walker() -> Problem {
    walker_on(|gait| gait.with_sole(-0.0488, 0.1371).with_sole_width(0.0958))
}

/// The same with both soles on the ground at first, of which the one behind stands so.
pub(in crate::direct) fn walker_on_both_feet(trailing: SoleContact) -> Problem {
    let soles = |gait: Gait| gait.with_sole(-0.0488, 0.1371).with_sole_width(0.0958);
    walker_on(|gait| soles(gait).with_double_support(0.2).with_trailing(trailing))
}

/// The same on points below its ankles.
fn walker_on_points() -> Problem {
    walker_on(|gait| gait)
}

fn walker_on(feet: impl Fn(Gait) -> Gait) -> Problem {
    let q = [
        [-0.2, 0.02, 0.83, 0.02, -0.03, 0.05].as_slice(),
        &[0.1, 0.03, 0.02, 0.6, -0.7, 0.04],
        &[-0.6, 0.02, -0.03, 0.6, 0.0, -0.02],
    ];
    let parts = ["hip_pitch", "hip_roll", "hip_yaw", "knee", "ankle_pitch", "ankle_roll"];
    let [left, right] = ["left", "right"].map(|side| parts.map(|part| format!("{side}_{part}")));
    let pairs: Vec<[&str; 2]> = left.iter().zip(&right).map(|(a, b)| [&**a, &**b]).collect();
    let flips = |name: &&String| name.ends_with("roll") || name.ends_with("yaw");
    let of_legs = left.iter().chain(&right).filter(flips).map(String::as_str);
    let flipped: Vec<&str> = ["base_y", "base_yaw", "base_roll"].into_iter().chain(of_legs).collect();
    let gait = Gait::new(&["right_foot"], &["left_foot"], "base_x", 0.4)
        .with_clearance(0.05)
        .in_space(&flipped, 0.15)
        .with_mirror(&pairs);
    let most = [[0.0; 6].as_slice(), &[200.0; 12]].concat();
    let effort = [[0.0; 6].as_slice(), &[1.0; 12]].concat();
    let q = q.concat();
    let problem = Problem::rest_to_rest(file("biped_walker.toml"), &q, &q, 0.6)
        .with_cost(Objective::new(0.0, effort))
        .with_limits(MotionLimits::none().with_torque_max(most))
        .with_gait(feet(gait));
    problem.with_multipliers().unwrap()
}

fn rows(problem: &Problem) -> GaitRows {
    let loops = problem.loops.as_ref().unwrap();
    GaitRows::new(loops, loops.walk.as_ref().unwrap())
}

/// g, its derivatives by both states, and the weighted second ones by each.
fn derivatives(rows: &mut GaitRows, states: [&[f64]; 2], weights: &[f64]) -> [Vec<f64>; 5] {
    let (count, width) = (weights.len(), states[0].len());
    let zeros = |size: usize| vec![0.0; size];
    let mut all = [
        zeros(count),
        zeros(count * width),
        zeros(count * width),
        zeros(width * width),
        zeros(width * width),
    ];
    let [g, near, far, at_start, at_end] = &mut all;
    rows.contract(states, weights, g, Derivatives { near, far, at_start, at_end }).unwrap();
    all
}

#[test]
fn derivatives_at_the_ends_are_those_of_differences() {
    let all = [rabbit(), seven_link(), rabbit_on_both_feet(), walker(), walker_on_points()];
    let contacts = [SoleContact::Toe, SoleContact::Flat];
    let both = contacts.map(seven_link_on_both_feet).into_iter().chain(contacts.map(walker_on_both_feet));
    all.into_iter().chain(both).for_each(|problem| compare_ends(&problem));
}

fn compare_ends(problem: &Problem) {
    let mut rows = rows(problem);
    let (width, count) = (2 * problem.coordinates(), rows.bounds().len());
    let some = |first: f64, n: usize| (0..n).map(|i| (first + 1.3 * i as f64).sin()).collect::<Vec<_>>();
    let (states, weights) = ([some(0.2, width), some(1.1, width)], some(2.4, count));
    let all =
        |rows: &mut GaitRows, states: &[Vec<f64>; 2]| derivatives(rows, [&states[0], &states[1]], &weights);
    let [g, near, far, at_start, at_end] = all(&mut rows, &states);
    let mut values = vec![0.0; count];
    rows.values([&states[0], &states[1]], &mut values).unwrap();
    assert_eq!(g, values);
    let h = 1e-5;
    // Heavier links have larger third derivatives.
    let size = g.iter().fold(1.0_f64, |most, g| most.max(g.abs()));
    let close = |found: f64, expected: f64| (found - expected).abs() < 1e-7 * (size + expected.abs());
    for (end, jacobian, hessian) in [(0, &near, &at_start), (1, &far, &at_end)] {
        for j in 0..width {
            let at = |rows: &mut GaitRows, h: f64| {
                let mut states = states.clone();
                states[end][j] += h;
                all(rows, &states)
            };
            let (plus, minus) = (at(&mut rows, h), at(&mut rows, -h));
            for r in 0..count {
                let expected = (plus[0][r] - minus[0][r]) / (2.0 * h);
                assert!(close(jacobian[width * r + j], expected), "{end} {r} {j}: {expected}");
            }
            for (other, own) in [(0, end == 0), (1, end == 1)] {
                let weighted = |of: &[Vec<f64>; 5], i: usize| {
                    (0..count).map(|r| weights[r] * of[1 + other][width * r + i]).sum::<f64>()
                };
                for i in 0..width {
                    let expected = (weighted(&plus, i) - weighted(&minus, i)) / (2.0 * h);
                    let found = if own { hessian[width * i + j] } else { 0.0 };
                    assert!(close(found, expected), "{end} {other} {i} {j}: {found} {expected}");
                }
            }
        }
    }
}

#[test]
fn derivatives_of_the_height_are_those_of_differences() {
    let problem = rabbit();
    let (mut rows, all) = (rows(&problem), problem.coordinates());
    let mut points = Points::default();
    points.resize(all, [1, 0], std::iter::once(1));
    points.g_weights[0] = 0.7;
    let at = |rows: &mut GaitRows, points: &mut Points, j: usize, h: f64| {
        points.z.iter_mut().enumerate().for_each(|(i, z)| *z = (0.4 + 1.7 * i as f64).sin());
        points.z[j] += h;
        points.hessian.fill(0.0);
        rows.contract_heights(points, 0).unwrap();
        (points.g[0], points.g_x.clone(), points.hessian.clone())
    };
    let (_, g_x, hessian) = at(&mut rows, &mut points, 0, 0.0);
    assert!(g_x.iter().any(|entry| entry.abs() > 0.1));
    let h = 1e-5;
    for j in 0..3 * all {
        let plus = at(&mut rows, &mut points, j, h);
        let minus = at(&mut rows, &mut points, j, -h);
        let slope = (plus.0 - minus.0) / (2.0 * h);
        let found = g_x.get(j).copied().unwrap_or(0.0);
        assert!((found - slope).abs() < 1e-8, "{j}: {found} {slope}");
        for i in 0..2 * all {
            let expected = 0.7 * (plus.1[i] - minus.1[i]) / (2.0 * h);
            let found = hessian[3 * all * i + j];
            assert!((found - expected).abs() < 1e-8, "{i} {j}: {found} {expected}");
        }
    }
}

/// The heights of heel and toe, and the load of the toe, which is linear.
#[test]
fn derivatives_of_soles_are_those_of_differences() {
    compare_soles(&seven_link(), [2, 1, 12]);
    compare_soles(&walker(), [4, 16, 24]);
    compare_soles(&seven_link_on_both_feet(SoleContact::Toe), [2, 1, 14]);
    compare_soles(&seven_link_on_both_feet(SoleContact::Flat), [2, 2, 15]);
    compare_soles(&walker_on_both_feet(SoleContact::Flat), [4, 32, 30]);
    compare_soles(&walker_on_both_feet(SoleContact::Toe), [4, 22, 29]);
}

fn compare_soles(problem: &Problem, [heights, forces, all]: [usize; 3]) {
    let mut rows = rows(problem);
    assert_eq!((rows.along().len(), rows.forces().len(), problem.coordinates()), (heights, forces, all));
    let joints = problem.robot.dof();
    let mut points = Points::default();
    points.resize(all, [heights, forces], std::iter::once(1));
    let weights: Vec<f64> = (0..heights).map(|i| 0.7 - 0.6 * i as f64).collect();
    points.g_weights.copy_from_slice(&weights);
    let some = |i: usize| (0.4 + 1.7 * i as f64).sin();
    let at = |rows: &mut GaitRows, points: &mut Points, j: usize, h: f64| {
        points.z.iter_mut().enumerate().for_each(|(i, z)| *z = some(i));
        points.z[j] += h;
        points.hessian.fill(0.0);
        rows.contract_heights(points, 0).unwrap();
        rows.soles().unwrap().contract_loads(&points.z, &mut points.h, &mut points.h_z);
        let values = [&points.g[..], &points.h].concat();
        (values, points.g_x.clone(), points.h_z.clone(), points.hessian.clone())
    };
    let (values, g_x, h_z, hessian) = at(&mut rows, &mut points, 0, 0.0);
    let mut load = vec![0.0; forces];
    rows.soles().unwrap().load(&points.z[2 * all + joints..], &mut load);
    assert_eq!(values[heights..], load);
    let h = 1e-5;
    for j in 0..3 * all {
        let plus = at(&mut rows, &mut points, j, h);
        let minus = at(&mut rows, &mut points, j, -h);
        let slope = |row: usize| (plus.0[row] - minus.0[row]) / (2.0 * h);
        for row in 0..heights {
            let found = if j < 2 * all { g_x[2 * all * row + j] } else { 0.0 };
            assert!((found - slope(row)).abs() < 1e-8, "{row} {j}: {found} {}", slope(row));
        }
        for row in 0..forces {
            let (found, slope) = (h_z[3 * all * row + j], slope(heights + row));
            assert!((found - slope).abs() < 1e-6 * (1.0 + found.abs()), "{row} {j}: {found} {slope}");
        }
        for i in 0..2 * all {
            let by = |of: &[f64]| {
                weights.iter().enumerate().map(|(row, weight)| weight * of[2 * all * row + i]).sum::<f64>()
            };
            let expected = (by(&plus.1) - by(&minus.1)) / (2.0 * h);
            let found = hessian[3 * all * i + j];
            assert!((found - expected).abs() < 1e-8, "{i} {j}: {found} {expected}");
        }
    }
}

/// The guess that a step begins with stands on both feet, and the foot that swings ends a step ahead.
#[test]
fn a_step_begins_on_both_feet() {
    let planar = [(rabbit(), 7, 2), (seven_link(), 9, 3), (rabbit_on_both_feet(), 7, 4)];
    let in_space = [(walker(), 18, 6), (walker_on_points(), 18, 3)];
    let contacts = [SoleContact::Toe, SoleContact::Flat];
    let [toe, flat] = contacts.map(seven_link_on_both_feet);
    let [edge, soles] = contacts.map(walker_on_both_feet);
    let both = [(toe, 9, 5), (flat, 9, 6), (edge, 18, 11), (soles, 18, 12)];
    for (problem, n, k) in planar.into_iter().chain(in_space).chain(both) {
        let mut rows = rows(&problem);
        assert_eq!(problem.coordinates(), n + k);
        for q in [&problem.start.q, &problem.end.q] {
            // On the ground at both ends.
            let mut heights = vec![1.0; rows.along().len()];
            rows.heights(q, &mut heights).unwrap();
            assert!(heights.iter().all(|height| height.abs() < 1e-9), "{heights:?}");
        }
        let state = |q: &[f64]| [q, &vec![0.0; n + k]].concat();
        let mut g = vec![0.0; rows.bounds().len()];
        rows.values([&state(&problem.start.q), &state(&problem.end.q)], &mut g).unwrap();
        assert!(g.iter().all(|g| g.abs() < 1e-9), "{g:?}");
    }
}
