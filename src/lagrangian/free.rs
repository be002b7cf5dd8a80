//! Inverse and forward dynamics of robots with floating and spherical joints, and their Jacobians.
//!
//! q has [`Tree::nq`] entries, all others n; derivatives by q are those in the left-trivialised tangent
//! space, as Pinocchio's. In the chart of a joint (`configuration/chart.rs`) twist and wrench are `nu = A
//! v`, `tau_c = A' tau`, and `nu' = A a + A_q[v] v`, so that
//!
//! $$ \tau = A^{-T} \tau\_c(q, v, a), \qquad v = A^{-1} \nu, \qquad a = A^{-1} (\dot \nu - A\_q[v] v) $$
//!
//! The derivatives of tau_c come from kernels one and two of the chain of joints; those of A are constants,
//! and touch rows and columns of the joint only.

use crate::configuration::{ChartFrame, MOST};
use crate::matrix::{Matrix, add_scaled, filled};
use crate::robot::Tree;
use crate::scalar::Scalar;

/// What the dynamics need besides that of the chains of joints.
#[derive(Clone, Debug)]
pub(super) struct Free<S: Scalar> {
    pub frames: Vec<ChartFrame<S>>,
    /// v and a of the chart, in the axes of the frames and in those of the chain.
    pub a: Vec<S>,
    pub v_chain: Vec<S>,
    pub a_chain: Vec<S>,
    pub mass_matrix: Matrix<S>,
    pub inverse: Matrix<S>,
}

/// Derivatives of v and a of the chart by those of the twist.
struct Changes<S> {
    /// `dv = dnu + v_q dxi`.
    v_q: [[S; MOST]; MOST],
    /// `da = dnu' + a_q dxi + a_v dv`.
    a_q: [[S; MOST]; MOST],
    a_v: [[S; MOST]; MOST],
}

impl<S: Scalar> Free<S> {
    /// `None` for a robot without such joints.
    pub fn where_any(tree: &Tree) -> Option<Box<Self>> {
        let (n, zero) = (tree.dof(), S::zero());
        let frames: Vec<_> = tree.free().iter().map(ChartFrame::new).collect();
        (!frames.is_empty()).then(|| {
            Box::new(Self {
                frames,
                a: filled(zero, n),
                v_chain: filled(zero, n),
                a_chain: filled(zero, n),
                mass_matrix: Matrix::zeros(n, n),
                inverse: Matrix::zeros(n, n),
            })
        })
    }

    pub fn set_state(&mut self, q: &[S], v: &[S]) {
        self.v_chain.copy_from_slice(v);
        for frame in &mut self.frames {
            frame.set_configuration(q);
            frame.outward(&mut self.v_chain);
        }
    }

    /// `a = nu' - A_q[v] v` from the acceleration nu'.
    pub fn set_acceleration(&mut self, v: &[S], acceleration: &[S]) {
        self.a.copy_from_slice(acceleration);
        for frame in &self.frames {
            let (at, _) = frame.place();
            add_bias(frame, v, S::from_f64(-1.0), &mut self.a[at..]);
        }
        self.a_chain.copy_from_slice(&self.a);
        self.frames.iter().for_each(|frame| frame.outward(&mut self.a_chain));
    }

    /// `nu' = a + A_q[v] v` in place, from the acceleration of the chain.
    pub fn finish_acceleration(&self, v: &[S], a: &mut [S]) {
        for frame in &self.frames {
            frame.inward(a);
            let (at, _) = frame.place();
            add_bias(frame, v, S::one(), &mut a[at..]);
        }
    }

    /// Derivatives of tau in the tangent space from those in the chain, at v; tau is in the axes of the
    /// frames.
    pub fn finish_jacobian(&self, v: &[S], tau: &[S], [tau_q, tau_v]: [&mut Matrix<S>; 2]) {
        let n = v.len();
        for frame in &self.frames {
            frame.turn_block(tau_q, [0, 0], n);
            frame.turn_block(tau_v, [0, 0], n);
        }
        for frame in &self.frames {
            let (at, m) = frame.place();
            let (force, Changes { v_q, a_q, a_v }) = (frame.entries(tau), changes(frame, v, &self.a));
            let mut whole = a_q;
            for (whole, factors) in whole.iter_mut().zip(&a_v) {
                factors.iter().zip(&v_q).for_each(|(&factor, v_q)| add_scaled(whole, factor, v_q));
            }
            for i in 0..n {
                let by_a: [S; MOST] = frame.entries(self.mass_matrix.row(i));
                let by_v: [S; MOST] = frame.entries(tau_v.row(i));
                let (in_q, in_v) = (&mut tau_q.row_mut(i)[at..at + m], &mut tau_v.row_mut(i)[at..at + m]);
                by_v.iter().zip(&v_q).for_each(|(&factor, v_q)| add_scaled(in_q, factor, v_q));
                by_a.iter().zip(&whole).for_each(|(&factor, whole)| add_scaled(in_q, factor, whole));
                by_a.iter().zip(&a_v).for_each(|(&factor, a_v)| add_scaled(in_v, factor, a_v));
            }
            for e in &frame.chart.first {
                tau_q[(at + e.column, at + e.by[0])] -= force[e.row].times(e.value);
            }
        }
    }
}

/// Adds `factor A_q[v] v` to the entries of a joint.
fn add_bias<S: Scalar>(frame: &ChartFrame<S>, v: &[S], factor: S, own: &mut [S]) {
    let v = frame.entries(v);
    for e in &frame.chart.first {
        own[e.row] += factor * (v[e.by[0]] * v[e.column]).times(e.value);
    }
}

fn changes<S: Scalar>(frame: &ChartFrame<S>, v: &[S], a: &[S]) -> Changes<S> {
    let (v, a) = (frame.entries(v), frame.entries(a));
    let zero = [[S::zero(); MOST]; MOST];
    let mut changes = Changes { v_q: zero, a_q: zero, a_v: zero };
    for e in &frame.chart.first {
        let [i] = e.by;
        changes.v_q[e.row][i] -= v[e.column].times(e.value);
        changes.a_q[e.row][i] -= a[e.column].times(e.value);
        changes.a_v[e.row][i] -= v[e.column].times(e.value);
        changes.a_v[e.row][e.column] -= v[i].times(e.value);
    }
    for e in &frame.chart.second {
        let [i, j] = e.by;
        changes.a_q[e.row][j] -= (v[i] * v[e.column]).times(e.value);
    }
    changes
}
