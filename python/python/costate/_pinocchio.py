"""The joints of a Pinocchio model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import argument_error

if TYPE_CHECKING:
    from ._costate import Robot

_LETTERS = {"X": 0, "Y": 1, "Z": 2}


class JointMap:
    """Order and sign of the joints of a robot in a Pinocchio model; made by ``Robot.map_to``.

    Joints are found by their names. A joint has sign -1 where its axis points the other way than in the model,
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
        Where the joints of the two differ; it names them.
    """

    def __init__(self, robot: Robot, model: Any) -> None:
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
        self._nq = sum(widths)
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
        turned = np.asarray(q, dtype=float) * self._sign
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
        given = np.asarray(q, dtype=float)
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
        turned = np.asarray(v, dtype=float) * self._sign
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
        result: NDArray[np.float64] = np.asarray(v, dtype=float)[..., self._index_v] * self._sign
        return result

    def __repr__(self) -> str:
        return f"JointMap(indices_q={self.indices_q}, indices_v={self.indices_v}, signs={self.signs})"


def _signs(robot: Robot, model: Any, joints: Sequence[int]) -> list[float]:
    """The sign of the product of the axes in the world at zero."""
    if not hasattr(model, "jointPlacements"):
        return [1.0] * len(joints)
    from ._costate import Dynamics

    dynamics = Dynamics(robot.without_constraints())
    zero = np.zeros(robot.n)
    signs = []
    for k, (name, joint) in enumerate(zip(robot.joint_names, joints, strict=True)):
        columns = dynamics.frame(f"joint:{name}").jacobian(zero)[:, k]
        ours = columns[:3] if robot.joint_kinds[k] == "revolute" else columns[3:]
        product = float(ours @ _axis(model, joint))
        if abs(abs(product) - 1) > 1e-6:
            raise argument_error("model", f"the axis of the joint '{name}' has another direction in the model")
        signs.append(float(np.sign(product)))
    return signs


def _axis(model: Any, joint: int) -> NDArray[np.float64]:
    """The axis of a joint of the model, in the world at zero."""
    kind = model.joints[joint]
    letter = kind.shortname()[-1]
    if letter in _LETTERS:
        axis: NDArray[np.float64] = np.eye(3)[_LETTERS[letter]]
    else:
        inner = kind.extract() if hasattr(kind, "extract") else kind
        axis = np.asarray(inner.axis, dtype=float)
    while joint:
        axis = np.asarray(model.jointPlacements[joint].rotation) @ axis
        joint = model.parents[joint]
    return axis
