//! The methods of `ConstrainedDynamics` that are functions of arrays.

use crate::constrained::ConstrainedDynamics;
use crate::constraints::Verb;
use crate::methods::verbs;

verbs! {
    impl ConstrainedDynamics;

    /// The state equation f = dx/dt = F + (0, tau).
    f(q: q, p: p, tau: tau) -> one
        "ndarray (..., 2n)\n    v in rad/s, m/s, with J v = 0, then dp/dt in N m, N."
        = call Verb::F;

    /// The Jacobian df/dz, z = (q, p, tau).
    jacobian(q: q, p: p, tau: tau) -> one
        "ndarray (..., 2n, 3n)\n    Rows are entries of f, columns those of z."
        = call Verb::Jacobian;

    /// The contracted Hessian d2(y'f)/dz2, z = (q, p, tau), by the 2n + 1 rule.
    hessian(q: q, p: p, tau: tau, y: y) -> one
        "ndarray (..., 3n, 3n)\n    Symmetric; rows and columns of tau are zero."
        = call Verb::Hessian;

    /// f and its Jacobian in one pass.
    linearise(q: q, p: p, tau: tau) -> several
        "f : ndarray (..., 2n)\n    As `f`.\nJ : ndarray (..., 2n, 3n)\n    As `jacobian`."
        = call Verb::Linearise;

    /// f, its Jacobian and the contracted Hessian in one pass.
    contract(q: q, p: p, tau: tau, y: y) -> several
        "f : ndarray (..., 2n)\n    As `f`.\nJ : ndarray (..., 2n, 3n)\n    As `jacobian`.\n\
         H : ndarray (..., 3n, 3n)\n    As `hessian`."
        = call Verb::Contract;

    /// The product y' df/dz of a costate and the Jacobian, without the Jacobian.
    adjoint(q: q, p: p, tau: tau, y: y) -> one
        "ndarray (..., 3n)\n    The derivatives of y'f by q, p and tau."
        = call Verb::Adjoint;

    /// The product d2(y'f)/dz2 d of the contracted Hessian and a direction, without the Hessian.
    hvp(q: q, p: p, tau: tau, y: y, d: along) -> one
        "ndarray (..., 3n)\n    ``hessian(q, p, tau, y) @ d``."
        = call Verb::Hvp;

    /// Accelerations of M a - J'lambda = tau + ..., with the derivative of J v zero.
    acceleration(q: q, p: p, tau: tau) -> one
        "ndarray (..., n)\n    In rad/s^2, m/s^2."
        = call Verb::Acceleration;

    /// The rates lambda of the multipliers: the constraints act on the joints as J'lambda.
    ///
    /// A row of a position is a force (N) on the link of the first frame, at its origin, along an axis of the
    /// second frame; a row of a distance a force (N) that pushes the points apart; a row of an orientation,
    /// where the loop is closed, a moment (N m) about an axis of the second frame; that of a coupling the
    /// force at a joint of factor 1.
    multipliers(q: q, p: p, tau: tau) -> one
        "ndarray (..., k)\n    In N, N m, for each of ``row_names``; 0 for a row that depends on those before it."
        = call Verb::Multipliers;

    /// Forces and moments of the constraints on the links of their first frames.
    ///
    /// They act at the origin of the first frame of each constraint and have axes of its second frame. The
    /// link of the second frame gets the opposite.
    forces(q: q, p: p, tau: tau) -> several
        "force : ndarray (..., c, 3)\n    In N, for each of ``robot.constraint_names``; not-a-number for a \
         coupling, see `multipliers`.\nmoment : ndarray (..., c, 3)\n    In N m, likewise."
        = call Verb::Forces;

    /// The Jacobian of `multipliers` in z = (q, p, tau).
    multiplier_jacobian(q: q, p: p, tau: tau) -> one
        "ndarray (..., k, 3n)\n    Rows are multipliers, columns entries of z."
        = call Verb::MultiplierJacobian;

    /// The contracted Hessian d2(c.lambda)/dz2 of `multipliers`, z = (q, p, tau).
    multiplier_hessian(q: q, p: p, tau: tau, c: rows) -> one
        "ndarray (..., 3n, 3n)\n    Symmetric."
        = call Verb::MultiplierHessian;

    /// An inelastic impact: the constraints set in at (q, p), p = M v with any v, without a rebound.
    ///
    /// q stays, M v+ = p + J'mu and J v+ = 0. The momentum p+ = M v+ is also that after a release: before
    /// constraints are let go, p becomes p+.
    impact(q: q, p: p) -> several
        "v : ndarray (..., n)\n    v+ in rad/s, m/s.\np : ndarray (..., n)\n    p+ in kg m^2/s, kg m/s.\n\
         impulse : ndarray (..., k)\n    mu in N s, N m s, for each of ``row_names``.\nloss : ndarray (...)\n    \
         The energy that is lost, in J, never negative."
        = call Verb::Impact;

    /// The Jacobians of `impact` in x = (q, p).
    impact_jacobian(q: q, p: p) -> several
        "v_x : ndarray (..., n, 2n)\n    Of v+.\np_x : ndarray (..., n, 2n)\n    Of p+.\n\
         impulse_x : ndarray (..., k, 2n)\n    Of the impulses."
        = call Verb::ImpactJacobian;

    /// The contracted Hessian d2(y.p+)/dx2 of the momenta after `impact`, x = (q, p).
    impact_hessian(q: q, p: p, y: momenta) -> one
        "ndarray (..., 2n, 2n)\n    Symmetric."
        = call Verb::ImpactHessian;

    /// The momenta p = M v of a motion whose multipliers are zero, J v = 0.
    momentum(q: q, v: rate) -> one
        "ndarray (..., n)\n    In kg m^2/s, kg m/s."
        = call Verb::Momentum;

    /// The velocities of momenta, and the multipliers.
    ///
    /// For p = M v, with any v, these are the velocities after the constraints have set in, without a
    /// rebound, and their impulses.
    velocity(q: q, p: p) -> several
        "v : ndarray (..., n)\n    In rad/s, m/s, with J v = 0.\nmu : ndarray (..., k)\n    In N s, N m s."
        = call Verb::Velocity;

    /// Kinetic and potential energy; their sum is the Hamiltonian.
    energy(q: q, p: p) -> several
        "kinetic : ndarray (...)\n    In J.\npotential : ndarray (...)\n    In J; 0 where all centres of mass \
         are at the height of the origin and springs at rest."
        = call Verb::Energy;

    /// What the constraints hold: g(q), zero where the loops are closed.
    constraint(q: q) -> one
        "ndarray (..., k)\n    In m, rad, for each of ``row_names``."
        = call Verb::Constraint;

    /// The Jacobian J = dg/dq.
    constraint_jacobian(q: q) -> one
        "ndarray (..., k, n)\n    Rows are entries of g."
        = call Verb::ConstraintJacobian;

    /// The rate J v of g: zero for velocities that the constraints allow.
    constraint_rate(q: q, v: rate) -> one
        "ndarray (..., k)\n    In m/s, rad/s."
        = call Verb::ConstraintRate;

    /// g(q) - g(q_0), constant along exact motions: what the steps of an integrator have let drift.
    drift(q: q, q_0: start) -> one
        "ndarray (..., k)\n    In m, rad."
        = call Verb::Drift;

    /// Which rows count: a redundant one depends on those before it and is left out, its multiplier zero.
    counted(q: q) -> one
        "ndarray (..., k)\n    1 or 0; their sum is the rank of J."
        = call Verb::Counted;

    /// Removes the drift of a state: q moves to g(q) = g(q_0), p becomes M v.
    ///
    /// v is the velocity of (q, p) without what the constraints do not allow at the new position.
    project(q: q, p: p, q_0: start) -> several
        "q : ndarray (..., n)\n    In rad, m.\np : ndarray (..., n)\n    In kg m^2/s, kg m/s; its multipliers \
         are zero."
        = call Verb::Project;
}
