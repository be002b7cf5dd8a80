"""Rules for derivatives: a value, y'J, J d, and the second derivatives H d and d'F_zz e, as functions of tensors.

A value is differentiated to y'J by reverse and to J d by forward mode, and each of these by either mode once more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from .._errors import argument_error

if TYPE_CHECKING:
    from .._costate import Step


@dataclass(frozen=True)
class Methods:
    """A function of three vectors (n) on NumPy arrays: its value, J and H."""

    n: int
    value: Callable[..., Any]
    jacobian: Callable[..., Any]
    hessian: Callable[..., Any]


def _array(tensor: Any) -> Any:
    """The numbers of a tensor; those of one state must lie one after the other."""
    tensor = tensor.detach()
    if tensor.shape[-1] > 1 and tensor.stride(-1) != 1:
        tensor = tensor.contiguous()
    return tensor.numpy()


def _arrays(*tensors: Any) -> list[Any]:
    return [_array(tensor) for tensor in tensors]


def _times(matrix: Any, vector: Any) -> Any:
    return torch.from_numpy((matrix @ vector[..., None])[..., 0])


class _Rule(torch.autograd.Function):  # type: ignore[misc,unused-ignore]
    """A function of three vectors and of directions, all with the same leading axes. d and e are directions of the
    arguments (3n), y is a costate of the value."""

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        ctx.methods = inputs[0]
        ctx.save_for_backward(*inputs[1:])
        ctx.save_for_forward(*inputs[1:])

    @classmethod
    def vmap(cls, info: Any, dims: Any, methods: Methods, *tensors: Any) -> Any:
        """With the mapped axis in front, of tensors that have none as well."""
        front = (
            tensor.expand(info.batch_size, *tensor.shape) if dim is None else tensor.movedim(dim, 0)
            for dim, tensor in zip(dims[1:], tensors, strict=True)
        )
        return cls.apply(methods, *front), 0


class Value(_Rule):
    """The value."""

    @staticmethod
    def forward(methods: Methods, a: Any, b: Any, c: Any) -> Any:
        return torch.from_numpy(methods.value(*_arrays(a, b, c)))

    @staticmethod
    def backward(ctx: Any, y: Any) -> Any:
        return None, *_Adjoint.apply(ctx.methods, *ctx.saved_tensors, y).split(ctx.methods.n, -1)

    @staticmethod
    def jvp(ctx: Any, _: Any, *along: Any) -> Any:
        return _Tangent.apply(ctx.methods, *ctx.saved_tensors, torch.cat(along, -1))


class _Adjoint(_Rule):
    """y'J."""

    @staticmethod
    def forward(methods: Methods, a: Any, b: Any, c: Any, y: Any) -> Any:
        jacobian = methods.jacobian(*_arrays(a, b, c))
        return torch.from_numpy((_array(y)[..., None, :] @ jacobian)[..., 0, :])

    @staticmethod
    def backward(ctx: Any, d: Any) -> Any:
        *z, y = ctx.saved_tensors
        by_z = _Product.apply(ctx.methods, *z, y, d).split(ctx.methods.n, -1)
        return None, *by_z, _Tangent.apply(ctx.methods, *z, d) if ctx.needs_input_grad[4] else None

    @staticmethod
    def jvp(ctx: Any, _: Any, *along: Any) -> Any:
        *z, y = ctx.saved_tensors
        *d, change = along
        return _Product.apply(ctx.methods, *z, y, torch.cat(d, -1)) + _Adjoint.apply(ctx.methods, *z, change)


class _Tangent(_Rule):
    """J d."""

    @staticmethod
    def forward(methods: Methods, a: Any, b: Any, c: Any, d: Any) -> Any:
        return _times(methods.jacobian(*_arrays(a, b, c)), _array(d))

    @staticmethod
    def backward(ctx: Any, y: Any) -> Any:
        *z, d = ctx.saved_tensors
        by_z = _Product.apply(ctx.methods, *z, y, d).split(ctx.methods.n, -1)
        return None, *by_z, _Adjoint.apply(ctx.methods, *z, y) if ctx.needs_input_grad[4] else None

    @staticmethod
    def jvp(ctx: Any, _: Any, *along: Any) -> Any:
        *z, d = ctx.saved_tensors
        *e, change = along
        return _Bend.apply(ctx.methods, *z, d, torch.cat(e, -1)) + _Tangent.apply(ctx.methods, *z, change)


class _Second(_Rule):
    """What has no derivatives."""

    @staticmethod
    def backward(ctx: Any, *_: Any) -> Any:
        raise RuntimeError("costate has first and second derivatives; a third one is asked for")

    @staticmethod
    def jvp(ctx: Any, *_: Any) -> Any:
        raise RuntimeError("costate has first and second derivatives; a third one is asked for")


class _Product(_Second):
    """H d, H the Hessian of y'value."""

    @staticmethod
    def forward(methods: Methods, a: Any, b: Any, c: Any, y: Any, d: Any) -> Any:
        return _times(methods.hessian(*_arrays(a, b, c), np.ascontiguousarray(_array(y))), _array(d))


class _Bend(_Second):
    """d'F_zz e of each entry of the value: one contraction for each, all of them in one call."""

    @staticmethod
    def forward(methods: Methods, a: Any, b: Any, c: Any, d: Any, e: Any) -> Any:
        z, (d, e) = _arrays(a, b, c), _arrays(d, e)
        entries = methods.value(*z).shape[-1]
        hessians = methods.hessian(*(part[..., None, :] for part in z), np.eye(entries))
        return torch.from_numpy(np.einsum("...j,...ijk,...k->...i", d, hessians, e))


def _checked(name: str, tensor: Any, length: int) -> Any:
    if not isinstance(tensor, torch.Tensor):
        raise argument_error(name, f"{name} is not a tensor; pass torch.tensor({name}, dtype=torch.float64)")
    if tensor.device.type != "cpu":
        raise argument_error(name, f"{name} is on {tensor.device}, and costate computes on the CPU; pass {name}.cpu()")
    if tensor.dtype != torch.float64:
        raise argument_error(name, f"{name} has the type {tensor.dtype}, not torch.float64; pass {name}.double()")
    if not tensor.shape or tensor.shape[-1] != length:
        raise argument_error(name, f"{name} has the shape {list(tensor.shape)}, not (..., {length})")
    return tensor


class Checked:
    """A function of three tensors that looks at their types and shapes."""

    def __init__(self, methods: Methods, names: tuple[str, str, str] = ("q", "v", "tau")) -> None:
        self._methods, self._names = methods, names

    def __call__(self, *arguments: Any) -> Any:
        n, names = self._methods.n, self._names
        given = [_checked(name, tensor, n) for name, tensor in zip(names, arguments, strict=True)]
        try:
            shapes = (tensor.shape[:-1] for tensor in given)
            leading = torch.broadcast_shapes(*shapes)  # type: ignore[no-untyped-call,unused-ignore]
        except RuntimeError as error:
            message = f"the leading axes of {', '.join(names)} cannot be broadcast: {error}"
            raise argument_error(names[0], message) from None
        return Value.apply(self._methods, *(tensor.expand(*leading, n) for tensor in given))


class StepFunction(Checked):
    """A time step; pickles are those of its `Step`."""

    def __init__(self, step: Step) -> None:
        super().__init__(Methods(step.dynamics.n, step.f, step.jacobian, step.hessian))
        self._step = step

    def __reduce__(self) -> tuple[Any, ...]:
        return (StepFunction, (self._step,))
