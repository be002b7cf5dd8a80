"""Functions of PyTorch with exact first and second derivatives.

Tensors are float64 on the CPU, and are read and written without copies. Gradients can be differentiated again
(``create_graph=True``), and all of ``torch.func`` works: ``vmap``, ``grad``, ``vjp``, ``jvp``, ``jacrev``, ``jacfwd``, any
of them over any other, and ``hessian``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

try:
    import torch  # noqa: F401
except ImportError as _error:  # pragma: no cover
    raise ImportError("costate.torch needs PyTorch: pip install torch") from _error
import numpy as np

from .._costate import Dynamics, Step
from .._wanted import dynamics_of
from ._functions import Checked, StepFunction
from ._rules import Methods

if TYPE_CHECKING:
    from .._costate import Robot, _Scheme

__all__ = ["Model"]


class Model:
    """The dynamics of a robot, and time steps of it, as functions of PyTorch.

    ``f``, ``aba``, ``rnea`` and what ``step`` returns take three tensors (..., n) of float64 on the CPU, with any leading
    batch axes, which are broadcast. All first and second derivatives are exact, in reverse and forward mode and either over
    the other; a third one is an error. Second derivatives need one contraction for each state, and forward over forward mode
    one for each result. Models and steps can be pickled; models of equal dynamics are equal.

    With floating and spherical joints q has ``robot.nq`` entries and is differentiated by all of them: the functions do not
    change with the length of a quaternion, which must be 1 where they are evaluated.

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
        dynamics = dynamics_of(dynamics, free=True)
        self.dynamics = dynamics
        n, robot = dynamics.n, dynamics.robot
        self._f = Checked(Methods(n, dynamics.f, dynamics.jacobian, dynamics.hessian), robot)
        rnea = Methods(n, dynamics.rnea, dynamics.rnea_jacobian, dynamics.rnea_hessian)
        self._rnea = Checked(rnea, robot, ("q", "v", "a"))
        # Forward dynamics are the second half of f in velocities.
        at = dynamics if dynamics.coordinates == "qv" else Dynamics(
            dynamics.robot, "qv", on_error=dynamics.on_error, threads=dynamics.threads
        )

        def jacobian(*z: Any) -> Any:
            return at.jacobian(*z)[..., n:, :]

        def hessian(q: Any, v: Any, tau: Any, y: Any) -> Any:
            return at.hessian(q, v, tau, np.concatenate([np.zeros_like(y), y], axis=-1))

        self._aba = Checked(Methods(n, at.aba, jacobian, hessian), robot)

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
        q : torch.Tensor (..., nq)
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
        q : torch.Tensor (..., nq)
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
        q : torch.Tensor (..., nq)
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
            A function of (q, v, tau) whose result is the next state (..., nq + n).

        Raises
        ------
        ArgumentError
            As `Step`.
        """
        return StepFunction(Step(self.dynamics, scheme, dt))
