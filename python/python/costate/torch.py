"""Functions of PyTorch with exact first and second derivatives.

Tensors are float64 on the CPU, and are read and written without copies. Gradients can be differentiated again
(``create_graph=True``), and ``torch.func.vmap``, ``grad``, ``vjp`` and ``jacrev`` work. Forward mode is not
offered: write ``jacrev(jacrev(f))`` for ``torch.func.hessian(f)``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

try:
    import torch
except ImportError as _error:  # pragma: no cover
    raise ImportError("costate.torch needs PyTorch: pip install torch") from _error
import numpy as np

from ._costate import Dynamics, Step
from ._errors import argument_error
from ._wanted import dynamics_of

if TYPE_CHECKING:
    from ._costate import Robot, _Scheme

__all__ = ["Model"]


@dataclass(frozen=True)
class _Methods:
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


def _front(info: Any, dims: tuple[int | None, ...], tensors: tuple[Any, ...]) -> tuple[Any, ...]:
    """Tensors with the mapped axis in front, of those that have none as well."""
    size = info.batch_size
    return tuple(
        tensor.expand(size, *tensor.shape) if dim is None else tensor.movedim(dim, 0)
        for dim, tensor in zip(dims, tensors, strict=True)
    )


class _Value(torch.autograd.Function):  # type: ignore[misc,unused-ignore]
    """The value; all arguments have the same leading axes."""

    @staticmethod
    def forward(methods: _Methods, a: Any, b: Any, c: Any) -> Any:
        return torch.from_numpy(methods.value(_array(a), _array(b), _array(c)))

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        ctx.methods = inputs[0]
        ctx.save_for_backward(*inputs[1:])

    @staticmethod
    def backward(ctx: Any, y: Any) -> Any:
        return None, *_Adjoint.apply(ctx.methods, *ctx.saved_tensors, y).split(ctx.methods.n, -1)

    @staticmethod
    def vmap(info: Any, dims: Any, methods: _Methods, *tensors: Any) -> Any:
        return _Value.apply(methods, *_front(info, dims[1:], tensors)), 0


class _Adjoint(torch.autograd.Function):  # type: ignore[misc,unused-ignore]
    """y'J for a costate y of the value."""

    @staticmethod
    def forward(methods: _Methods, a: Any, b: Any, c: Any, y: Any) -> Any:
        jacobian = methods.jacobian(_array(a), _array(b), _array(c))
        return torch.from_numpy((_array(y)[..., None, :] @ jacobian)[..., 0, :])

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        ctx.methods = inputs[0]
        ctx.save_for_backward(*inputs[1:])

    @staticmethod
    def backward(ctx: Any, d: Any) -> Any:
        by_z, by_y = _Second.apply(ctx.methods, *ctx.saved_tensors, d)
        return None, *by_z.split(ctx.methods.n, -1), by_y

    @staticmethod
    def vmap(info: Any, dims: Any, methods: _Methods, *tensors: Any) -> Any:
        return _Adjoint.apply(methods, *_front(info, dims[1:], tensors)), 0


class _Second(torch.autograd.Function):  # type: ignore[misc,unused-ignore]
    """H d and J d, H the Hessian of y'value, for a direction d of the arguments (3n)."""

    @staticmethod
    def forward(methods: _Methods, a: Any, b: Any, c: Any, y: Any, d: Any) -> Any:
        z, along = (_array(a), _array(b), _array(c)), _array(d)[..., None]
        second = (methods.hessian(*z, np.ascontiguousarray(_array(y))) @ along)[..., 0]
        first = (methods.jacobian(*z) @ along)[..., 0]
        return torch.from_numpy(second), torch.from_numpy(first)

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        pass

    @staticmethod
    def backward(ctx: Any, *_: Any) -> Any:
        raise RuntimeError("costate has first and second derivatives; a third one is asked for")

    @staticmethod
    def vmap(info: Any, dims: Any, methods: _Methods, *tensors: Any) -> Any:
        return _Second.apply(methods, *_front(info, dims[1:], tensors)), (0, 0)


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


class _Function:
    """A function of three tensors."""

    def __init__(self, methods: _Methods, names: tuple[str, str, str] = ("q", "v", "tau")) -> None:
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
        return _Value.apply(self._methods, *(tensor.expand(*leading, n) for tensor in given))


class _StepFunction(_Function):
    """A time step; pickles are those of its `Step`."""

    def __init__(self, step: Step) -> None:
        super().__init__(_Methods(step.dynamics.n, step.f, step.jacobian, step.hessian))
        self._step = step

    def __reduce__(self) -> tuple[Any, ...]:
        return (_StepFunction, (self._step,))


