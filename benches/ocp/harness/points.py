"""What the peers evaluate at one collocation point: values, Jacobian and contracted Hessian of the constraints there.

z = (q, v, a), c(z) = (tau, clearances); Jacobian and lower triangle of the Hessian of lam.c by CasADi. The functions are
compiled once a robot and called at every point."""

import hashlib
import time
from dataclasses import dataclass, field

import casadi as ca
import numpy

import obstacles
from model import Model
from shell import build_once, compilers

FLAGS = "-O3 -march=native"
# Calls by which the code of two compilers is compared.
CALLS = 64


@dataclass
class Points:
    """c(z, par), the entries of dc/dz and of the triangle, and where they stand; `par` are the obstacles."""
    value: ca.Function
    jacobian: ca.Function
    hessian: ca.Function
    jacobian_at: tuple
    hessian_at: tuple
    rows: int
    # Where they are compiled to, and the files with the three functions; none if they are not compiled.
    cache: object = None
    libraries: tuple = ()
    # What is compiled of them further, by name.
    built: dict = field(default_factory=dict)


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
    """The library of the function, from C."""
    stem = f"{name}_{function.name()}"
    generator = ca.CodeGenerator(f"{stem}.c")
    generator.add(function)
    return fastest(cache, stem, generator.dump(), function.name())


def fastest(cache, stem, text, name, libraries=()):
    """The library of the compiler whose code of the named function is faster."""
    found = [library(cache, stem, text, compiler=c, libraries=libraries) for _, c, _ in compilers()]
    return min(found, key=lambda path: seconds(ca.external(name, str(path)))) if len(found) > 1 else found[0]


def seconds(function):
    """CPU time of many calls, the least of a few."""
    rng, many = numpy.random.default_rng(1), function.map(CALLS)
    arguments = [rng.uniform(0.2, 1.0, many.size_in(i)) for i in range(many.n_in())]
    found = []
    for _ in range(CALLS // 16):
        begin = time.process_time()
        many(*arguments)
        found.append(time.process_time() - begin)
    return min(found)


def library(cache, stem, text, flags=FLAGS, compiler=None, libraries=()):
    """C compiled by a compiler, the first one that there is, with libraries that it calls; again only if it has changed."""
    folder = cache / "points"
    folder.mkdir(exist_ok=True)
    source = folder / f"{stem}_{hashlib.sha256(text.encode()).hexdigest()[:12]}.c"
    if not source.exists():
        source.write_text(text)
    command = [compiler or compilers()[0][1], "-std=gnu11", *flags.split(), "-w", "-fPIC", "-shared", source, *libraries, "-lm"]
    return build_once(cache, f"{stem}.so", command, [source])


def build(cache, robot, spheres):
    """Compiled."""
    found, *places = expressions(robot, spheres)
    libraries = [compiled(cache, f"{robot.name}{spheres or ''}", function) for function in found.values()]
    functions = [ca.external(name, str(path)) for name, path in zip(found, libraries)]
    return made(functions, *places, cache, libraries)


def interpreted(robot, spheres):
    """As CasADi evaluates them itself."""
    found, *places = expressions(robot, spheres)
    return made(found.values(), *places)


def made(functions, in_jacobian, in_hessian, *files):
    value, jacobian, hessian = functions
    return Points(value, jacobian, hessian, in_jacobian.get_triplet(), in_hessian.get_triplet(), value.numel_out(0), *files)


def forward(points, n):
    """h(q, v) and M(q), for the judge, from the points of a robot without obstacles: torques do not depend on more than the
    first power of a. Nothing else has to be differentiated or compiled."""
    q, v, none = ca.MX.sym("q", n), ca.MX.sym("v", n), ca.DM(0, 1)
    z = ca.vertcat(q, v, ca.DM.zeros(n))
    rows, columns = (list(part) for part in points.jacobian_at)
    jacobian = ca.MX(ca.Sparsity.triplet(points.rows, 3 * n, rows, columns), points.jacobian(z, none))
    return ca.Function("forward", [q, v], [points.value(z, none), ca.densify(jacobian[:, 2 * n:])])
