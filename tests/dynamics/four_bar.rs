//! An extremal of the four-bar linkage in three coordinates with two constraints, by multiple shooting with
//! exact second derivatives.
//!
//! Least `∫ u^2 / 2 dt` of the torque u of the crank, which turns from 1 rad to 2.4 rad in a second, from
//! rest to rest. In (q, p) every p + J'kappa is the same motion, so that conditions at the end are
//!
//! ```text
//! Z'(q - q_T) = 0, Z'p = 0 with Z = null(J);    J y_p = 0, J y_q = 0
//! ```
//!
//! The last two fix what acts on nothing. Costs, conditions that hold by themselves along the motion, and p
//! at the end are compared with those of an independent program (CasADi, collocation).

use costate::constraints::{ConstrainedHamiltonianSecondOrder, Constraints};
use costate::lagrangian::Lagrangian;
use costate::robot::Robot;
use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector3};

const NODES: usize = 10;
const STEPS: usize = 40;

type State = SVector<f64, 12>;
type Square = SMatrix<f64, 12, 12>;

struct FourBar {
    second: ConstrainedHamiltonianSecondOrder<f64>,
    rows: Constraints<f64>,
}

impl FourBar {
    fn new() -> Self {
        let robot = Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/four_bar.toml")).unwrap();
        Self { second: ConstrainedHamiltonianSecondOrder::new(&robot), rows: Constraints::new(&robot) }
    }

    /// The linkage with this crank angle, near another position.
    fn closed(&mut self, crank: f64, near: &[f64]) -> Vec<f64> {
        let mut q = vec![crank, near[1], near[2]];
        self.second.first().close(&mut q, &[true, false, false]).unwrap();
        q
    }

    /// J by columns, and the direction that it allows, with a unit rate of the crank.
    fn allowed(&mut self, q: &[f64]) -> (DMatrix<f64>, Vector3<f64>) {
        self.rows.set_position(q).unwrap();
        let j = self.rows.jacobian().view().to_nalgebra();
        let row = |i: usize| Vector3::new(j[(i, 0)], j[(i, 1)], j[(i, 2)]);
        let along = row(0).cross(&row(1));
        (j.clone(), along / along[0])
    }

    /// z' for z = (q, p, y_q, y_p) with u = y_p of the crank, and its Jacobian.
    fn rate(&mut self, z: &State) -> (State, Square) {
        let z = z.as_slice();
        let u = [z[9], 0.0, 0.0];
        let all = self.second.contract(&z[..3], &z[3..6], &u, &z[6..]).unwrap();
        let f_x = all.linearisation().matrix().to_nalgebra();
        let y_f_xx = all.matrix().to_nalgebra();
        let (mut rate, mut jacobian) = (State::zeros(), Square::zeros());
        rate.rows_mut(0, 6).copy_from_slice(all.linearisation().f());
        let y = DVector::from_column_slice(&z[6..]);
        rate.rows_mut(6, 6).copy_from(&(-f_x.transpose() * y));
        jacobian.view_mut((0, 0), (6, 6)).copy_from(&f_x);
        jacobian[(3, 9)] += 1.0;
        jacobian.view_mut((6, 0), (6, 6)).copy_from(&-y_f_xx);
        jacobian.view_mut((6, 6), (6, 6)).copy_from(&-f_x.transpose());
        (rate, jacobian)
    }

    /// Steps of order four over one interval: the end, its derivative by the start, and the cost.
    fn shoot(&mut self, start: &State) -> (State, Square, f64) {
        let dt = 1.0 / (NODES * STEPS) as f64;
        let (mut z, mut s, mut cost) = (*start, Square::identity(), 0.0);
        for _ in 0..STEPS {
            let (mut sum, mut sum_s) = (State::zeros(), Square::zeros());
            let (mut at, mut at_s) = (z, s);
            for (weight, next) in [(1.0, 0.5), (2.0, 0.5), (2.0, 1.0), (1.0, 0.0)] {
                let (rate, jacobian) = self.rate(&at);
                let rate_s = jacobian * at_s;
                cost += weight * dt / 12.0 * at[9] * at[9];
                sum += rate * weight;
                sum_s += rate_s * weight;
                (at, at_s) = (z + rate * (next * dt), s + rate_s * (next * dt));
            }
            z += sum * (dt / 6.0);
            s += sum_s * (dt / 6.0);
        }
        (z, s, cost)
    }

    /// A smooth motion of the crank, with the torque that virtual work asks for.
    fn guess(&mut self, from: &[f64]) -> Vec<State> {
        let robot = Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/four_bar.toml")).unwrap();
        let mut open = Lagrangian::<f64>::new(&robot.without_constraints());
        let mut near = from.to_vec();
        let nodes = (0..=NODES).map(|k| k as f64 / NODES as f64);
        nodes
            .map(|t| {
                let crank = 1.0 + 1.4 * t * t * (3.0 - 2.0 * t);
                let (rate, bend) = (8.4 * t * (1.0 - t), 8.4 * (1.0 - 2.0 * t));
                let q = self.closed(crank, &near);
                near.clone_from(&q);
                let (_, along) = self.allowed(&q);
                let h = 1e-5;
                let moved = self.closed(crank + h, &q);
                let slope = (self.allowed(&moved).1 - along) / h;
                let v = along * rate;
                let a = along * bend + slope * (rate * rate);
                let torque = open.inverse_dynamics(&q, v.as_slice(), a.as_slice()).unwrap();
                let u = along.dot(&Vector3::from_column_slice(torque));
                let p = self.second.first().momentum(&q, v.as_slice()).unwrap().to_vec();
                let mut z = State::zeros();
                z.rows_mut(0, 3).copy_from_slice(&q);
                z.rows_mut(3, 3).copy_from_slice(&p);
                z[9] = u;
                z
            })
            .collect()
    }
}

