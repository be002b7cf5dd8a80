"""Functions of JAX with exact first and second derivatives.

They are calls of XLA into the compiled module, on CPUs: they can be jitted, mapped by ``vmap`` and differentiated twice,
and a batch runs on vectors and threads as in NumPy. Numbers must be float64 (``jax_enable_x64``).
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

try:
    import jax
    import jax.numpy as jnp
    from jax.extend.core import Primitive
    from jax.interpreters import ad, batching, mlir
except ImportError as _error:  # pragma: no cover
    raise ImportError("costate.jax needs JAX: pip install jax") from _error
import numpy as np

from ._costate import Dynamics, Step, _xla_calls, _xla_handler
from ._errors import argument_error

if TYPE_CHECKING:
    from ._costate import _Scheme

    _Order = Literal["any", "reverse"]

__all__ = ["Model", "calls"]

_TARGET = "costate"
_Function = Callable[[Any, Any, Any], Any]
_targets: set[str] = set()


def _register() -> None:
    if _TARGET in _targets:
        return
    handler = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)(_xla_handler())
    capsule: Callable[[Any], Any] = jax.ffi.pycapsule
    jax.ffi.register_ffi_target(_TARGET, capsule(handler), platform="cpu")
    _targets.add(_TARGET)


def _checked(name: str, value: Any, length: int) -> Any:
    """An array of doubles (..., length)."""
    config: Any = jax.config
    if not config.jax_enable_x64:
        raise argument_error(
            name, 'JAX computes in float32 here, and costate in float64: call jax.config.update("jax_enable_x64", True)'
        )
    if not hasattr(value, "dtype"):
        value = jnp.asarray(value, dtype=float)
    if value.dtype != jnp.float64:
        raise argument_error(name, f"{name} has the type {value.dtype}, not float64; pass {name}.astype(float)")
    if not value.shape or value.shape[-1] != length:
        raise argument_error(name, f"{name} has the shape {list(value.shape)}, not (..., {length})")
    return value


def _no_third(*_: Any) -> Any:
    raise TypeError("costate has first and second derivatives; a third one is asked for")


def _call(owner: Dynamics | Step, verb: str, shape: tuple[int, ...]) -> Callable[..., Any]:
    """A method of dynamics or of a step as a function of arrays of JAX; its result at one state has this shape."""
    _register()
    number = np.int64(owner._xla(verb))

    def call(*arguments: Any) -> Any:
        leading = jnp.broadcast_shapes(*(argument.shape[:-1] for argument in arguments))
        whole = [jnp.broadcast_to(argument, leading + argument.shape[-1:]) for argument in arguments]
        struct: Callable[..., Any] = jax.ShapeDtypeStruct
        result = struct(leading + shape, jnp.float64)
        target: Callable[..., Any] = jax.ffi.ffi_call(_TARGET, result, vmap_method="broadcast_all")
        return target(*whole, function=number)

    call.number = int(number)  # type: ignore[attr-defined]
    return call


def _numbers(*calls: Any) -> dict[str, int]:
    """The numbers of functions of `_call`."""
    return dict(zip(("value", "jacobian", "hessian"), (call.number for call in calls), strict=True))


def _primitive(name: str, function: Callable[..., Any], jvp: Callable[[Any, Any], tuple[Any, Any]]) -> Callable[..., Any]:
    """A function of arrays (..., k) as a primitive with this rule for forward derivatives.

    ``jax.custom_jvp`` would do outside of loops alone: the derivative of ``lax.scan`` forgets its rule.
    """
    primitive: Any = Primitive(f"costate_{name}")
    primitive.def_impl(jax.jit(function))

    def shape_of(*arguments: Any) -> Any:
        struct: Callable[..., Any] = jax.ShapeDtypeStruct
        result = jax.eval_shape(function, *(struct(a.shape, a.dtype) for a in arguments))
        return arguments[0].update(shape=result.shape, dtype=result.dtype, weak_type=False)

    def mapped(arguments: Any, axes: Any) -> tuple[Any, int]:
        pairs = zip(arguments, axes, strict=True)
        front = (a[None] if axis is None else jnp.moveaxis(a, axis, 0) for a, axis in pairs)
        return primitive.bind(*front), 0

    primitive.def_abstract_eval(shape_of)
    mlir.register_lowering(primitive, mlir.lower_fun(function, multiple_results=False))
    batching.primitive_batchers[primitive] = mapped
    zeros: Callable[..., Any] = ad.instantiate_zeros
    ad.primitive_jvps[primitive] = lambda at, along: jvp(at, [zeros(part) for part in along])
    call: Callable[..., Any] = primitive.bind
    return call


def _times(matrix: Any, vector: Any) -> Any:
    return jnp.einsum("...ij,...j->...i", matrix, vector)


def _differentiable(
    names: tuple[str, str, str], n: int, of: tuple[Any, Any, Any], m: int, order: _Order, numbers: dict[str, int]
) -> _Function:
    """A function of three vectors (n) with m results, of its value, Jacobian (m, 3n) and contracted Hessian (3n, 3n)."""
    value_of, jacobian_of, hessian_of = of

    hessian = _primitive("hessian", hessian_of, _no_third)

    def jacobian_change(at: Any, along: Any) -> Any:
        # One contraction for each result: all of them in one call.
        leading = jnp.broadcast_shapes(*(part.shape[:-1] for part in at))
        rows = [jnp.broadcast_to(part, leading + (n,))[..., None, :] for part in at]
        tensor = hessian(*rows, jnp.broadcast_to(jnp.eye(m), leading + (m, m)))
        return jacobian(*at), jnp.einsum("...ijk,...k->...ij", tensor, jnp.concatenate(along, -1))

    jacobian = _primitive("jacobian", jacobian_of, jacobian_change)

    def adjoint_change(at: Any, along: Any) -> Any:
        *z, y = at
        matrix, second = jacobian(*z), hessian(*z, y)
        change = _times(second, jnp.concatenate(along[:3], -1)) + jnp.einsum("...i,...ij->...j", along[3], matrix)
        return jnp.einsum("...i,...ij->...j", y, matrix), change

    def adjoint_of(a: Any, b: Any, c: Any, y: Any) -> Any:
        return jnp.einsum("...i,...ij->...j", y, jacobian_of(a, b, c))

    adjoint = _primitive("adjoint", adjoint_of, adjoint_change)

    def value_change(at: Any, along: Any) -> Any:
        return value(*at), _times(jacobian(*at), jnp.concatenate(along, -1))

    value = _primitive("value", value_of, value_change)
    function: Any = value
    if order == "reverse":
        function = jax.custom_vjp(value)
        function.defvjp(
            lambda a, b, c: (value(a, b, c), (a, b, c)), lambda at, y: tuple(jnp.split(adjoint(*at, y), 3, -1))
        )

    def checked(*arguments: Any) -> Any:
        given = [_checked(name, value, n) for name, value in zip(names, arguments, strict=True)]
        try:
            leading = jnp.broadcast_shapes(*(part.shape[:-1] for part in given))
        except ValueError as error:
            raise argument_error(names[0], f"the leading axes of {', '.join(names)} cannot be broadcast: {error}") from None
        return function(*(jnp.broadcast_to(part, leading + (n,)) for part in given))

    checked.numbers = numbers  # type: ignore[attr-defined]
    return checked


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
    broadcast. All first and second derivatives are exact: ``jax.grad``, ``jacfwd``, ``jacrev``, ``hessian``, and any of
    them over any other. A state that is not finite or has a singular mass matrix raises an error of XLA with costate's
    message, or gives not-a-number where the dynamics have ``on_error="nan"``.

    Parameters
    ----------
    dynamics : Dynamics
        The dynamics, with their coordinates and settings. They live as long as the process.
    order : {"any", "reverse"}
        Which derivatives are cheap. With ``"any"``, the second derivatives of all results are computed, one contraction
        for each. With ``"reverse"``, only ``grad``, ``vjp`` and ``jacrev`` of the functions and ``jacfwd`` of these are
        allowed, for which a single contraction does: the way of ``jacfwd(grad(cost))``.

    Raises
    ------
    ArgumentError
        Where an argument is not float64, or has another shape; where JAX computes in float32.

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

    def __init__(self, dynamics: Dynamics, order: _Order = "any") -> None:
        if order not in ("any", "reverse"):
            raise argument_error("order", f"unknown order '{order}'; give 'any' or 'reverse'")
        n = dynamics.n
        self.dynamics = dynamics
        self.order = order
        self._f = self._function(dynamics, ("f", "jacobian", "hessian"), 2 * n)
        self._rnea = self._function(dynamics, ("rnea", "rnea_jacobian", "rnea_hessian"), n, ("q", "v", "a"))
        # Forward dynamics are the second half of f in velocities.
        at = dynamics if dynamics.coordinates == "qv" else Dynamics(
            dynamics.robot, "qv", on_error=dynamics.on_error, threads=dynamics.threads
        )
        jacobian, hessian = _call(at, "jacobian", (2 * n, 3 * n)), _call(at, "hessian", (3 * n, 3 * n))

        def contracted(q: Any, v: Any, tau: Any, y: Any) -> Any:
            return hessian(q, v, tau, jnp.concatenate([jnp.zeros_like(y), y], -1))

        value = _call(at, "aba", (n,))
        of = value, lambda *z: jacobian(*z)[..., n:, :], contracted
        self._aba = _differentiable(("q", "v", "tau"), n, of, n, order, _numbers(value, jacobian, hessian))

    def _function(
        self,
        owner: Dynamics | Step,
        verbs: tuple[str, str, str],
        m: int,
        names: tuple[str, str, str] = ("q", "v", "tau"),
    ) -> _Function:
        n = self.dynamics.n
        shapes = ((m,), (m, 3 * n), (3 * n, 3 * n))
        value, jacobian, hessian = (_call(owner, verb, shape) for verb, shape in zip(verbs, shapes, strict=True))
        return _differentiable(names, n, (value, jacobian, hessian), m, self.order, _numbers(value, jacobian, hessian))

    def f(self, q: Any, v: Any, tau: Any) -> Any:
        """The state equation dx/dt, as `Dynamics.f`.

        Parameters
        ----------
        q : array_like (..., n)
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
        q : array_like (..., n)
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
        q : array_like (..., n)
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

    def step(self, scheme: _Scheme, dt: float) -> _Function:
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
            A function of (q, v, tau) whose result is the next state (..., 2n).

        Raises
        ------
        ArgumentError
            As `Step`.
        """
        return self._function(Step(self.dynamics, scheme, dt), ("f", "jacobian", "hessian"), 2 * self.dynamics.n)
