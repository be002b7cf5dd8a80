"""Calls of XLA into the compiled module."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .._costate import Dynamics, Step, _xla_handler

_TARGET = "costate"
_targets: set[str] = set()


def _register() -> None:
    if _TARGET in _targets:
        return
    handler = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)(_xla_handler())
    capsule: Callable[[Any], Any] = jax.ffi.pycapsule
    jax.ffi.register_ffi_target(_TARGET, capsule(handler), platform="cpu")
    _targets.add(_TARGET)


def target(owner: Dynamics | Step, verb: str, shape: tuple[int, ...]) -> Callable[..., Any]:
    """A method of dynamics or of a step as a function of arrays of JAX; its result at one state has this shape."""
    _register()
    number = np.int64(owner._xla(verb))

    def call(*arguments: Any) -> Any:
        leading = jnp.broadcast_shapes(*(argument.shape[:-1] for argument in arguments))
        whole = [jnp.broadcast_to(argument, leading + argument.shape[-1:]) for argument in arguments]
        struct: Callable[..., Any] = jax.ShapeDtypeStruct
        result = struct(leading + shape, jnp.float64)
        called: Callable[..., Any] = jax.ffi.ffi_call(_TARGET, result, vmap_method="broadcast_all")
        return called(*whole, function=number)

    call.number = int(number)  # type: ignore[attr-defined]
    return call


def numbers_of(*calls: Any) -> dict[str, int]:
    """The numbers of functions of `target`."""
    return dict(zip(("value", "jacobian", "hessian"), (call.number for call in calls), strict=True))
