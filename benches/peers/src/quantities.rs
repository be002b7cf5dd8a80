//! What is compared: each quantity as one call on a built workspace.

use crate::workspaces::{Size, Workspaces};
use costate::EvalError;
use costate::hamiltonian::{HamiltonianContraction, HamiltonianLinearisation};
use costate::lagrangian::{
    ForwardDynamicsLinearisation, InverseDynamicsContraction, InverseDynamicsLinearisation,
    LagrangianContraction,
};
use costate::matrix::{Block, Matrix};
use std::ffi::CStr;

/// One state: n numbers each, q nq, y 2n.
pub struct State<'a> {
    /// Positions.
    pub q: &'a [f64],
    v: &'a [f64],
    /// Momenta, actuation and costate.
    pub p: &'a [f64],
    pub u: &'a [f64],
    a: &'a [f64],
    pub y: &'a [f64],
}

impl<'a> State<'a> {
    /// From q, v, p, u, a, y in one piece.
    pub fn new(numbers: &'a [f64], nq: usize, n: usize) -> Self {
        let (q, rest) = numbers.split_at(nq);
        let part = |k: usize| &rest[k * n..(k + 1) * n];
        Self { q, v: part(0), p: part(1), u: part(2), a: part(3), y: &rest[4 * n..6 * n] }
    }

    /// Costate of velocities, accelerations or torques.
    fn weights(&self, first: bool) -> &'a [f64] {
        let (head, tail) = self.y.split_at(self.v.len());
        if first { head } else { tail }
    }
}

/// One quantity: `NAME` is `what it is:who computes it`, as in peers/peer.h.
pub trait Quantity {
    /// What a call returns, borrowed from the workspaces.
    type Result<'a>;
    /// Name of the quantity and of the way to it.
    const NAME: &'static CStr;
    /// How many numbers [`write`](Self::write) gives.
    fn length(n: Size) -> usize;
    /// The call that is timed.
    fn evaluate<'a>(w: &'a mut Workspaces, x: &State<'_>) -> Result<Self::Result<'a>, EvalError>;
    /// The numbers to compare, row by row.
    fn write(result: Self::Result<'_>, out: &mut Vec<f64>);
}

/// Declares a quantity: name, documentation, what a call returns, how many numbers, the call, and the
/// numbers.
macro_rules! quantity {
    (
        $name:ident, $text:literal, $doc:literal, $result:ty, |$n:ident| $length:expr,
        |$w:ident, $x:ident| $evaluate:expr, |$r:ident, $out:ident| $write:expr
    ) => {
        #[doc = $doc]
        pub struct $name;

        impl Quantity for $name {
            type Result<'a> = $result;
            const NAME: &'static CStr = $text;
            fn length(size: Size) -> usize {
                let $n = size.n;
                $length
            }
            #[inline(always)]
            fn evaluate<'a>($w: &'a mut Workspaces, $x: &State<'_>) -> Result<$result, EvalError> {
                $evaluate
            }
            fn write<'a>($r: $result, $out: &mut Vec<f64>) {
                $write
            }
        }
    };
}

/// The entries row by row.
pub fn put(block: Block<'_, f64>, out: &mut Vec<f64>) {
    block.iter_rows().for_each(|row| out.extend_from_slice(row));
}

quantity!(
    PhaseVelocity,
    c"F:costate",
    "F(q, p).",
    &'a [f64],
    |n| 2 * n,
    |w, x| w.hamiltonian.evaluate(x.q, x.p, x.u),
    |f, out| out.extend_from_slice(f)
);
quantity!(
    Jacobian,
    c"F_x:costate",
    "F and F_x.",
    HamiltonianLinearisation<'a, f64>,
    |n| 4 * n * n,
    |w, x| w.hamiltonian.linearise(x.q, x.p, x.u),
    |linear, out| put(linear.matrix(), out)
);
quantity!(
    RuleHessian,
    c"y_F_xx:costate(rule)",
    "F, F_x and y'F_xx by the 2n+1 rule.",
    HamiltonianContraction<'a, f64>,
    |n| 4 * n * n,
    |w, x| w.second.contract(x.q, x.p, x.u, x.y),
    |all, out| put(all.matrix(), out)
);
quantity!(
    DualPassHessian,
    c"y_F_xx:costate(dual_pass)",
    "F, F_x and y'F_xx by one dual pass through F_x.",
    HamiltonianContraction<'a, f64>,
    |n| 4 * n * n,
    |w, x| w.dual_pass.contract(x.q, x.p, x.u, x.y),
    |all, out| put(all.matrix(), out)
);
quantity!(
    ForwardDynamics,
    c"a:costate",
    "a(q, v, u).",
    &'a [f64],
    |n| n,
    |w, x| w.lagrangian.forward_dynamics(x.q, x.v, x.u),
    |a, out| out.extend_from_slice(a)
);
quantity!(
    ForwardJacobian,
    c"a_z:costate",
    "a and its Jacobian in z = (q, v, u).",
    ForwardDynamicsLinearisation<'a, f64>,
    |n| 3 * n * n,
    |w, x| w.lagrangian.linearise_forward_dynamics(x.q, x.v, x.u),
    |linear, out| put(linear.matrix(), out)
);
quantity!(
    ForwardHessian,
    c"y_a_zz:costate",
    "a, a_z and the contracted Hessian of a.",
    LagrangianContraction<'a, f64>,
    |n| 9 * n * n,
    |w, x| w.lagrangian_second.contract_forward_dynamics(x.q, x.v, x.u, x.weights(false)),
    |all, out| put(all.to_matrix().view(), out)
);
quantity!(
    MassMatrix,
    c"M:costate",
    "M(q).",
    &'a Matrix<f64>,
    |n| n * n,
    |w, x| w.hamiltonian.mass_matrix(x.q),
    |m, out| put(m.view(), out)
);
quantity!(
    InverseMassMatrix,
    c"Minv:costate",
    "The inverse of M(q).",
    &'a Matrix<f64>,
    |n| n * n,
    |w, x| w.hamiltonian.inverse_mass_matrix(x.q),
    |m, out| put(m.view(), out)
);
quantity!(
    InverseDynamics,
    c"tau:costate",
    "tau(q, v, a).",
    &'a [f64],
    |n| n,
    |w, x| w.lagrangian.inverse_dynamics(x.q, x.v, x.a),
    |tau, out| out.extend_from_slice(tau)
);
quantity!(
    InverseJacobian,
    c"tau_z:costate",
    "tau and its Jacobian in (q, v, a).",
    InverseDynamicsLinearisation<'a, f64>,
    |n| 3 * n * n,
    |w, x| w.lagrangian.linearise_inverse_dynamics(x.q, x.v, x.a),
    |linear, out| for i in 0..linear.tau.len() {
        out.extend_from_slice(linear.tau_q.row(i));
        out.extend_from_slice(linear.tau_v.row(i));
        out.extend_from_slice(linear.tau_a.row(i));
    }
);
quantity!(
    InverseHessian,
    c"w_tau_zz:costate",
    "The Hessian of w.tau in (q, v, a), w constant.",
    InverseDynamicsContraction<'a, f64>,
    |n| 9 * n * n,
    |w, x| w.lagrangian_second.contract_inverse_dynamics(x.q, x.v, x.a, x.weights(true)),
    |all, out| put(all.zz().view(), out)
);
