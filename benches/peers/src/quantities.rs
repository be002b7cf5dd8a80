//! What is compared: each quantity as one call on a built workspace.

use costate::EvalError;
use costate::hamiltonian::{
    DualPass, Hamiltonian, HamiltonianContraction, HamiltonianLinearisation, HamiltonianSecondOrder,
};
use costate::lagrangian::{
    ForwardDynamicsLinearisation, InverseDynamicsContraction, InverseDynamicsLinearisation, Lagrangian,
    LagrangianContraction, LagrangianSecondOrder,
};
use costate::matrix::{Block, Matrix};
use costate::robot::{Robot, RobotError, Tree};
use std::ffi::CStr;

/// Everything that is allocated.
pub struct Workspaces {
    hamiltonian: Hamiltonian<f64>,
    second: HamiltonianSecondOrder<f64>,
    dual_pass: DualPass<f64>,
    lagrangian: Lagrangian<f64>,
    lagrangian_second: LagrangianSecondOrder<f64>,
}

impl Workspaces {
    /// Those of the robot in a file.
    pub fn open(path: &str) -> Result<Self, RobotError> {
        let tree = Tree::from(&Robot::from_file(path)?);
        Ok(Self {
            hamiltonian: Hamiltonian::from_tree(tree.clone()),
            second: HamiltonianSecondOrder::from_tree(tree.clone()),
            dual_pass: DualPass::from_tree(tree.clone()),
            lagrangian: Lagrangian::from_tree(tree.clone()),
            lagrangian_second: LagrangianSecondOrder::from_tree(tree),
        })
    }

    /// Number of joints, n.
    pub fn len(&self) -> usize {
        self.hamiltonian.dof()
    }
}

/// One state: n numbers each, y 2n.
pub struct State<'a> {
    /// Positions.
    pub q: &'a [f64],
    v: &'a [f64],
    p: &'a [f64],
    u: &'a [f64],
    a: &'a [f64],
    y: &'a [f64],
}

impl<'a> State<'a> {
    /// From q, v, p, u, a, y in one piece.
    pub fn new(numbers: &'a [f64], n: usize) -> Self {
        let part = |k: usize| &numbers[k * n..(k + 1) * n];
        Self { q: part(0), v: part(1), p: part(2), u: part(3), a: part(4), y: &numbers[5 * n..7 * n] }
    }

    /// Costate of velocities, accelerations or torques.
    fn weights(&self, first: bool) -> &'a [f64] {
        let (head, tail) = self.y.split_at(self.q.len());
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
    fn length(n: usize) -> usize;
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
            fn length($n: usize) -> usize {
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

fn put(block: Block<'_, f64>, out: &mut Vec<f64>) {
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
