"""Rules for derivatives: a value, y'J, J d, and the second derivatives H d and d'F_zz e, as functions of tensors.

A value is differentiated to y'J by reverse and to J d by forward mode, and each of these by either mode once more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from .._charts import Charts
from .._errors import argument_error

if TYPE_CHECKING:
    from .._costate import Robot, Step


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


class _Constant(_Rule):
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


class _Held(torch.autograd.Function):  # type: ignore[misc,unused-ignore]
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
        return _Held.apply(tensor), dims[0]


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

    def __init__(self, methods: Methods, robot: Robot, names: tuple[str, str, str] = ("q", "v", "tau")) -> None:
        self._names, self._lengths = names, (robot.nq, robot.n, robot.n)
        self._function = of_tangent(methods, robot) if robot.free_joints else _plain(methods)

    def __call__(self, *arguments: Any) -> Any:
        names = self._names
        given = [_checked(*part) for part in zip(names, arguments, self._lengths, strict=True)]
        try:
            shapes = (tensor.shape[:-1] for tensor in given)
            leading = torch.broadcast_shapes(*shapes)  # type: ignore[no-untyped-call,unused-ignore]
        except RuntimeError as error:
            message = f"the leading axes of {', '.join(names)} cannot be broadcast: {error}"
            raise argument_error(names[0], message) from None
        return self._function(*(tensor.expand(*leading, tensor.shape[-1]) for tensor in given))


def _plain(methods: Methods) -> Callable[..., Any]:
    return lambda *z: Value.apply(methods, *z)


def of_tangent(methods: Methods, robot: Robot) -> Callable[..., Any]:
    """The function whose Jacobian and Hessian are those by d in q (+) d, by the entries of q."""
    charts = Charts(robot)
    # Each is evaluated at the base, where d is zero.
    value, jacobian, hessian = (_without_d(of) for of in (methods.value, methods.jacobian, methods.hessian))
    at_base = Methods(methods.n, value, jacobian, hessian, True)

    def call(q: Any, v: Any, tau: Any) -> Any:
        base = _Held.apply(q)
        return Value.apply(at_base, base, charts.tangent(base, q, torch.stack), v, tau)

    return call


def _without_d(function: Callable[..., Any]) -> Callable[..., Any]:
    return lambda base, _, *rest: function(base, *rest)


class StepFunction(Checked):
    """A time step; pickles are those of its `Step`."""

    def __init__(self, step: Step) -> None:
        robot = step.dynamics.robot
        super().__init__(Methods(robot.n, step.f, step.jacobian, step.hessian), robot)
        self._step = step
        if robot.free_joints:
            self._function = _of_step(step)

    def __reduce__(self) -> tuple[Any, ...]:
        return (StepFunction, (self._step,))


def _of_step(step: Step) -> Callable[..., Any]:
    """The next state, of which the step has the derivatives of the difference from it."""
    robot = step.dynamics.robot
    charts, n, nq = Charts(robot), robot.n, robot.nq

    def difference(q: Any, v: Any, tau: Any) -> Any:
        return np.zeros((*q.shape[:-1], 2 * n))

    change = of_tangent(Methods(n, difference, step.jacobian, step.hessian), robot)
    here = Methods(n, step.f, step.jacobian, step.hessian)

    def call(q: Any, v: Any, tau: Any) -> Any:
        state = _Constant.apply(here, q, v, tau)
        d = change(q, v, tau)
        moved = charts.moved(state[..., :nq], d[..., :n], torch.stack)
        return torch.cat([moved, state[..., nq:] + d[..., n:]], -1)

    return call
