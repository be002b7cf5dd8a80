"""What the peer evaluates at one collocation point: values, Jacobian and contracted Hessian of the constraints there.

z = (q, v, a), c(z) = (tau, clearances); Jacobian and lower triangle of the Hessian of lam.c by CasADi. The functions are
compiled once a robot and called at every point."""

import functools
import hashlib
from dataclasses import dataclass

import casadi as ca

import obstacles
from model import Model
from shell import build_once, compilers

FLAGS = "-O3 -march=native"


@dataclass
class Points:
    """c(z, par), the entries of dc/dz and of the triangle, and where they stand; `par` are the obstacles."""
    value: ca.Function
    jacobian: ca.Function
    hessian: ca.Function
    jacobian_at: tuple
    hessian_at: tuple
    rows: int


def expressions(robot, spheres):
    model, n = Model(robot), robot.n
    q, v, a = (ca.SX.sym(name, n) for name in "qva")
    z, par = ca.vertcat(q, v, a), ca.SX.sym("par", 4 * spheres)
    value = ca.vertcat(model.torques(q, v, a), obstacles.clearances(model, q, par, spheres))
    weights = ca.SX.sym("lam", value.numel())
    jacobian = ca.jacobian(value, z)
    hessian = ca.tril(ca.hessian(ca.dot(weights, value), z)[0])
    options = {"cse": True}
    return {
        "value": ca.Function("value", [z, par], [ca.densify(value)], options),
        "jacobian": ca.Function("jacobian", [z, par], [entries(jacobian)], options),
        "hessian": ca.Function("hessian", [z, par, weights], [entries(hessian)], options),
    }, jacobian.sparsity(), hessian.sparsity()


def entries(matrix):
    return ca.vertcat(*matrix.nonzeros())


def compiled(cache, name, function):
    """The function from C."""
    stem = f"{name}_{function.name()}"
    generator = ca.CodeGenerator(f"{stem}.c")
    generator.add(function)
    return ca.external(function.name(), str(library(cache, stem, generator.dump())))


def library(cache, stem, text, flags=FLAGS):
    """C compiled by the first compiler that there is; again only if its text has changed."""
    folder = cache / "points"
    folder.mkdir(exist_ok=True)
    source = folder / f"{stem}_{hashlib.sha256(text.encode()).hexdigest()[:12]}.c"
    if not source.exists():
        source.write_text(text)
    _, c, _ = compilers()[0]
    command = [c, "-std=gnu11", *flags.split(), "-w", "-fPIC", "-shared", source, "-lm"]
    return build_once(cache, f"{stem}.so", command, [source])


def build(cache, robot, spheres):
    """Compiled."""
    name = f"{robot.name}{spheres or ''}"
    return interpreted(robot, spheres, functools.partial(compiled, cache, name))


def interpreted(robot, spheres, made=lambda function: function):
    """As CasADi evaluates them itself, or as what is made of them."""
    found, in_jacobian, in_hessian = expressions(robot, spheres)
    rows = found["value"].numel_out(0)
    found = [made(function) for function in found.values()]
    return Points(*found, in_jacobian.get_triplet(), in_hessian.get_triplet(), rows)


def forward(points, n):
    """h(q, v) and M(q), for the judge, from the points of a robot without obstacles: torques do not depend on more than the
    first power of a. Nothing else has to be differentiated or compiled."""
    q, v, none = ca.MX.sym("q", n), ca.MX.sym("v", n), ca.DM(0, 1)
    z = ca.vertcat(q, v, ca.DM.zeros(n))
    rows, columns = (list(part) for part in points.jacobian_at)
    jacobian = ca.MX(ca.Sparsity.triplet(points.rows, 3 * n, rows, columns), points.jacobian(z, none))
    return ca.Function("forward", [q, v], [points.value(z, none), ca.densify(jacobian[:, 2 * n:])])
