"""The joints of a Pinocchio model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import argument_error

if TYPE_CHECKING:
    from ._costate import Robot


class JointMap:
    """Order and sign of the joints of a robot in a Pinocchio model; made by ``Robot.map_to``.

    Joints are found by their names and are of one kind in both. A joint has sign -1 where its axis points the other
    way than in the model, compared in the world at zero; a model without placements (``jointPlacements``) is taken to
    have the same axes. Continuous joints, for which Pinocchio has a cosine and a sine, are converted. A floating joint
    is a free flyer of the model, whose entries of q and v have the same order and meaning, a spherical one a
    spherical joint; both have the same frame in both.

    Parameters
    ----------
    robot : Robot
        The robot.
    model : pinocchio.Model
        A model with one joint for each of ``robot.joint_names``, of which those of a free joint are one, and no other.

    Attributes
    ----------
    indices_q, indices_v : list of int
        Where the model has each entry of q and v of the robot.
    signs : list of float
        1 or -1 for each of ``robot.joint_names``.

    Raises
    ------
    ArgumentError
        Where the joints of the two differ in name, kind or axis; it names them. Of the methods where the last axis of
        an array has another length.
    """

    def __init__(self, robot: Robot, model: Any) -> None:
        if not all(hasattr(model, part) for part in ("names", "joints", "idx_qs")):
            raise argument_error("model", f"model is a {type(model).__name__}; give a pinocchio.Model")
        names = list(model.names)
        joints = _joints(robot)
        own = [joint.name for joint in joints]
        missing = [name for name in own if name not in names]
        other = [name for name in names[1:] if name not in own]
        if missing or other:
            sides = [("the robot has the joints", missing), ("the model has the joints", other)]
            each = [f"{what} {', '.join(repr(name) for name in names)} alone" for what, names in sides if names]
            raise argument_error("model", f"{', and '.join(each)}; lock them, or read both with the same joints")
        theirs = [names.index(name) for name in own]
        widths = [int(getattr(model.joints[j], "nq", 1)) for j in theirs]
        for joint, j, width in zip(joints, theirs, widths, strict=True):
            # A planar joint has as many entries of q and v as a spherical one.
            if joint.free and (width != joint.nq or not _is_free(model.joints[j])):
                raise argument_error("model", f"the joint '{joint.name}' is {joint.free} in the robot, and not in the model")
            if not joint.free and width > 2:
                raise argument_error(
                    "model",
                    f"the joint '{joint.name}' has several degrees of freedom in the model, and one in the robot "
                    "(floating_base=True and quaternions=True read such joints)",
                )
        velocities = getattr(model, "idx_vs", model.idx_qs)
        self.indices_q: list[int] = []
        self.indices_v: list[int] = []
        circles: list[int] = []
        for joint, j, width in zip(joints, theirs, widths, strict=True):
            if not joint.free and width == 2:
                circles.append(joint.position)
            self.indices_q += range(int(model.idx_qs[j]), int(model.idx_qs[j]) + joint.nq)
            self.indices_v += range(int(velocities[j]), int(velocities[j]) + joint.nv)
        self.signs: list[float] = _signs(robot, model, joints, theirs)
        self._circles = circles
        self._nq, self._own_nq, self._n = sum(widths), robot.nq, robot.n
        self._index_q = np.array(self.indices_q, dtype=int)
        self._index_v = np.array(self.indices_v, dtype=int)
        self._sign = np.array(self.signs)
        # Those of the entries of q.
        self._sign_q = np.ones(robot.nq)
        for joint in joints:
            if not joint.free:
                self._sign_q[joint.position] = self._sign[joint.coordinate]

    def q_to_pinocchio(self, q: ArrayLike) -> NDArray[np.float64]:
        """Positions of the robot as those of the model.

        Parameters
        ----------
        q : array_like (..., robot.nq)
            As `Robot` has it (rad, m, quaternions).

        Returns
        -------
        ndarray (..., model.nq)
            In the order of the model, with cosine and sine of continuous joints.
        """
        turned = _states("q", q, self._own_nq) * self._sign_q
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
        q : array_like (..., model.nq)
            In the order of the model.

        Returns
        -------
        ndarray (..., robot.nq)
            As `Robot` has it (rad, m, quaternions); continuous joints within pi of 0.
        """
        given = _states("q", q, self._nq)
        out = given[..., self._index_q].copy()
        for k in self._circles:
            at = self.indices_q[k]
            out[..., k] = np.arctan2(given[..., at + 1], given[..., at])
        result: NDArray[np.float64] = out * self._sign_q
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


