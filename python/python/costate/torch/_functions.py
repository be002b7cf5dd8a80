"""Functions of tensors that look at their arguments; those of robots with quaternions, by the entries of q."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from .._charts import Charts
from .._errors import argument_error
from ._rules import Constant, Held, Methods, Value

if TYPE_CHECKING:
    from .._costate import Robot, Step


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
        base = Held.apply(q)
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
        state = Constant.apply(here, q, v, tau)
        d = change(q, v, tau)
        moved = charts.moved(state[..., :nq], d[..., :n], torch.stack)
        return torch.cat([moved, state[..., nq:] + d[..., n:]], -1)

    return call
