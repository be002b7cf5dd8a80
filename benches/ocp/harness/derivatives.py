"""Whether the derivatives that the peer is given are those of its program: central differences along random directions."""

import casadi as ca
import numpy

import robots
from eliminated import Eliminated
from quartics import Quartics
from staged import Staged
from task import Task, Tool
from transcription import Transcription

MESH, STEP, WITHIN = numpy.array([0.0, 0.2, 0.6, 1.0]), 1e-6, 1e-6


def check(root, costate, peer):
    """Programs with everything that tasks can have; whether all derivatives are right."""
    kept = True
    rng = numpy.random.default_rng(1)
    for name in ("two_link", "manutec_r3", "puma560"):
        robot = robots.read(root, costate, name)
        one = numpy.ones(robot.n)
        task = Task(name, "check", robot, 0.1 * one, None, 1.3, one, 2 * one, free=True, time_weight=0.7, q_guess=one,
                    tool=Tool((0.1, 0.2, 0.3), numpy.eye(3)), obstacles=[((0.3, 0.2, 0.1), 0.2)], own_radius=0.1,
                    q_min=-one, v_max=3 * one, a_max=20 * one)
        for kind in (Transcription, Quartics, Eliminated, Staged):
            for what, error in errors(kind(task, peer.points_of(task), MESH), rng).items():
                kept &= error <= WITHIN
                print(f"{name}, {kind.__name__}: {what} against differences: {error:.1e}: "
                      f"{'right' if error <= WITHIN else 'WRONG'}", flush=True)
    return kept


def errors(transcription, rng):
    program = transcription.PROGRAM(transcription)
    nlp, derivatives = program.nlp(), program.derivatives()
    values = ca.Function("values", [nlp["x"]], [nlp["f"], nlp["g"]])
    x, direction = rng.normal(size=(2, transcription.size))
    weight, weights = 0.7, rng.normal(size=nlp["g"].numel())
    gradient = lambda at: numpy.array(derivatives["grad_f"](at, [])[1]).ravel()
    jacobian = lambda at: numpy.array(derivatives["jac_g"](at, [])[1])
    upper = numpy.array(derivatives["hess_lag"](x, [], weight, weights))
    hessian = upper + numpy.triu(upper, 1).T
    shifted = lambda function, sign: numpy.array(function(x + sign * STEP * direction)).ravel()
    along = lambda function: (shifted(function, 1) - shifted(function, -1)) / (2 * STEP)
    pairs = {
        "gradient": (numpy.atleast_1d(gradient(x) @ direction), along(lambda at: values(at)[0])),
        "Jacobian": (jacobian(x) @ direction, along(lambda at: values(at)[1])),
        "Hessian": (hessian @ direction, along(lambda at: weight * gradient(at) + jacobian(at).T @ weights)),
    }
    return {name: float(abs(given - found).max() / abs(found).max()) for name, (given, found) in pairs.items()}
