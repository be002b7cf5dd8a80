"""Rules for derivatives: a value, y'J, J d, and the second derivatives H d and d'F_zz e, as functions of tensors.

A value is differentiated to y'J by reverse and to J d by forward mode, and each of these by either mode once more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch


@dataclass(frozen=True)
class Methods:
    """A function of three vectors (n) on NumPy arrays: its value, J and H.

    With a base one more vector comes first, by which there are no derivatives.
    """

    n: int
    value: Callable[..., Any]
    jacobian: Callable[..., Any]
    hessian: Callable[..., Any]
    base: bool = False

    def by_arguments(self, by_z: Any) -> tuple[Any, ...]:
        """What is known of the three vectors, for all arguments."""
        return *[None] * self.base, *by_z.split(self.n, -1)

    def directions(self, along: Any) -> Any:
        """Those of the three vectors."""
        return along[int(self.base) :]


def _array(tensor: Any) -> Any:
    """The numbers of a tensor; those of one state must lie one after the other."""
    tensor = tensor.detach()
    if tensor._is_zerotensor():
        # What forward mode knows to be zero has no memory of its own.
        return np.zeros(tuple(tensor.shape))
    if tensor.shape[-1] > 1 and tensor.stride(-1) != 1:
        tensor = tensor.contiguous()
    return tensor.numpy()


def _arrays(*tensors: Any) -> list[Any]:
    return [_array(tensor) for tensor in tensors]


def _times(matrix: Any, vector: Any) -> Any:
    return torch.from_numpy((matrix @ vector[..., None])[..., 0])


class _Rule(torch.autograd.Function):  # type: ignore[misc,unused-ignore]
    """A function of the vectors z and of directions, all with the same leading axes. d and e are directions of the
    arguments, y is a costate of the value."""

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
    def forward(methods: Methods, *z: Any) -> Any:
        return torch.from_numpy(methods.value(*_arrays(*z)))

    @staticmethod
    def backward(ctx: Any, y: Any) -> Any:
        return None, *ctx.methods.by_arguments(_Adjoint.apply(ctx.methods, *ctx.saved_tensors, y))

    @staticmethod
    def jvp(ctx: Any, _: Any, *along: Any) -> Any:
        # Nothing but such functions here: forward mode over this one knows no others.
        return _Tangent.apply(ctx.methods, *ctx.saved_tensors, *ctx.methods.directions(along))


class _Adjoint(_Rule):
    """y'J."""

    @staticmethod
    def forward(methods: Methods, *of: Any) -> Any:
        *z, y = of
        jacobian = methods.jacobian(*_arrays(*z))
        return torch.from_numpy((_array(y)[..., None, :] @ jacobian)[..., 0, :])

    @staticmethod
    def backward(ctx: Any, d: Any) -> Any:
        *z, y = ctx.saved_tensors
        by_z = ctx.methods.by_arguments(_Product.apply(ctx.methods, *z, y, d))
        parts = d.split(ctx.methods.n, -1)
        return None, *by_z, _Tangent.apply(ctx.methods, *z, *parts) if ctx.needs_input_grad[-1] else None

    @staticmethod
    def jvp(ctx: Any, _: Any, *along: Any) -> Any:
        *z, y = ctx.saved_tensors
        *d, change = along
        product = _Product.apply(ctx.methods, *z, y, torch.cat(ctx.methods.directions(d), -1))
        return product + _Adjoint.apply(ctx.methods, *z, change)


class _Tangent(_Rule):
    """J d, d in its three parts."""

    @staticmethod
    def forward(methods: Methods, *of: Any) -> Any:
        *z, a, b, c = _arrays(*of)
        return _times(methods.jacobian(*z), np.concatenate([a, b, c], -1))

    @staticmethod
    def backward(ctx: Any, y: Any) -> Any:
        methods, (*z, a, b, c) = ctx.methods, ctx.saved_tensors
        by_z = methods.by_arguments(_Product.apply(methods, *z, y, torch.cat([a, b, c], -1)))
        if not any(ctx.needs_input_grad[-3:]):
            return None, *by_z, None, None, None
        return None, *by_z, *_Adjoint.apply(methods, *z, y).split(methods.n, -1)

    @staticmethod
    def jvp(ctx: Any, _: Any, *along: Any) -> Any:
        methods, (*z, a, b, c) = ctx.methods, ctx.saved_tensors
        e, change = torch.cat(methods.directions(along[:-3]), -1), along[-3:]
        return _Bend.apply(methods, *z, torch.cat([a, b, c], -1), e) + _Tangent.apply(methods, *z, *change)


class _Second(_Rule):
    """What has no derivatives."""

    @staticmethod
    def backward(ctx: Any, *_: Any) -> Any:
        raise RuntimeError("costate has first and second derivatives; a third one is asked for")

    @staticmethod
    def jvp(ctx: Any, *_: Any) -> Any:
        raise RuntimeError("costate has first and second derivatives; a third one is asked for")


class Constant(_Rule):
    """The value, as if it did not change."""

    @staticmethod
    def forward(methods: Methods, *z: Any) -> Any:
        return Value.forward(methods, *z)

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        ctx.count, ctx.shape = len(inputs), output.shape

    @staticmethod
    def backward(ctx: Any, y: Any) -> Any:
        return (None,) * ctx.count

    @staticmethod
    def jvp(ctx: Any, *_: Any) -> Any:
        return torch.zeros(ctx.shape, dtype=torch.float64)


class Held(torch.autograd.Function):  # type: ignore[misc,unused-ignore]
    """A tensor as a constant. ``detach`` is one for the innermost of several nested transforms alone."""

    @staticmethod
    def forward(tensor: Any) -> Any:
        return tensor.clone()

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        pass

    @staticmethod
    def backward(ctx: Any, y: Any) -> Any:
        return torch.zeros_like(y)

    @staticmethod
    def jvp(ctx: Any, along: Any) -> Any:
        return torch.zeros_like(along)

    @staticmethod
    def vmap(info: Any, dims: Any, tensor: Any) -> Any:
        return Held.apply(tensor), dims[0]


class _Product(_Second):
    """H d, H the Hessian of y'value."""

    @staticmethod
    def forward(methods: Methods, *of: Any) -> Any:
        *z, y, d = of
        return _times(methods.hessian(*_arrays(*z), np.ascontiguousarray(_array(y))), _array(d))


class _Bend(_Second):
    """d'F_zz e of each entry of the value: one contraction for each, all of them in one call."""

    @staticmethod
    def forward(methods: Methods, *of: Any) -> Any:
        *z, d, e = _arrays(*of)
        entries = methods.value(*z).shape[-1]
        hessians = methods.hessian(*(part[..., None, :] for part in z), np.eye(entries))
        return torch.from_numpy(np.einsum("...j,...ijk,...k->...i", d, hessians, e))