class _Joint(NamedTuple):
    """A joint of a robot, with its first entries of q and v."""

    name: str
    free: str  # The kind of a floating or spherical joint, and nothing for others.
    position: int
    coordinate: int

    @property
    def nq(self) -> int:
        return {"floating": 7, "spherical": 4}.get(self.free, 1)

    @property
    def nv(self) -> int:
        return {"floating": 6, "spherical": 3}.get(self.free, 1)


def _joints(robot: Robot) -> list[_Joint]:
    """The joints in their order; those that a free joint consists of are one."""
    free = {coordinate: (name, kind) for name, kind, _, coordinate in robot.free_joints}
    names, joints = robot.joint_names, list[_Joint]()
    position = coordinate = 0
    while coordinate < robot.n:
        name, kind = free.get(coordinate, (names[coordinate], ""))
        joints.append(_Joint(name, kind, position, coordinate))
        position, coordinate = position + joints[-1].nq, coordinate + joints[-1].nv
    return joints


def _is_free(joint: Any) -> bool:
    """Whether a joint of a model turns freely, as far as its name tells."""
    name = joint.shortname() if hasattr(joint, "shortname") else ""
    return not name or name.endswith(("FreeFlyer", "Spherical"))


def _signs(robot: Robot, model: Any, joints: Sequence[_Joint], theirs: Sequence[int]) -> list[float]:
    """The sign of the product of the axes in the world at zero, for each entry of v."""
    if not hasattr(model, "jointPlacements"):
        return [1.0] * robot.n
    from ._costate import Dynamics

    dynamics = Dynamics(robot.without_constraints())
    zero = robot.neutral()
    signs: list[float] = []
    for own, joint in zip(joints, theirs, strict=True):
        name, frame = own.name, dynamics.frame(f"joint:{own.name}")
        if own.free:
            turn, place = _frame(model, joint)
            found, origin = frame.pose(zero)
            size = max(1.0, float(np.abs(origin).max()))
            if np.abs(found - turn).max() > 1e-6 or np.abs(origin - place).max() > 1e-6 * size:
                raise argument_error("model", f"the joint '{name}' has another frame in the model, at zero")
            signs += [1.0] * own.nv
            continue
        axis, kind = _axis(model, joint)
        ours = robot.joint_kinds[own.coordinate]
        if kind != ours:
            raise argument_error("model", f"the joint '{name}' is {kind} in the model and {ours} in the robot")
        columns = frame.jacobian(zero)[:, own.coordinate]
        product = float((columns[:3] if ours == "revolute" else columns[3:]) @ axis)
        if abs(abs(product) - 1) > 1e-6:
            raise argument_error("model", f"the axis of the joint '{name}' has another direction in the model")
        signs.append(float(np.sign(product)))
    return signs


def _frame(model: Any, joint: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The axes and the origin of the frame of a joint of the model, in the world at zero."""
    turn, place = np.eye(3), np.zeros(3)
    while joint:
        placement = model.jointPlacements[joint]
        rotation = np.asarray(placement.rotation)
        turn, place = rotation @ turn, np.asarray(placement.translation) + rotation @ place
        joint = model.parents[joint]
    return turn, place


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
