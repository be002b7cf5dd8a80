"""Functions of JAX with exact first and second derivatives.

They are calls of XLA into the compiled module, on CPUs: they can be jitted, mapped by ``vmap`` and differentiated twice,
and a batch runs on vectors and threads as in NumPy. Numbers must be float64 (``jax_enable_x64``).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

try:
    import jax.extend  # noqa: F401
    import jax.numpy as jnp
except ImportError as _error:  # pragma: no cover
    raise ImportError("costate.jax needs JAX: pip install jax") from _error

from .._costate import Dynamics, Step, _xla_calls
from .._errors import argument_error
from .._wanted import dynamics_of
from ._free import of_step, of_tangent
from ._rules import Checked, differentiable
from ._targets import numbers_of, target

if TYPE_CHECKING:
    from .._costate import Robot, _Scheme
    from ._rules import _Names, _Order

__all__ = ["Model", "calls"]


def calls(function: Any) -> dict[str, int]:
    """At how many states XLA has evaluated a function of this module and its derivatives, in this process.

    Compiling evaluates nothing. Functions of one `Dynamics` share their counts: those of ``aba`` in (q, v) are the Jacobians
    and Hessians of ``f``. Results that JAX needs no more, and those of the same arguments, are not computed twice.

    Parameters
    ----------
    function : callable
        ``f``, ``aba`` or ``rnea`` of a `Model`, or what ``step`` returned.

    Returns
    -------
    dict
        ``"value"``, ``"jacobian"``, and ``"hessian"``: contractions, each with one costate.

    Examples
    --------
    >>> import costate, costate.jax, jax, jax.numpy as jnp
    >>> jax.config.update("jax_enable_x64", True)
    >>> robot = costate.Robot.builder("cart").prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> model, zero = costate.jax.Model(costate.Dynamics(robot)), jnp.zeros((5, 1))
    >>> _ = model.f(zero, zero, zero).block_until_ready()
    >>> costate.jax.calls(model.f)
    {'value': 5, 'jacobian': 0, 'hessian': 0}
    """
    model = getattr(function, "__self__", None)
    if isinstance(model, Model):
        function = getattr(model, f"_{function.__name__}", None)
    if not hasattr(function, "numbers"):
        raise argument_error("function", "function is none of costate.jax: give model.f, model.aba, model.rnea or a step")
    return {name: _xla_calls(number) for name, number in function.numbers.items()}


class Model:
    """The dynamics of a robot, and time steps of it, as functions of JAX.

    ``f``, ``aba``, ``rnea`` and what ``step`` returns take three arrays (..., n) with any leading batch axes, which are
    broadcast. With floating and spherical joints q has ``robot.nq`` entries and is differentiated by all of them: the
    functions do not change with the length of a quaternion, which must be 1 where they are evaluated. All first and
    second derivatives are exact: ``jax.grad``, ``jacfwd``, ``jacrev``, ``hessian``, and any of them over any other. A
    state that is not finite or has a singular mass matrix raises an error of XLA with costate's message, or gives
    not-a-number where the dynamics have ``on_error="nan"``.

    Parameters
    ----------
    dynamics : Dynamics or Robot
        The dynamics, with their coordinates and settings, or a robot for (q, v). They live as long as the process, and
        so does what JAX compiles for each model: make one, and use it again.
    order : {"any", "reverse"}
        Which derivatives are cheap. With ``"any"``, the second derivatives of all results are computed, one contraction
        for each. With ``"reverse"``, only ``grad``, ``vjp`` and ``jacrev`` of the functions and ``jacfwd`` of these are
        allowed, for which a single contraction does: the way of ``jacfwd(grad(cost))``.

    Raises
    ------
    ArgumentError
        For what is neither dynamics nor a robot; where an argument is not float64, or has another shape; where JAX computes
        in float32.

    Examples
    --------
    >>> import costate, costate.jax, jax, jax.numpy as jnp
    >>> jax.config.update("jax_enable_x64", True)
    >>> robot = costate.Robot.builder("pendulum").revolute("hinge", axis=[0, 1, 0], mass=1, com=[0, 0, -1]).build()
    >>> model = costate.jax.Model(costate.Dynamics(robot))
    >>> a = lambda q: model.aba(q, jnp.zeros(1), jnp.zeros(1))[0]
    >>> jax.jit(jax.grad(a))(jnp.zeros(1)).round(2).tolist()
    [-9.81]
    """

    def __init__(self, dynamics: Dynamics | Robot, order: _Order = "any") -> None:
        dynamics = dynamics_of(dynamics, free=True)
        if order not in ("any", "reverse"):
            raise argument_error("order", f"unknown order '{order}'; give 'any' or 'reverse'")
        n = dynamics.n
        self.dynamics = dynamics
        self.order = order
        self._f = _method(dynamics, ("f", "jacobian", "hessian"), 2 * n, order)
        verbs = "rnea", "rnea_jacobian", "rnea_hessian"
        self._rnea = _method(dynamics, verbs, n, order, ("q", "v", "a"))
        # Forward dynamics are the second half of f in velocities.
        at = dynamics if dynamics.coordinates == "qv" else Dynamics(
            dynamics.robot, "qv", on_error=dynamics.on_error, threads=dynamics.threads
        )
        jacobian, hessian = target(at, "jacobian", (2 * n, 3 * n)), target(at, "hessian", (3 * n, 3 * n))

        def contracted(q: Any, v: Any, tau: Any, y: Any) -> Any:
            return hessian(q, v, tau, jnp.concatenate([jnp.zeros_like(y), y], -1))

        value = target(at, "aba", (n,))
        of = value, lambda *z: jacobian(*z)[..., n:, :], contracted
        self._aba = _function(dynamics.robot, of, n, order, numbers_of(value, jacobian, hessian))

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return (self.dynamics, self.order) == (other.dynamics, other.order)

    def __hash__(self) -> int:
        return hash((self.dynamics, self.order))

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), (self.dynamics, self.order))

    def f(self, q: Any, v: Any, tau: Any) -> Any:
        """The state equation dx/dt, as `Dynamics.f`.

        Parameters
        ----------
        q : array_like (..., nq)
            Positions (rad, m).
        v : array_like (..., n)
            Velocities (rad/s, m/s); with the coordinates ``"qp"`` the momenta p.
        tau : array_like (..., n)
            Torques and forces (N m, N).

        Returns
        -------
        jax.Array (..., 2n)
            Equation (9) or (17), (19).

        Raises
        ------
        ArgumentError
            For another type or shape.
        """
        return self._f(q, v, tau)

    def aba(self, q: Any, v: Any, tau: Any) -> Any:
        """Forward dynamics, as `Dynamics.aba`.

        Parameters
        ----------
        q : array_like (..., nq)
            Positions (rad, m).
        v : array_like (..., n)
            Velocities (rad/s, m/s), in either coordinates.
        tau : array_like (..., n)
            Torques and forces (N m, N).

        Returns
        -------
        jax.Array (..., n)
            Accelerations (rad/s^2, m/s^2).

        Raises
        ------
        ArgumentError
            For another type or shape.
        """
        return self._aba(q, v, tau)

    def rnea(self, q: Any, v: Any, a: Any) -> Any:
        """Inverse dynamics, as `Dynamics.rnea`.

        Parameters
        ----------
        q : array_like (..., nq)
            Positions (rad, m).
        v : array_like (..., n)
            Velocities (rad/s, m/s), in either coordinates.
        a : array_like (..., n)
            Accelerations (rad/s^2, m/s^2).

        Returns
        -------
        jax.Array (..., n)
            Torques and forces (N m, N).

        Raises
        ------
        ArgumentError
            For another type or shape.
        """
        return self._rnea(q, v, a)

    def step(self, scheme: _Scheme, dt: float) -> Callable[[Any, Any, Any], Any]:
        """One time step, as `Step.f`.

        Parameters
        ----------
        scheme : {"rk4", "midpoint", "verlet", "semi_implicit_euler"}
            As in `Step`.
        dt : float
            Duration (s).

        Returns
        -------
        callable
            A function of (q, v, tau) whose result is the next state (..., nq + n). It can be pickled.

        Raises
        ------
        ArgumentError
            As `Step`.
        """
        return _step(Step(self.dynamics, scheme, dt), self.order)


def _targets(owner: Dynamics | Step, verbs: tuple[str, str, str], m: int, robot: Robot) -> tuple[Any, Any, Any]:
    """Value (m), Jacobian and Hessian; derivatives of the next state of a step are those in its tangent space."""
    n = robot.n
    rows = 2 * n if isinstance(owner, Step) else m
    shapes = ((m,), (rows, 3 * n), (3 * n, 3 * n))
    value, jacobian, hessian = (target(owner, verb, shape) for verb, shape in zip(verbs, shapes, strict=True))
    return value, jacobian, hessian


def _function(
    robot: Robot,
    of: tuple[Any, Any, Any],
    m: int,
    order: _Order,
    numbers: dict[str, int],
    names: _Names = ("q", "v", "tau"),
) -> Checked:
    is_free = bool(robot.free_joints)
    function = of_tangent(robot, of, m, order) if is_free else differentiable(of, robot.n, m, order)
    return Checked(function, names, (robot.nq, robot.n, robot.n), numbers)


def _method(
    dynamics: Dynamics, verbs: tuple[str, str, str], m: int, order: _Order, names: _Names = ("q", "v", "tau")
) -> Checked:
    of = _targets(dynamics, verbs, m, dynamics.robot)
    return _function(dynamics.robot, of, m, order, numbers_of(*of), names)


def _step(step: Step, order: _Order) -> Checked:
    robot = step.dynamics.robot
    of = _targets(step, ("f", "jacobian", "hessian"), robot.nq + robot.n, robot)
    if robot.free_joints:
        lengths, names = (robot.nq, robot.n, robot.n), ("q", "v", "tau")
        function = Checked(of_step(robot, of, order), names, lengths, numbers_of(*of))
    else:
        function = _function(robot, of, 2 * robot.n, order, numbers_of(*of))
    function.made = _step, (step, order)
    return function
