//! The methods of `Dynamics` that are functions of arrays.

use crate::dynamics::Dynamics;
use crate::kinematics::BodyVerb;
use crate::methods::verbs;
use crate::quantities::Verb;

verbs! {
    impl Dynamics;

    /// The state equation f = dx/dt.
    ///
    /// Equation (9) solved for the accelerations with ``"qv"``, equations (17) and (19) with ``"qp"``.
    f(q: q, v: state, tau: tau) -> one
        "ndarray (..., 2n)\n    (v, a) in rad/s, m/s, rad/s^2, m/s^2; with ``\"qp\"`` (v, dp/dt), in N m, N."
        = call Verb::F;

    /// The Jacobian df/dz of the state equation, z = (q, v, tau).
    ///
    /// Equations (21) to (24) with ``"qp"``; the derivative of equation (9) with ``"qv"``.
    jacobian(q: q, v: state, tau: tau) -> one
        "ndarray (..., 2n, 3n)\n    Rows are entries of f, columns those of z."
        = call Verb::Jacobian;

    /// The contracted Hessian d2(y'f)/dz2 of the state equation, z = (q, v, tau).
    ///
    /// By the 2n + 1 rule with ``"qp"``, by pairs of joints with ``"qv"``: no finite differences.
    hessian(q: q, v: state, tau: tau, y: y) -> one
        "ndarray (..., 3n, 3n)\n    Symmetric."
        = call Verb::Hessian;

    /// f and its Jacobian in one pass.
    linearise(q: q, v: state, tau: tau) -> several
        "f : ndarray (..., 2n)\n    As `f`.\nJ : ndarray (..., 2n, 3n)\n    As `jacobian`."
        = call Verb::Linearise;

    /// f, its Jacobian and the contracted Hessian in one pass.
    contract(q: q, v: state, tau: tau, y: y) -> several
        "f : ndarray (..., 2n)\n    As `f`.\nJ : ndarray (..., 2n, 3n)\n    As `jacobian`.\n\
         H : ndarray (..., 3n, 3n)\n    As `hessian`."
        = call Verb::Contract;

    /// The product y' df/dz of a costate and the Jacobian; with ``"qp"`` without the Jacobian.
    adjoint(q: q, v: state, tau: tau, y: y) -> one
        "ndarray (..., 3n)\n    The derivatives of y'f by q, v and tau."
        = call Verb::Adjoint;

    /// The product d2(y'f)/dz2 d of the contracted Hessian and a direction; with ``"qp"`` without the
    /// Hessian.
    hvp(q: q, v: state, tau: tau, y: y, d: d) -> one
        "ndarray (..., 3n)\n    ``hessian(q, v, tau, y) @ d``."
        = call Verb::Hvp;

    /// Forward dynamics: the accelerations a under tau, M a + C v + g = tau + D, equation (9).
    aba(q: q, v: v, tau: tau) -> one
        "ndarray (..., n)\n    Accelerations (rad/s^2, m/s^2)."
        = call Verb::Aba;

    /// Inverse dynamics: the torques tau for accelerations a, equation (9) solved for tau.
    rnea(q: q, v: v, a: a) -> one
        "ndarray (..., n)\n    Torques and forces (N m, N)."
        = call Verb::Rnea;

    /// The Jacobian of inverse dynamics by (q, v, a).
    rnea_jacobian(q: q, v: v, a: a) -> one
        "ndarray (..., n, 3n)\n    Rows are torques."
        = call Verb::RneaJacobian;

    /// The second derivatives of w'tau of inverse dynamics by (q, v, a), by pairs of joints.
    rnea_hessian(q: q, v: v, a: a, w: w) -> one
        "ndarray (..., 3n, 3n)\n    Symmetric."
        = call Verb::RneaHessian;

    /// The mass matrix M with armature, equation (62).
    crba(q: q) -> one
        "ndarray (..., n, n)\n    Both triangles (kg m^2, kg m, kg)."
        = call Verb::Crba;

    /// Kinetic energy v'M v/2, with that of the armature, and potential energy of gravity and springs.
    energy(q: q, v: v) -> several
        "kinetic : ndarray (...)\n    In J.\npotential : ndarray (...)\n    In J; 0 where all centres of mass \
         are at the height of the origin and springs at rest."
        = call Verb::Energy;

    /// The conjugate momenta p = M v, equation (17).
    momentum(q: q, v: v) -> one
        "ndarray (..., n)\n    In kg m^2/s, kg m/s."
        = of_robot BodyVerb::Momentum;

    /// The velocities v of conjugate momenta: M v = p, equation (17) solved for v.
    velocity(q: q, p: p) -> one
        "ndarray (..., n)\n    In rad/s, m/s."
        = of_robot BodyVerb::Velocity;

    /// The centre of mass of all links that move.
    centre_of_mass(q: q) -> one
        "ndarray (..., 3)\n    In the world (m)."
        = of_robot BodyVerb::CentreOfMass;

    /// Momentum about the centre of mass, and the centroidal momentum matrix A.
    centroidal_momentum(q: q, v: v) -> several
        "h : ndarray (..., 6)\n    A v: angular (kg m^2/s) and linear momentum (kg m/s), in axes of the world.\n\
         A : ndarray (..., 6, n)\n    Armature has no share in it."
        = of_robot BodyVerb::CentroidalMomentum;
}
