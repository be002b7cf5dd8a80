"""C code by CasADi for F, F_x, y'F_xx in (q, p) and a, a_z, y'a_zz in (q, v): as a user writes it and as an expert does."""

import hashlib
from pathlib import Path

import casadi as ca

import describe
import energy
from machine import say


def user_hamiltonian(links):
    """H = 1/2 p'M^-1 p + V with M = L_vv; F by the gradient of H, everything else by CasADi's derivatives."""
    n = links.n
    q, p, u, y = (ca.SX.sym(name, size) for name, size in (("q", n), ("p", n), ("u", n), ("y", 2 * n)))
    v = ca.SX.sym("v", n)
    l = energy.lagrangian(links, q, v)
    m = ca.hessian(l, v)[0]
    h = ca.dot(p, ca.solve(m, p)) / 2 - ca.substitute(l, v, ca.SX.zeros(n))
    x = ca.vertcat(q, p)
    f = ca.vertcat(ca.gradient(h, p), u - ca.gradient(h, q))
    return (q, p, u, y), f, ca.jacobian(f, x), ca.hessian(ca.dot(y, f), x)[0]


def plain_hamiltonian(links):
    """All of Hess L by CasADi, one factorisation, the 2n+1 rule with whole matrices (mathematics, 2 and 6b)."""
    n = links.n
    q, p, u, y = (ca.SX.sym(name, size) for name, size in (("q", n), ("p", n), ("u", n), ("y", 2 * n)))
    v, along = ca.SX.sym("v", n), ca.SX.sym("along", 2 * n)
    z = ca.vertcat(q, v)
    hessian, gradient = ca.hessian(energy.lagrangian(links, q, v), z)
    l_vq, l_qq = hessian[n:, :n], hessian[:n, :n]
    factor = energy.Factor(hessian[n:, n:])
    w, inverse = factor.solve(l_vq), factor.solve(ca.SX.eye(n))
    f = ca.vertcat(v, gradient[:n] + u)
    f_x = ca.blockcat([[-w, inverse], [l_qq - l_vq.T @ w, w.T]])
    e = ca.vertcat(ca.horzcat(ca.SX.eye(n), ca.SX(n, n)), ca.horzcat(-w, inverse))
    direction = ca.vertcat(-y[n:], w @ y[n:] + inverse @ y[:n])
    y_f_xx = -e.T @ ca.substitute(ca.jtimes(hessian, z, along), along, direction) @ e
    at = lambda expression: ca.substitute(expression, v, factor.solve(p))
    return (q, p, u, y), at(f), at(f_x), at(y_f_xx)


def expert_hamiltonian(links):
    """M by composite bodies, the rest of Hess L by CasADi, one factorisation, the 2n+1 rule (mathematics, 2 and 6b)."""
    n = links.n
    q, p, u, y = (ca.SX.sym(name, size) for name, size in (("q", n), ("p", n), ("u", n), ("y", 2 * n)))
    v, along = ca.SX.sym("v", n), ca.SX.sym("along", 2 * n)
    l = energy.lagrangian(links, q, v)
    gradient = ca.gradient(l, ca.vertcat(q, v))
    m = energy.mass_matrix(links, q)
    l_vq, l_qq = ca.jacobian(gradient[n:], q), energy.symmetric(ca.hessian(l, q)[0])
    factor = energy.Factor(m)
    inverse = factor.inverse()
    w = inverse @ l_vq
    f = ca.vertcat(v, gradient[:n] + u)
    f_x = ca.blockcat([[-w, inverse], [energy.symmetric(l_qq - l_vq.T @ w), w.T]])
    rate = lambda block: ca.jtimes(ca.vec(block), ca.vertcat(q, v), along).reshape((n, n))
    a, b, c = energy.symmetric(rate(ca.triu(l_qq))), rate(l_vq), energy.symmetric(rate(ca.triu(m)))
    # E' [a b'; b c] E with E = [1 0; -w M^-1], in blocks.
    half = b - c @ w
    mixed = inverse @ half
    y_f_xx = -ca.blockcat([[energy.symmetric(a - b.T @ w - w.T @ half), mixed.T],
                           [mixed, energy.symmetric(inverse @ c @ inverse)]])
    direction = ca.vertcat(-y[n:], w @ y[n:] + inverse @ y[:n])
    y_f_xx = ca.substitute(y_f_xx, along, direction)
    at = lambda expression: ca.substitute(expression, v, factor.solve(p))
    return (q, p, u, y), at(f), at(f_x), at(y_f_xx)


