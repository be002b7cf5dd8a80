"""Rules for derivatives: primitives of a value, its Jacobian and its contracted Hessian, and functions made of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

import jax
import jax.numpy as jnp
from jax.extend.core import Primitive
from jax.interpreters import ad, batching, mlir

from .._errors import argument_error

if TYPE_CHECKING:
    _Order = Literal["any", "reverse"]
    _Names = tuple[str, str, str]


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
        # A cast would drop the imaginary parts.
        advice = "real if its imaginary parts are zero" if value.dtype.kind == "c" else "astype(float)"
        raise argument_error(name, f"{name} has the type {value.dtype}, not float64; pass {name}.{advice}")
    if not value.shape or value.shape[-1] != length:
        raise argument_error(name, f"{name} has the shape {list(value.shape)}, not (..., {length})")
    return value


def _no_third(*_: Any) -> Any:
    raise TypeError("costate has first and second derivatives; a third one is asked for")


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


class Checked:
    """A function of three vectors that looks at their types and shapes; ``numbers`` of what counts its calls."""

    def __init__(self, function: Any, names: _Names, lengths: tuple[int, int, int], numbers: dict[str, int]) -> None:
        self._function, self._names, self._lengths, self.numbers = function, names, lengths, numbers
        # What a pickle calls, with its arguments.
        self.made: tuple[Callable[..., Any], tuple[Any, ...]] | None = None

    def __call__(self, *arguments: Any) -> Any:
        names, lengths = self._names, self._lengths
        given = [_checked(*part) for part in zip(names, arguments, lengths, strict=True)]
        try:
            leading = jnp.broadcast_shapes(*(part.shape[:-1] for part in given))
        except ValueError as error:
            raise argument_error(names[0], f"the leading axes of {', '.join(names)} cannot be broadcast: {error}") from None
        return self._function(*(jnp.broadcast_to(part, leading + part.shape[-1:]) for part in given))

    def __reduce__(self) -> tuple[Any, ...]:
        if self.made is None:
            raise TypeError("pickle the costate.jax.Model, or one of its steps")
        return self.made


def differentiable(of: tuple[Any, Any, Any], n: int, m: int, order: _Order, *, base: bool = False) -> Any:
    """A function of three vectors (n) with m results, of its value, Jacobian (m, 3n) and contracted Hessian (3n, 3n).

    With a ``base`` one more vector comes first, by which there are no derivatives.
    """
    value_of, jacobian_of, hessian_of = of
    skipped = int(base)

    hessian = _primitive("hessian", hessian_of, _no_third)

    def jacobian_change(at: Any, along: Any) -> Any:
        # One contraction for each result: all of them in one call.
        leading = jnp.broadcast_shapes(*(part.shape[:-1] for part in at))
        rows = [jnp.broadcast_to(part, leading + part.shape[-1:])[..., None, :] for part in at]
        tensor = hessian(*rows, jnp.broadcast_to(jnp.eye(m), leading + (m, m)))
        return jacobian(*at), jnp.einsum("...ijk,...k->...ij", tensor, jnp.concatenate(along[skipped:], -1))

    jacobian = _primitive("jacobian", jacobian_of, jacobian_change)

    def adjoint_change(at: Any, along: Any) -> Any:
        *z, y = at
        matrix, second = jacobian(*z), hessian(*z, y)
        change = _times(second, jnp.concatenate(along[skipped:-1], -1)) + jnp.einsum("...i,...ij->...j", along[-1], matrix)
        return jnp.einsum("...i,...ij->...j", y, matrix), change

    def adjoint_of(*at: Any) -> Any:
        *z, y = at
        return jnp.einsum("...i,...ij->...j", y, jacobian_of(*z))

    adjoint = _primitive("adjoint", adjoint_of, adjoint_change)

    def value_change(at: Any, along: Any) -> Any:
        return value(*at), _times(jacobian(*at), jnp.concatenate(along[skipped:], -1))

    value = _primitive("value", value_of, value_change)
    if order == "any":
        return value
    function = jax.custom_vjp(value)

    def backward(at: Any, y: Any) -> Any:
        return *(jnp.zeros_like(part) for part in at[:skipped]), *jnp.split(adjoint(*at, y), 3, -1)

    function.defvjp(lambda *at: (value(*at), at), backward)
    return function