/// Residuals of all conditions and their Jacobian.
fn conditions(
    bar: &mut FourBar,
    nodes: &[State],
    [from, to]: [&[f64]; 2],
) -> (DVector<f64>, DMatrix<f64>, f64) {
    let size = 12 * (NODES + 1);
    let (mut residual, mut jacobian, mut cost) = (DVector::zeros(size), DMatrix::zeros(size, size), 0.0);
    for (k, node) in nodes.iter().take(NODES).enumerate() {
        let (end, slope, part) = bar.shoot(node);
        cost += part;
        residual.rows_mut(12 * k, 12).copy_from(&(end - nodes[k + 1]));
        jacobian.view_mut((12 * k, 12 * k), (12, 12)).copy_from(&slope);
        for i in 0..12 {
            jacobian[(12 * k + i, 12 * (k + 1) + i)] = -1.0;
        }
    }
    let (start, last) = (12 * NODES, &nodes[NODES]);
    for i in 0..6 {
        residual[start + i] = nodes[0][i] - if i < 3 { from[i] } else { 0.0 };
        jacobian[(start + i, i)] = 1.0;
    }
    // At the end, with J and its null space at the target.
    let (j, along) = bar.allowed(to);
    let mut row = start + 6;
    let mut condition = |first: usize, weights: &[f64], target: f64| {
        residual[row] = (0..3).map(|i| weights[i] * last[first + i]).sum::<f64>() - target;
        (0..3).for_each(|i| jacobian[(row, start + first + i)] = weights[i]);
        row += 1;
    };
    condition(0, &[1.0, 0.0, 0.0], to[0]);
    condition(3, along.as_slice(), 0.0);
    for part in [9, 6] {
        (0..2).for_each(|i| condition(part, &[j[(i, 0)], j[(i, 1)], j[(i, 2)]], 0.0));
    }
    (residual, jacobian, cost)
}

#[test]
fn the_extremal_in_redundant_coordinates_is_that_of_an_independent_program() {
    let mut bar = FourBar::new();
    let from = bar.closed(1.0, &[1.0, -0.6, -2.0]);
    for (found, expected) in from.iter().zip([1.0, -0.591_737_92, -2.058_615_39]) {
        assert!((found - expected).abs() < 1e-8, "{from:?}");
    }
    let mut nodes = bar.guess(&from);
    let to: Vec<f64> = nodes[NODES].rows(0, 3).iter().copied().collect();
    let (mut residual, mut jacobian, mut cost) = conditions(&mut bar, &nodes, [&from, &to]);
    for _ in 0..40 {
        if residual.amax() < 1e-10 {
            break;
        }
        let step = jacobian.lu().solve(&residual).unwrap();
        let (mut length, before) = (1.0, residual.norm());
        loop {
            let trial: Vec<State> =
                nodes.iter().enumerate().map(|(k, z)| z - step.fixed_rows::<12>(12 * k) * length).collect();
            (residual, jacobian, cost) = conditions(&mut bar, &trial, [&from, &to]);
            if residual.norm() < before || length < 1e-3 {
                nodes = trial;
                break;
            }
            length *= 0.5;
        }
    }
    assert!(residual.amax() < 1e-9, "{}", residual.amax());
    assert!((cost - 21.878_342_8).abs() < 1e-7, "{cost:.9}");
    // What holds by itself: the loop, and J y_p = 0.
    for node in &nodes {
        let q: Vec<f64> = node.rows(0, 3).iter().copied().collect();
        let (j, _) = bar.allowed(&q);
        assert!(bar.rows.values().iter().all(|g| g.abs() < 1e-7), "{:?}", bar.rows.values());
        let free = j * DVector::from_column_slice(&node.as_slice()[9..]);
        assert!(free.amax() < 2e-7 * node.rows(9, 3).amax(), "{free}");
    }
    // At rest p is what the pivot has given: no motion.
    let end = nodes[NODES].as_slice();
    for (found, expected) in end[3..6].iter().zip([-21.2, -26.3, -6.7]) {
        assert!((found - expected).abs() < 0.05, "{:?}", &end[3..6]);
    }
    let (v, mu) = bar.second.first().velocity(&end[..3], &end[3..6]).unwrap();
    assert!(v.iter().all(|v| v.abs() < 1e-8), "{v:?}");
    let given = DVector::from_column_slice(&end[3..6]);
    let mu = DVector::from_column_slice(mu);
    let (j, _) = bar.allowed(&end[..3]);
    let by_pivot = -(j.transpose() * mu);
    assert!((by_pivot - given).amax() < 1e-8);
}