def user_lagrangian(links):
    """a = M^-1 (u - h) with M and h of inverse dynamics; everything else by CasADi's derivatives."""
    n = links.n
    q, v, u, y = (ca.SX.sym(name, size) for name, size in (("q", n), ("v", n), ("u", n), ("y", 2 * n)))
    a = ca.SX.sym("a", n)
    tau = energy.torques(links, q, v, a)
    bias = ca.substitute(tau, a, ca.SX.zeros(n))
    f = ca.solve(ca.jacobian(tau, a), u - bias)
    z = ca.vertcat(q, v, u)
    return (q, v, u, y), f, ca.jacobian(f, z), ca.hessian(ca.dot(y[n:], f), z)[0]


def expert_lagrangian(links):
    """The implicit function theorem on tau(q, v, a) = u, to second order; M by composite bodies, one factorisation."""
    n = links.n
    q, v, u, y = (ca.SX.sym(name, size) for name, size in (("q", n), ("v", n), ("u", n), ("y", 2 * n)))
    a, weight = ca.SX.sym("a", n), ca.SX.sym("weight", n)
    x, z = ca.vertcat(q, v), ca.vertcat(q, v, a)
    tau = energy.torques(links, q, v, a)
    factor = energy.Factor(energy.mass_matrix(links, q))
    f = factor.solve(u - ca.substitute(tau, a, ca.SX.zeros(n)))
    inverse = factor.inverse()
    a_x = -inverse @ ca.jacobian(tau, x)
    a_z = ca.horzcat(a_x, inverse)
    hessian = ca.substitute(ca.hessian(ca.dot(weight, tau), z)[0], weight, inverse @ y[n:])
    # E' hessian E with E = [1 0; a_x M^-1], in blocks; it is zero in (v, a) and (a, a).
    in_a = hessian[2 * n:, : 2 * n]
    product = in_a.T @ a_x
    y_a_zz = -ca.blockcat([[energy.symmetric(hessian[: 2 * n, : 2 * n] + product + product.T), in_a.T @ inverse],
                           [inverse @ in_a, ca.SX(n, n)]])
    at = lambda expression: ca.substitute(expression, a, f)
    return (q, v, u, y), f, at(a_z), at(y_a_zz)


FORMS = (user_hamiltonian, plain_hamiltonian, expert_hamiltonian, user_lagrangian, expert_lagrangian)

# Number of joints beyond which the code becomes too long for compilers.
LARGEST = {"user": 6, "plain": 7, "expert": 7}


def write(robot, folder, kinds):
    """C files of every form of these kinds that this robot is not too large for: name of the form -> file of order 0, 1, 2."""
    folder.mkdir(exist_ok=True)
    files = {}
    for form in FORMS:
        name = form.__name__
        kind = name.split("_")[0]
        if kind not in kinds or robot.n > LARGEST[kind]:
            continue
        files[name] = [folder / f"{name}_{order}.c" for order in range(3)]
        stamp = folder / f"{name}.stamp"
        inputs = [robot.urdf.read_text(), *(Path(module.__file__).read_text() for module in (energy, describe))]
        inputs += [Path(__file__).read_text(), ca.__version__]
        now = hashlib.sha256("".join(inputs).encode()).hexdigest()
        if stamp.exists() and stamp.read_text() == now:
            continue
        say(f"CasADi: {robot.name}: {name}")
        arguments, *outputs = form(energy.Links(describe.Robot(robot.urdf)))
        for order, file in enumerate(files[name]):
            results = [ca.densify(output) for output in outputs[: order + 1]]
            function = ca.Function(file.stem, list(arguments), results, {"cse": True})
            generator = ca.CodeGenerator(file.name)
            generator.add(function)
            generator.generate(f"{folder}/")
        stamp.write_text(now)
    return files
