//! Every lane of every quantity is what `f64` gives for the state of that lane, on any tree.

use costate::configuration::{ConfigurationSpace, FreeKinematics};
use costate::derivative::largest;
use costate::hamiltonian::{DualPass, Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::{self, LagrangianSecondOrder};
use costate::matrix::Block;
use costate::robot::Robot;
use costate::scalar::{Count, Lanes, Scalar, Tangent, Vector};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, all_cases, condition, free_cases};
use costate_test_support::rounding::{apart, bound, lift, of_inverse, terms};
use costate_test_support::wrenches::pulled;
use num_dual::Dual;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

type Quantities<S> = Vec<(&'static str, Vec<S>)>;

/// q, v, p, u and y of one state.
#[derive(Clone, Debug)]
struct State([Vec<f64>; 5]);

/// All that is computed at one state.
fn quantities<S: Scalar>(robot: &Robot, [q, v, p, u, y]: [&[S]; 5]) -> Quantities<S> {
    let n = robot.dof();
    let flat = |block: Block<'_, S>| block.iter_rows().flatten().copied().collect::<Vec<_>>();
    let mut second = HamiltonianSecondOrder::<S>::new(robot);
    let mut lagrangian = LagrangianSecondOrder::<S>::new(robot);
    let mut all = vec![("F", second.first().evaluate(q, p, u).unwrap().to_vec())];
    all.push(("F_x", flat(second.first().linearise(q, p, u).unwrap().matrix())));
    all.push(("y'F_x", second.first().adjoint(q, p, u, y).unwrap().y_f_x.to_vec()));
    all.push(("y'F_xx", flat(second.contract(q, p, u, y).unwrap().matrix())));
    all.push(("y'F_xx y", second.hessian_product(q, p, y, y).unwrap().to_vec()));
    if robot.free_joints().is_empty() {
        let mut dual_pass = DualPass::<S>::new(robot);
        all.push(("y'F_xx by a dual pass", flat(dual_pass.contract(q, p, u, y).unwrap().matrix())));
    }
    all.push(("p", second.first().momentum(q, v).unwrap().to_vec()));
    all.push(("M^-1", second.first().inverse_mass_matrix(q).unwrap().as_slice().to_vec()));
    all.push(("a", lagrangian.first().forward_dynamics(q, v, u).unwrap().to_vec()));
    all.push(("tau", lagrangian.first().inverse_dynamics(q, v, u).unwrap().to_vec()));
    all.push(("a_z", flat(lagrangian.first().linearise_forward_dynamics(q, v, u).unwrap().matrix())));
    all.push((
        "y'a_zz",
        lagrangian.contract_forward_dynamics(q, v, u, &y[n..]).unwrap().to_matrix().as_slice().to_vec(),
    ));
    all
}

/// The first three quantities only, as number types nest.
fn fewer_quantities<S: Scalar>(robot: &Robot, [q, v, p, u, y]: [&[S]; 5]) -> Quantities<S> {
    let flat = |block: Block<'_, S>| block.iter_rows().flatten().copied().collect::<Vec<_>>();
    let mut second = HamiltonianSecondOrder::<S>::new(robot);
    let mut lagrangian = lagrangian::Lagrangian::<S>::new(robot);
    vec![
        ("F", second.first().evaluate(q, p, u).unwrap().to_vec()),
        ("y'F_xx", flat(second.contract(q, p, u, y).unwrap().matrix())),
        ("a", lagrangian.forward_dynamics(q, v, u).unwrap().to_vec()),
    ]
}

/// Poses where joints are straight, folded or at a right angle, and some without meaning.
fn pose(case: &Case, robot: &Robot, k: usize) -> Vec<f64> {
    if !robot.free_joints().is_empty() {
        return turned(case, robot, k);
    }
    let change = |i: usize, q: f64| match k % 6 {
        0 => q,
        1 => 0.0,
        2 => {
            if i.is_multiple_of(2) {
                FRAC_PI_2
            } else {
                -FRAC_PI_2
            }
        }
        3 => {
            if i.is_multiple_of(2) {
                PI
            } else {
                0.0
            }
        }
        4 => 3.0 * q - 0.1 * i as f64,
        _ => -q + 40.0 * PI,
    };
    case.q.iter().enumerate().map(|(i, &q)| change(i, q)).collect()
}

/// Poses with floating and spherical joints: that of the case, none of them turned, and others.
fn turned(case: &Case, robot: &Robot, k: usize) -> Vec<f64> {
    let (space, mut q) = (ConfigurationSpace::new(robot), case.q.clone());
    if k == 1 {
        return space.neutral();
    }
    let step: Vec<f64> = case.u.iter().map(|u| u * k as f64).collect();
    space.integrate(&case.q, &step, &mut q).unwrap();
    q
}

/// A state for every lane; where M is singular, the pose of the case.
fn states(case: &Case, robot: &Robot, count: usize) -> Vec<State> {
    let state = |k: usize| {
        let regular = |q: &Vec<f64>| (0.0..1e9).contains(&condition(robot, q));
        let q = Some(pose(case, robot, k)).filter(regular).unwrap_or_else(|| case.q.clone());
        let factor = 1.0 - 0.3 * k as f64;
        let scaled = |x: &[f64]| x.iter().map(|x| x * factor).collect::<Vec<_>>();
        let v = if k == 5 { vec![0.0; case.v.len()] } else { scaled(&case.v) };
        let p = Hamiltonian::<f64>::new(robot).momentum(&q, &v).unwrap().to_vec();
        State([q, v, p, scaled(&case.u), scaled(&case.y)])
    };
    (0..count).map(state).collect()
}

/// Argument `which` of all states, one lane a state.
fn packed<V: Vector>(states: &[State], which: usize) -> Vec<Lanes<V>> {
    let lane = |i: usize| states.iter().map(|state| state.0[which][i]).collect::<Vec<_>>();
    (0..states[0].0[which].len()).map(|i| Lanes::from_lanes(&lane(i))).collect()
}

/// Part `of_lanes` of every quantity: lane k of those of all states against the numbers of state k `alone`,
/// by twice the bounds of these, from numbers that are `rounded`.
///
/// A number of another type may take another way through a tree: what is zero along one is a difference of
/// products with M^-1 along the other. They are of the size of the results, as in `rounding::Bounds`.
fn compare<L>(
    robot: &Robot,
    states: &[State],
    lanes: &Quantities<L>,
    of_lanes: impl Fn(&L, usize) -> f64,
    alone: &[Quantities<f64>],
    rounded: &[Quantities<Count>],
) {
    for (k, (alone, rounded)) in alone.iter().zip(rounded).enumerate() {
        let relative = of_inverse(robot, &states[k].0[0]) + of_far_bodies(robot, &states[k].0[0]);
        for (((name, lanes), (_, expected)), (_, rounded)) in lanes.iter().zip(alone).zip(rounded) {
            let found: Vec<f64> = lanes.iter().map(|entry| of_lanes(entry, k)).collect();
            let cancelling = relative * largest(expected).max(1.0);
            let (difference, allowed) =
                (largest(&apart(&found, expected)), 2.0 * bound(rounded) + cancelling);
            assert!(difference <= allowed, "{name}, lane {k}: {difference:e}, {allowed:e} allowed");
        }
    }
}

/// What sums of inertias about the origin of the world round, which one of both ways takes: u of m d^2 of all
/// bodies at the distance d of the farthest one, in parts of the least eigenvalue of M.
fn of_far_bodies(robot: &Robot, q: &[f64]) -> f64 {
    let mut kinematics = FreeKinematics::<f64>::new(robot);
    kinematics.set_position(q).unwrap();
    let places = (0..robot.frames().len()).map(|k| kinematics.pose(k).unwrap().position);
    let square = places.map(|place| place.iter().map(|x| x * x).sum::<f64>()).fold(0.0, f64::max);
    let mass: f64 = robot.joints().iter().map(|joint| joint.inertia.mass).sum();
    let m = Hamiltonian::<f64>::new(robot).mass_matrix(q).unwrap().as_slice().to_vec();
    let trace: f64 = (0..robot.dof()).map(|i| m[i * (robot.dof() + 1)]).sum();
    let least = trace / (robot.dof() as f64 * condition(robot, q));
    terms(3 * robot.dof() + 1, &[mass * square / least])
}

fn lanes_are_states<V: Vector>(case: &Case, robot: &Robot) {
    let states = states(case, robot, V::LANES);
    let packed: [_; 5] = std::array::from_fn(|which| packed::<V>(&states, which));
    let lanes = quantities(robot, packed.each_ref().map(Vec::as_slice));
    let alone: Vec<_> = states.iter().map(|state| at::<f64>(robot, state)).collect();
    let rounded: Vec<_> = states.iter().map(|state| at::<Count>(robot, state)).collect();
    compare(robot, &states, &lanes, |entry: &Lanes<V>, k| entry.lane(k), &alone, &rounded);
}

/// All that is computed at one state.
fn at<S: Scalar>(robot: &Robot, state: &State) -> Quantities<S> {
    let arguments = state.0.each_ref().map(|argument| lift::<S>(argument));
    quantities(robot, arguments.each_ref().map(Vec::as_slice))
}

/// Derivatives along one direction, which differs from lane to lane.
fn derivatives_are_those_of_states<V: Vector>(case: &Case) {
    let robot = case.robot();
    let states = states(case, &robot, V::LANES);
    let direction = |which: usize, i: usize, k: usize| (1.3 * (which + 2 * i + 3 * k) as f64).sin();
    let seeds = |which: usize| -> Vec<Lanes<V>> {
        let lane = |i: usize| (0..V::LANES).map(|k| direction(which, i, k)).collect::<Vec<_>>();
        (0..states[0].0[which].len()).map(|i| Lanes::from_lanes(&lane(i))).collect()
    };
    let pairs = |which: usize| packed::<V>(&states, which).into_iter().zip(seeds(which));
    let tangents: [Vec<_>; 5] =
        std::array::from_fn(|which| pairs(which).map(|(x, d)| Tangent::new(x, d)).collect());
    let duals: [Vec<_>; 5] =
        std::array::from_fn(|which| pairs(which).map(|(x, d)| Dual::new(x, d)).collect());
    let tangents = fewer_quantities(&robot, tangents.each_ref().map(Vec::as_slice));
    let duals = fewer_quantities(&robot, duals.each_ref().map(Vec::as_slice));
    let (alone, rounded) =
        (along::<f64>(&robot, &states, &direction), along::<Count>(&robot, &states, &direction));
    fn parts<S: Scalar>(all: &[Quantities<Tangent<S>>], part: fn(&Tangent<S>) -> S) -> Vec<Quantities<S>> {
        let of = |all: &Quantities<Tangent<S>>| {
            all.iter().map(|(name, entries)| (*name, entries.iter().map(part).collect())).collect()
        };
        all.iter().map(of).collect()
    }
    let (values, slopes) = (parts(&alone, |entry| entry.re), parts(&alone, |entry| entry.eps));
    let (of_values, of_slopes) = (parts(&rounded, |entry| entry.re), parts(&rounded, |entry| entry.eps));
    compare(&robot, &states, &tangents, |entry: &Tangent<Lanes<V>>, k| entry.re.lane(k), &values, &of_values);
    compare(
        &robot,
        &states,
        &tangents,
        |entry: &Tangent<Lanes<V>>, k| entry.eps.lane(k),
        &slopes,
        &of_slopes,
    );
    compare(&robot, &states, &duals, |entry: &Dual<Lanes<V>>, k| entry.re.lane(k), &values, &of_values);
    compare(&robot, &states, &duals, |entry: &Dual<Lanes<V>>, k| entry.eps.lane(k), &slopes, &of_slopes);
}

/// The first quantities at every state, with their derivatives along its direction.
fn along<S: Scalar>(
    robot: &Robot,
    states: &[State],
    direction: &dyn Fn(usize, usize, usize) -> f64,
) -> Vec<Quantities<Tangent<S>>> {
    let at = |(k, state): (usize, &State)| {
        let lift = |which: usize| -> Vec<_> {
            let values = state.0[which].iter().enumerate();
            values.map(|(i, &x)| Tangent::new(S::from_f64(x), S::from_f64(direction(which, i, k)))).collect()
        };
        let arguments: [Vec<Tangent<S>>; 5] = std::array::from_fn(lift);
        fewer_quantities(robot, arguments.each_ref().map(Vec::as_slice))
    };
    states.iter().enumerate().map(at).collect()
}

/// Cases whose own pose is regular enough for the tolerance to mean something.
fn cases() -> impl Strategy<Value = Case> {
    all_cases(7).prop_filter("M is regular", |case| (0.0..1e9).contains(&condition(&case.robot(), &case.q)))
}

properties! {
    16;

    #[test]
    fn four_lanes_are_four_states_with_free_joints(case in free_cases(3)) {
        lanes_are_states::<wide::f64x4>(&case, &case.robot());
    }
}

properties! {
    48;

    #[test]
    fn four_lanes_are_four_states(case in cases()) {
        lanes_are_states::<wide::f64x4>(&case, &case.robot());
    }

    #[test]
    fn eight_lanes_are_eight_states(case in cases()) {
        lanes_are_states::<wide::f64x8>(&case, &case.robot());
    }

    #[test]
    fn four_lanes_under_wrenches_are_four_states(case in cases()) {
        lanes_are_states::<wide::f64x4>(&case, &pulled(&case.robot(), 1.5));
    }

    #[test]
    fn derivatives_in_four_lanes_are_those_of_four_states(case in cases()) {
        derivatives_are_those_of_states::<wide::f64x4>(&case);
    }

    #[test]
    fn derivatives_in_eight_lanes_are_those_of_eight_states(case in cases()) {
        derivatives_are_those_of_states::<wide::f64x8>(&case);
    }
}
