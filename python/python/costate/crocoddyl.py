"""Crocoddyl's solvers with exact second derivatives of the dynamics.

``SolverDDP`` and its kin ask models for first derivatives of the dynamics, and for second ones of the cost. `ActionModel`
adds those of the dynamics, contracted with the costate, to the latter; `Costates` tells it the costate after each
iteration. The steps are then those of differential dynamic programming instead of Gauss-Newton's.

D. H. Jacobson, D. Q. Mayne, Differential Dynamic Programming, 1970.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

try:
    import crocoddyl
except ImportError as _error:  # pragma: no cover
    raise ImportError("costate.crocoddyl needs Crocoddyl: pip install crocoddyl") from _error
import numpy as np
from numpy.typing import ArrayLike

from ._costate import Step
from ._errors import argument_error
from ._wanted import step_of

__all__ = ["ActionModel", "Costates", "FinalModel"]


def _weights(name: str, value: ArrayLike, count: int) -> Any:
    array = np.asarray(value, dtype=float)
    if array.shape not in ((), (count,)) or not np.isfinite(array).all():
        raise argument_error(name, f"{name} must be a number or {count} of them, all finite")
    return np.broadcast_to(array, (count,)).copy()


def _again(kind: Any, base: Any, arguments: tuple[Any, ...]) -> Any:
    """A model of a class, made by the constructor of a base; pickles set its attributes afterwards."""
    model = kind.__new__(kind)
    base.__init__(model, *arguments)
    return model


class ActionModel(crocoddyl.ActionModelAbstract):  # type: ignore[misc,unused-ignore]
    """One time step of a robot, with a quadratic cost.

    ::

        x+ = Phi(x, tau),    cost = dt/2 [ tau' R tau + (x - goal)' Q (x - goal) ]

    ``calcDiff`` computes Phi_x, Phi_tau and, where the costate y of the next state is known, adds y'Phi_xx, y'Phi_xtau and
    y'Phi_tautau to the Hessian of the cost. Override ``running_cost`` for another cost.

    Parameters
    ----------
    step : Step
        The time step, with its scheme, duration and coordinates.
    goal : array_like
        The state (2n) from which deviations are counted.
    effort : float or array_like
        Diagonal of R (n).
    deviation : float or array_like
        Diagonal of Q (2n).
    exact : bool
        Whether second derivatives of the step are used at all.

    Attributes
    ----------
    costate : ndarray or None
        y (2n), set by `Costates`.
    """

    def __init__(
        self, step: Step, goal: ArrayLike, *, effort: ArrayLike = 1.0, deviation: ArrayLike = 0.0, exact: bool = True
    ) -> None:
        n = step_of(step).dynamics.n
        crocoddyl.ActionModelAbstract.__init__(self, crocoddyl.StateVector(2 * n), n, 1)
        self.step, self.exact = step, exact
        self.costate: Any = None
        self.goal = _weights("goal", goal, 2 * n)
        self.r, self.q = _weights("effort", effort, n), _weights("deviation", deviation, 2 * n)

    def running_cost(self, x: Any, tau: Any) -> tuple[float, Any, Any, Any, Any, Any]:
        """The cost rate with its derivatives.

        Parameters
        ----------
        x : ndarray (2n)
            The state.
        tau : ndarray (n)
            Torques and forces (N m, N).

        Returns
        -------
        tuple
            Its value, l_x (2n), l_tau (n), l_xx (2n, 2n), l_xtau (2n, n) and l_tautau (n, n).
        """
        off = x - self.goal
        value = 0.5 * float(off @ (self.q * off) + tau @ (self.r * tau))
        return value, self.q * off, self.r * tau, np.diag(self.q), np.zeros((len(x), len(tau))), np.diag(self.r)

    def _split(self, x: Any, tau: Any) -> tuple[Any, Any, Any, Any]:
        x = np.array(x, dtype=float)
        tau = np.zeros(self.nu) if tau is None else np.array(tau, dtype=float)
        return x, x[: self.nu], x[self.nu :], tau

    def __reduce__(self) -> tuple[Any, ...]:
        # Classes derived from this one keep their attributes, and are made without their own __init__.
        return (_again, (type(self), ActionModel, (self.step, self.goal)), dict(self.__dict__))

    def calc(self, data: Any, x: Any, u: Any = None) -> None:
        """Put the next state and the cost into ``data``, as Crocoddyl asks for.

        Parameters
        ----------
        data : crocoddyl.ActionDataAbstract
            ``xnext`` and ``cost`` are set.
        x : ndarray (2n)
            The state.
        u : ndarray (n), optional
            Torques and forces (N m, N); none unless given.
        """
        x, q, v, tau = self._split(x, u)
        data.xnext = self.step.f(q, v, tau)
        data.cost = self.step.dt * self.running_cost(x, tau)[0]

    def calcDiff(self, data: Any, x: Any, u: Any = None) -> None:
        """Put the derivatives of the next state and of the cost into ``data``.

        Parameters
        ----------
        data : crocoddyl.ActionDataAbstract
            ``Fx``, ``Fu``, ``Lx``, ``Lu``, ``Lxx``, ``Lxu`` and ``Luu`` are set.
        x : ndarray (2n)
            The state.
        u : ndarray (n), optional
            Torques and forces (N m, N); none unless given.
        """
        x, q, v, tau = self._split(x, u)
        states, dt = len(x), self.step.dt
        _, l_x, l_u, l_xx, l_xu, l_uu = self.running_cost(x, tau)
        l_xx, l_xu, l_uu = dt * l_xx, dt * l_xu, dt * l_uu
        if self.exact and self.costate is not None:
            _, jacobian, h = self.step.contract(q, v, tau, self.costate)
            l_xx = l_xx + h[:states, :states]
            l_xu = l_xu + h[:states, states:]
            l_uu = l_uu + h[states:, states:]
        else:
            jacobian = self.step.jacobian(q, v, tau)
        data.Fx, data.Fu = jacobian[:, :states], jacobian[:, states:]
        data.Lx, data.Lu, data.Lxx, data.Lxu, data.Luu = dt * l_x, dt * l_u, l_xx, l_xu, l_uu


class FinalModel(crocoddyl.ActionModelAbstract):  # type: ignore[misc,unused-ignore]
    """The cost at the end: 1/2 (x - goal)' W (x - goal).

    Parameters
    ----------
    step : Step
        The time step of the running models.
    goal : array_like
        The state (2n) from which deviations are counted.
    weight : float or array_like
        Diagonal of W (2n).
    """

    def __init__(self, step: Step, goal: ArrayLike, weight: ArrayLike) -> None:
        states = 2 * step_of(step).dynamics.n
        crocoddyl.ActionModelAbstract.__init__(self, crocoddyl.StateVector(states), 0, 1)
        self.step = step
        self.goal, self.w = _weights("goal", goal, states), _weights("weight", weight, states)

    def __reduce__(self) -> tuple[Any, ...]:
        return (_again, (type(self), FinalModel, (self.step, self.goal, self.w)), dict(self.__dict__))

    def calc(self, data: Any, x: Any, u: Any = None) -> None:
        """Put the cost into ``data``, as Crocoddyl asks for.

        Parameters
        ----------
        data : crocoddyl.ActionDataAbstract
            ``xnext`` and ``cost`` are set.
        x : ndarray (2n)
            The state.
        u : None
            There is no control at the end.
        """
        off = np.array(x, dtype=float) - self.goal
        data.xnext, data.cost = np.array(x, dtype=float), 0.5 * float(off @ (self.w * off))

    def calcDiff(self, data: Any, x: Any, u: Any = None) -> None:
        """Put the derivatives of the cost into ``data``.

        Parameters
        ----------
        data : crocoddyl.ActionDataAbstract
            ``Lx`` and ``Lxx`` are set.
        x : ndarray (2n)
            The state.
        u : None
            There is no control at the end.
        """
        data.Lx, data.Lxx = self.w * (np.array(x, dtype=float) - self.goal), np.diag(self.w)


class Costates(crocoddyl.CallbackAbstract):  # type: ignore[misc,unused-ignore]
    """Gives each model the costate of its next state after every iteration: ``solver.setCallbacks([Costates(models)])``.

    The costate is the gradient of the value function that the last backward pass has found.

    Parameters
    ----------
    models : sequence of ActionModel
        The running models of the problem, in their order; each its own object.
    """

    def __init__(self, models: Sequence[ActionModel]) -> None:
        crocoddyl.CallbackAbstract.__init__(self)
        if len({id(model) for model in models}) != len(models):
            raise argument_error("models", "a model appears twice in models; each node has a costate of its own")
        self.models = list(models)

    def __call__(self, solver: Any) -> None:
        gradients: Iterable[Any] = solver.Vx
        for model, gradient in zip(self.models, list(gradients)[1:], strict=True):
            model.costate = np.array(gradient, dtype=float)
