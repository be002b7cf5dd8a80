//! The costate at a landing: the tip of the two-link arm hits a wall without rebound and slides along it.
//!
//! The state x = (q, p) is continuous; F changes from that of the open arm to that of the constrained one,
//! whose velocities are those after the impact. Where the instant t_1 is free, g(q(t_1)) = 0, y_p is
//! continuous and y_q jumps by a multiple of g_q, which the continuity of H* gives:
//!
//! ```text
//! y(t_1-) = y(t_1+) + nu (g_q, 0),    H*(t_1-) = H*(t_1+)
//! ```
//!
//! Where t_1 is given and the tip is caught wherever it is, y is continuous.

mod gradient;
mod optimum;

use costate::constraints::{ConstrainedHamiltonian, Constraints};
use costate::hamiltonian::Hamiltonian;
use costate::robot::{ConstraintRow, ConstraintSpec, Placement, Robot};
use nalgebra::{SMatrix, SVector, Vector2, Vector4};

/// Steps of order four before and after the landing.
const STEPS: usize = 200;
const END: f64 = 1.0;

/// (q, p, y_q, y_p).
type State = SVector<f64, 8>;

fn two_link() -> Robot {
    Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/two_link.toml")).unwrap()
}

/// The tip is on the wall at x = 1.2 m.
fn at_wall() -> Robot {
    let place = |x: f64| Placement::from_xyz_rpy([x, 0.0, 0.0], [0.0; 3]);
    let wall = ConstraintSpec::rows("wall", "elbow", "world", &[ConstraintRow::X]);
    two_link().with_constraint(wall.placed(place(1.0)).to_placed(place(1.2))).unwrap()
}

#[derive(Clone, Copy, PartialEq)]
enum Phase {
    InAir,
    OnWall,
}

/// Torques by the time and the costate.
type Control = fn(f64, &State) -> Vector2<f64>;

struct Arm {
    free: Hamiltonian<f64>,
    held: ConstrainedHamiltonian<f64>,
    rows: Constraints<f64>,
    control: Control,
}

impl Arm {
    fn new(control: Control) -> Self {
        let (free, robot) = (Hamiltonian::new(&two_link()), at_wall());
        Self { free, held: ConstrainedHamiltonian::new(&robot), rows: Constraints::new(&robot), control }
    }

    /// x by q and v.
    fn start(&mut self, q: [f64; 2], v: [f64; 2]) -> Vector4<f64> {
        let p = self.free.momentum(&q, &v).unwrap();
        Vector4::new(q[0], q[1], p[0], p[1])
    }

    /// F and F_x.
    fn flow(&mut self, phase: Phase, z: &State, u: &Vector2<f64>) -> (Vector4<f64>, SMatrix<f64, 4, 4>) {
        let (q, p, u) = (&z.as_slice()[..2], &z.as_slice()[2..4], u.as_slice());
        let (f, f_x) = match phase {
            Phase::InAir => {
                let all = self.free.linearise(q, p, u).unwrap();
                (all.f().to_vec(), all.matrix().to_nalgebra())
            }
            Phase::OnWall => {
                let all = self.held.linearise(q, p, u).unwrap();
                (all.f().to_vec(), all.matrix().to_nalgebra())
            }
        };
        (Vector4::from_column_slice(&f), SMatrix::from_fn(|i, j| f_x[(i, j)]))
    }

    /// z', the running cost and H*.
    fn rate(&mut self, phase: Phase, t: f64, z: &State) -> (State, f64, f64) {
        let u = (self.control)(t, z);
        let (f, f_x) = self.flow(phase, z, &u);
        let y = z.fixed_rows::<4>(4).into_owned();
        let mut rate = State::zeros();
        rate.fixed_rows_mut::<4>(0).copy_from(&f);
        rate.fixed_rows_mut::<4>(4).copy_from(&-(f_x.transpose() * y));
        let cost = 0.5 * u.norm_squared();
        (rate, cost, cost + y.dot(&f))
    }

    /// From one instant to another, also backward; with the cost.
    fn move_on(&mut self, phase: Phase, [from, to]: [f64; 2], start: &State) -> (State, f64) {
        let dt = (to - from) / STEPS as f64;
        let (mut z, mut cost) = (*start, 0.0);
        for k in 0..STEPS {
            let t = from + k as f64 * dt;
            let (a, cost_a, _) = self.rate(phase, t, &z);
            let (b, cost_b, _) = self.rate(phase, t + 0.5 * dt, &(z + a * (0.5 * dt)));
            let (c, cost_c, _) = self.rate(phase, t + 0.5 * dt, &(z + b * (0.5 * dt)));
            let (d, cost_d, _) = self.rate(phase, t + dt, &(z + c * dt));
            z += (a + (b + c) * 2.0 + d) * (dt / 6.0);
            cost += dt / 6.0 * (cost_a + 2.0 * (cost_b + cost_c) + cost_d);
        }
        (z, cost)
    }

    /// g and g_q.
    fn gap(&mut self, z: &State) -> (f64, Vector2<f64>) {
        self.rows.set_position(&z.as_slice()[..2]).unwrap();
        let j = self.rows.jacobian();
        (self.rows.values()[0], Vector2::new(j[(0, 0)], j[(0, 1)]))
    }

    /// When the arm lands that starts so, and its state then: Newton's method for g(q(t)) = 0.
    fn landing(&mut self, start: &State) -> (f64, State) {
        let mut t = 0.3;
        for _ in 0..50 {
            let (z, _) = self.move_on(Phase::InAir, [0.0, t], start);
            let (gap, slope) = self.gap(&z);
            let (rate, _, _) = self.rate(Phase::InAir, t, &z);
            let step = gap / slope.dot(&rate.fixed_rows::<2>(0));
            if step.abs() < 1e-14 {
                return (t, z);
            }
            t -= step;
        }
        panic!("the arm does not land");
    }
}

fn with_costate(x: &Vector4<f64>, y: &Vector4<f64>) -> State {
    State::from_fn(|i, _| if i < 4 { x[i] } else { y[i - 4] })
}

fn costate(z: &State) -> Vector4<f64> {
    z.fixed_rows::<4>(4).into_owned()
}