class Model:
    """The dynamics of a robot, and time steps of it, as functions of PyTorch.

    ``f``, ``aba``, ``rnea`` and what ``step`` returns take three tensors (..., n) of float64 on the CPU, with any leading
    batch axes, which are broadcast. Their gradients and the gradients of these are exact; a third derivative is an
    error. Forward mode is not offered: ``torch.func.jvp``, ``jacfwd`` and ``hessian``, which is forward over reverse, raise
    ``NotImplementedError``; take ``jacrev(jacrev(f))``. Models and steps can be pickled; models of equal dynamics are equal.

    Parameters
    ----------
    dynamics : Dynamics
        The dynamics, with their coordinates and settings.

    Raises
    ------
    ArgumentError
        Where an argument is no tensor of float64 on the CPU, or has another shape.
    StateError
        As the methods of `Dynamics`.

    Examples
    --------
    >>> import costate, costate.torch, torch
    >>> robot = costate.Robot.builder("pendulum").revolute("hinge", axis=[0, 1, 0], mass=1, com=[0, 0, -1]).build()
    >>> model = costate.torch.Model(costate.Dynamics(robot))
    >>> q = torch.zeros(1, dtype=torch.float64, requires_grad=True)
    >>> zero = torch.zeros(1, dtype=torch.float64)
    >>> torch.autograd.grad(model.aba(q, zero, zero)[0], q)[0].tolist()
    [-9.81]
    """

    def __init__(self, dynamics: Dynamics | Robot) -> None:
        dynamics = dynamics_of(dynamics)
        self.dynamics = dynamics
        n = dynamics.n
        self._f = _Function(_Methods(n, dynamics.f, dynamics.jacobian, dynamics.hessian))
        rnea = _Methods(n, dynamics.rnea, dynamics.rnea_jacobian, dynamics.rnea_hessian)
        self._rnea = _Function(rnea, ("q", "v", "a"))
        # Forward dynamics are the second half of f in velocities.
        at = dynamics if dynamics.coordinates == "qv" else Dynamics(
            dynamics.robot, "qv", on_error=dynamics.on_error, threads=dynamics.threads
        )

        def jacobian(*z: Any) -> Any:
            return at.jacobian(*z)[..., n:, :]

        def hessian(q: Any, v: Any, tau: Any, y: Any) -> Any:
            return at.hessian(q, v, tau, np.concatenate([np.zeros_like(y), y], axis=-1))

        self._aba = _Function(_Methods(n, at.aba, jacobian, hessian))

    def __eq__(self, other: object) -> bool:
        return self.dynamics == other.dynamics if type(other) is type(self) else NotImplemented

    def __hash__(self) -> int:
        return hash(self.dynamics)

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), (self.dynamics,))

    def f(self, q: Any, v: Any, tau: Any) -> Any:
        """The state equation dx/dt, as `Dynamics.f`.

        Parameters
        ----------
        q : torch.Tensor (..., n)
            Positions (rad, m).
        v : torch.Tensor (..., n)
            Velocities (rad/s, m/s); with the coordinates ``"qp"`` the momenta p.
        tau : torch.Tensor (..., n)
            Torques and forces (N m, N).

        Returns
        -------
        torch.Tensor (..., 2n)
            Equation (9) or (17), (19).

        Raises
        ------
        ArgumentError
            For another type or shape.
        StateError
            For a state that cannot be evaluated.
        """
        return self._f(q, v, tau)

    def aba(self, q: Any, v: Any, tau: Any) -> Any:
        """Forward dynamics, as `Dynamics.aba`.

        Parameters
        ----------
        q : torch.Tensor (..., n)
            Positions (rad, m).
        v : torch.Tensor (..., n)
            Velocities (rad/s, m/s), in either coordinates.
        tau : torch.Tensor (..., n)
            Torques and forces (N m, N).

        Returns
        -------
        torch.Tensor (..., n)
            Accelerations (rad/s^2, m/s^2).

        Raises
        ------
        ArgumentError
            For another type or shape.
        StateError
            For a state that cannot be evaluated.
        """
        return self._aba(q, v, tau)

    def rnea(self, q: Any, v: Any, a: Any) -> Any:
        """Inverse dynamics, as `Dynamics.rnea`.

        Parameters
        ----------
        q : torch.Tensor (..., n)
            Positions (rad, m).
        v : torch.Tensor (..., n)
            Velocities (rad/s, m/s), in either coordinates.
        a : torch.Tensor (..., n)
            Accelerations (rad/s^2, m/s^2).

        Returns
        -------
        torch.Tensor (..., n)
            Torques and forces (N m, N).

        Raises
        ------
        ArgumentError
            For another type or shape.
        StateError
            For a state that cannot be evaluated.
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
            A function of (q, v, tau) whose result is the next state (..., 2n).

        Raises
        ------
        ArgumentError
            As `Step`.
        """
        return _StepFunction(Step(self.dynamics, scheme, dt))
