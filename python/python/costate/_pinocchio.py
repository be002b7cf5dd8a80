"""The joints of a Pinocchio model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import argument_error
from ._wanted import free_joint_error

if TYPE_CHECKING:
    from ._costate import Robot


class JointMap:
    """Order and sign of the joints of a robot in a Pinocchio model; made by ``Robot.map_to``.

    Joints are found by their names and are of one kind in both. A joint has sign -1 where its axis points the other way than in the model,
    compared in the world at zero; a model without placements (``jointPlacements``) is taken to have the same axes.
    Continuous joints, for which Pinocchio has a cosine and a sine, are converted.

    Parameters
    ----------
    robot : Robot
        The robot.
    model : pinocchio.Model
        A model with one joint for each of ``robot.joint_names``, and no other.

    Attributes
    ----------
    indices_q, indices_v : list of int
        Where the model has the position and the velocity of each joint of the robot.
    signs : list of float
        1 or -1 for each joint.

    Raises
    ------
    ArgumentError
        Where the joints of the two differ in name, kind or axis; it names them. Of the methods where the last axis of
        an array has another length.
    """

    def __init__(self, robot: Robot, model: Any) -> None:
        if not all(hasattr(model, part) for part in ("names", "joints", "idx_qs")):
            raise argument_error("model", f"model is a {type(model).__name__}; give a pinocchio.Model")
        if robot.nq != robot.n:
            raise free_joint_error(robot, "is not mapped: its entries of q and v are those of a free flyer of Pinocchio")
        names = list(model.names)
        missing = [name for name in robot.joint_names if name not in names]
        other = [name for name in names[1:] if name not in robot.joint_names]
        if missing or other:
            raise argument_error(
                "model",
                f"the model lacks the joints {missing} of the robot, and the robot the joints {other} of the model; "
                "lock them in one of the two"
            )
        self._joints = [names.index(name) for name in robot.joint_names]
        widths = [int(getattr(model.joints[j], "nq", 1)) for j in self._joints]
        if any(width > 2 for width in widths):
            raise argument_error("model", "the model has joints of several degrees of freedom; a robot has them as single joints")
        velocities = getattr(model, "idx_vs", model.idx_qs)
        self.indices_q: list[int] = [int(model.idx_qs[j]) for j in self._joints]
        self.indices_v: list[int] = [int(velocities[j]) for j in self._joints]
        self.signs: list[float] = _signs(robot, model, self._joints)
        self._circles = [k for k, width in enumerate(widths) if width == 2]
        self._nq, self._n = sum(widths), len(self._joints)
        self._index_q = np.array(self.indices_q, dtype=int)
        self._index_v = np.array(self.indices_v, dtype=int)
        self._sign = np.array(self.signs)

    def q_to_pinocchio(self, q: ArrayLike) -> NDArray[np.float64]:
        """Positions of the robot as those of the model.

        Parameters
        ----------
        q : array_like (..., n)
            In the order of ``robot.joint_names`` (rad, m).

        Returns
        -------
        ndarray (..., nq)
            In the order of the model, with cosine and sine of continuous joints.
        """
        turned = _states("q", q, self._n) * self._sign
        out = np.zeros((*turned.shape[:-1], self._nq))
        out[..., self._index_q] = turned
        for k in self._circles:
            at = self.indices_q[k]
            out[..., at], out[..., at + 1] = np.cos(turned[..., k]), np.sin(turned[..., k])
        return out

    def q_from_pinocchio(self, q: ArrayLike) -> NDArray[np.float64]:
        """Positions of the model as those of the robot.

        Parameters
        ----------
        q : array_like (..., nq)
            In the order of the model.

        Returns
        -------
        ndarray (..., n)
            In the order of ``robot.joint_names`` (rad, m); continuous joints within pi of 0.
        """
        given = _states("q", q, self._nq)
        out = given[..., self._index_q].copy()
        for k in self._circles:
            at = self.indices_q[k]
            out[..., k] = np.arctan2(given[..., at + 1], given[..., at])
        result: NDArray[np.float64] = out * self._sign
        return result

    def v_to_pinocchio(self, v: ArrayLike) -> NDArray[np.float64]:
        """Velocities, accelerations or torques of the robot as those of the model.

        Parameters
        ----------
        v : array_like (..., n)
            In the order of ``robot.joint_names``.

        Returns
        -------
        ndarray (..., n)
            In the order of the model.
        """
        turned = _states("v", v, self._n) * self._sign
        out: NDArray[np.float64] = np.zeros(turned.shape)
        out[..., self._index_v] = turned
        return out

    def v_from_pinocchio(self, v: ArrayLike) -> NDArray[np.float64]:
        """Velocities, accelerations or torques of the model as those of the robot.

        Parameters
        ----------
        v : array_like (..., n)
            In the order of the model.

        Returns
        -------
        ndarray (..., n)
            In the order of ``robot.joint_names``.
        """
        result: NDArray[np.float64] = _states("v", v, self._n)[..., self._index_v] * self._sign
        return result

    def __repr__(self) -> str:
        return f"JointMap(indices_q={self.indices_q}, indices_v={self.indices_v}, signs={self.signs})"


def _states(name: str, given: ArrayLike, count: int) -> NDArray[np.float64]:
    """Vectors of so many numbers."""
    try:
        array = np.asarray(given)
    except ValueError as error:
        raise argument_error(name, f"{name} is no array of numbers: {error}") from None
    if array.dtype.kind not in "iuf":
        raise argument_error(name, f"{name} has the type {array.dtype}; give an array of numbers")
    if array.ndim == 0 or array.shape[-1] != count:
        raise argument_error(name, f"{name} has the shape {list(array.shape)}, not (..., {count})")
    return array.astype(float)


def _signs(robot: Robot, model: Any, joints: Sequence[int]) -> list[float]:
    """The sign of the product of the axes in the world at zero."""
    if not hasattr(model, "jointPlacements"):
        return [1.0] * len(joints)
    from ._costate import Dynamics

    dynamics = Dynamics(robot.without_constraints())
    zero = np.zeros(robot.n)
    signs = []
    for k, (name, joint) in enumerate(zip(robot.joint_names, joints, strict=True)):
        axis, kind = _axis(model, joint)
        ours = robot.joint_kinds[k]
        if kind != ours:
            raise argument_error("model", f"the joint '{name}' is {kind} in the model and {ours} in the robot")
        columns = dynamics.frame(f"joint:{name}").jacobian(zero)[:, k]
        product = float((columns[:3] if ours == "revolute" else columns[3:]) @ axis)
        if abs(abs(product) - 1) > 1e-6:
            raise argument_error("model", f"the axis of the joint '{name}' has another direction in the model")
        signs.append(float(np.sign(product)))
    return signs


def _axis(model: Any, joint: int) -> tuple[NDArray[np.float64], str]:
    """The axis of a joint of the model, in the world at zero, and its kind."""
    kind = model.joints[joint]
    axis: NDArray[np.float64]
    if hasattr(kind, "createData"):
        # At zero; a continuous joint has a cosine and a sine.
        q = np.zeros(sum(int(other.nq) for other in list(model.joints)[1:]))
        if int(kind.nq) == 2:
            q[int(model.idx_qs[joint])] = 1.0
        data = kind.createData()
        kind.calc(data, q)
        # The motion per rate, linear first: the one of joints that all models have.
        motion = np.asarray(data.S, dtype=float).reshape(6)
        axis, name = (motion[3:], "revolute") if motion[3:].any() else (motion[:3], "prismatic")
    else:
        axis, name = np.asarray(kind.axis, dtype=float), "prismatic" if "Prismatic" in kind.shortname() else "revolute"
    while joint:
        axis = np.asarray(model.jointPlacements[joint].rotation) @ axis
        joint = model.parents[joint]
    return axis, name
