"""Functions of JAX: derivatives in every order, maps, errors; every derivative is computed by costate."""

import warnings

import costate
import numpy as np
import pytest
from conftest import assert_close, central_differences, load

jax = pytest.importorskip("jax")
import costate.jax
import jax.numpy as jnp

jax.config.update("jax_enable_x64", True)


@pytest.fixture(scope="module")
def dynamics():
    return costate.Dynamics(load("two_link.toml"))


def functions(dynamics, order="any"):
    model = costate.jax.Model(dynamics, order)
    return {"f": model.f, "aba": model.aba, "rnea": model.rnea, "step": model.step("rk4", 0.05)}


def of(function):
    return lambda z: function(*jnp.split(z, 3))


@pytest.mark.parametrize("name", ["f", "aba", "rnea", "step"])
@pytest.mark.parametrize("coordinates", ["qv", "qp"])
def test_both_modes_and_both_orders(dynamics, name, coordinates, random):
    dynamics = costate.Dynamics(dynamics.robot, coordinates)
    z = random.normal(size=6)
    function = of(functions(dynamics, "any")[name])
    differences = central_differences(lambda z: np.asarray(function(z)), z)
    forward, reverse = jax.jacfwd(function)(z), jax.jit(jax.jacrev(function))(z)
    assert_close(forward, differences, 1e-7)
    assert_close(reverse, forward, 1e-13)
    y = random.normal(size=len(forward))
    slope = lambda z: y @ jax.jacfwd(function)(z)
    expected = central_differences(lambda z: np.asarray(slope(z)), z)
    cost = lambda z: y @ function(z)
    once = of(functions(dynamics, "reverse")[name])
    ways = {
        "forward over reverse": jax.jacfwd(jax.grad(cost)),
        "reverse over reverse": jax.jacrev(jax.grad(cost)),
        "reverse over forward": jax.jacrev(jax.jacfwd(cost)),
        "forward over forward": jax.jacfwd(jax.jacfwd(cost)),
        "one contraction": jax.jacfwd(jax.grad(lambda z: y @ once(z))),
        "one contraction, reversed": jax.jacrev(jax.grad(lambda z: y @ once(z))),
    }
    exact = jax.hessian(cost)(z)
    assert_close(exact, expected, 1e-6)
    for hessian in ways.values():
        assert_close(jax.jit(hessian)(z), exact, 1e-12)


def test_values_are_those_of_numpy(dynamics, random):
    q, v, tau = random.normal(size=(3, 70, 2))
    y = random.normal(size=4)
    model = costate.jax.Model(dynamics)
    assert_close(jax.jit(model.f)(q, v, tau), dynamics.f(q, v, tau), 1e-15)
    assert_close(model.f(q[:5, None], v[None, :3], tau[0]), dynamics.f(q[:5, None], v[None, :3], tau[0]), 1e-13)
    z = np.concatenate([q, v, tau], axis=-1)
    cost = lambda z: y @ of(costate.jax.Model(dynamics, "reverse").f)(z)
    hessians = jax.jit(jax.vmap(jax.jacfwd(jax.grad(cost))))(z)
    assert_close(hessians, dynamics.hessian(q, v, tau, y), 1e-12)
    jacobians = jax.vmap(jax.jacrev(of(model.f)))(z)
    assert_close(jacobians, dynamics.jacobian(q, v, tau), 1e-12)
    assert_close(jax.vmap(model.f, (0, None, 1))(q, v[0], tau.T), dynamics.f(q, v[0], tau), 1e-13)
    two = jax.vmap(jax.vmap(model.aba, (None, 0, None)), (0, None, None))(q[:3], v[:2], tau[0])
    assert_close(two, dynamics.aba(q[:3, None], v[None, :2], tau[0]), 1e-13)


def test_costate_computes_every_derivative(dynamics):
    """One contraction in the program of a Hessian, and no other call than those of costate."""
    y, z = jnp.ones(4), jnp.linspace(0, 1, 6)
    model = costate.jax.Model(dynamics, "reverse")
    text = jax.jit(jax.jacfwd(jax.grad(lambda z: y @ of(model.f)(z)))).lower(z).as_text()
    numbers = [dynamics._xla(verb) for verb in ("f", "jacobian", "hessian")]
    called = [f"function = {number} : i64" in text for number in numbers]
    assert called[2] and text.count("custom_call @costate") <= 3
    for word in ("sine", "cosine", "while"):
        assert word not in text
    assert costate.jax.Model(dynamics).f is not model.f and dynamics._xla("f") == numbers[0]


@pytest.mark.parametrize("order", ["any", "reverse"])
def test_every_derivative_is_counted_where_it_is_computed(dynamics, order):
    """The least that exact derivatives take, at run time: differences of values or Jacobians would need more."""
    own = costate.Dynamics(dynamics.robot)
    model = costate.jax.Model(own, order)
    function, z = of(model.f), jnp.linspace(0, 1, 6)
    assert costate.jax.calls(model.f) == {"value": 0, "jacobian": 0, "hessian": 0}
    function(z).block_until_ready()
    assert costate.jax.calls(model.f) == {"value": 1, "jacobian": 0, "hessian": 0}

    def counted(program, z=z):
        compiled = jax.jit(program).lower(z).compile()
        before = costate.jax.calls(model.f)
        jax.block_until_ready(compiled(z))
        after = costate.jax.calls(model.f)
        return [after[name] - before[name] for name in ("value", "jacobian", "hessian")]

    y = jnp.ones(4)
    cost = lambda z: y @ function(z)
    value, jacobian, hessian = counted(jax.jacrev(function))
    assert value == 0 and jacobian == 1 and hessian == 0
    value, jacobian, hessian = counted(jax.jacfwd(jax.grad(cost)))
    # All results have a contraction each unless only gradients are differentiated.
    assert value == 0 and jacobian <= 1 and hessian == (1 if order == "reverse" else 4)
    many = jnp.tile(z, (10, 1))
    value, jacobian, hessian = counted(jax.vmap(jax.jacfwd(jax.grad(cost))), many)
    assert hessian == (10 if order == "reverse" else 40)
    with pytest.raises(costate.ArgumentError, match="costate.jax"):
        costate.jax.calls(np.sin)


def test_bad_states(dynamics):
    bad = jnp.zeros((20, 2)).at[7, 1].set(jnp.nan)
    model = costate.jax.Model(dynamics)
    with pytest.raises(Exception, match=r"state \[7\]: q\[1\] \(joint '.*'\) is not finite"):
        jax.jit(model.f)(bad, jnp.zeros(2), jnp.zeros(2)).block_until_ready()
    quiet = costate.jax.Model(costate.Dynamics(dynamics.robot, on_error="nan"))
    found = np.asarray(quiet.f(bad, jnp.zeros(2), jnp.zeros(2)))
    assert np.isnan(found[7]).all() and np.isfinite(np.delete(found, 7, axis=0)).all()


def test_what_does_not_fit_is_refused(dynamics):
    model, zero = costate.jax.Model(dynamics), jnp.zeros(2)
    for given, words in [
        (jnp.zeros(2, dtype=jnp.float32), r"float32, not float64; pass v.astype\(float\)"),
        (jnp.zeros(2, dtype=int), "int64, not float64"),
        (jnp.zeros(3), r"shape \[3\], not \(..., 2\)"),
    ]:
        with pytest.raises(costate.ArgumentError, match=words) as raised:
            jax.jit(model.f)(zero, given, zero)
        assert raised.value.argument == "v"
    with pytest.raises(costate.ArgumentError, match="broadcast"):
        model.f(jnp.zeros((2, 2)), jnp.zeros((3, 2)), zero)
    with pytest.raises(costate.ArgumentError, match="order"):
        costate.jax.Model(dynamics, "forward")
    with pytest.raises(TypeError, match="third"):
        jax.jacfwd(jax.hessian(of(model.f)))(jnp.zeros(6))
    try:
        jax.config.update("jax_enable_x64", False)
        with warnings.catch_warnings(), pytest.raises(costate.ArgumentError, match="jax_enable_x64"):
            warnings.simplefilter("ignore")
            model.f(np.zeros(2), np.zeros(2), np.zeros(2))
    finally:
        jax.config.update("jax_enable_x64", True)


def test_second_derivatives_through_a_loop(dynamics, random):
    """A motion of several steps by ``lax.scan``: its Hessian is that of the same steps written one after the other."""
    tau = random.normal(size=(2, 2))
    for order, way in [("any", jax.hessian), ("reverse", lambda f: jax.jacfwd(jax.grad(f)))]:
        step = costate.jax.Model(dynamics, order).step("rk4", 0.05)

        def scanned(tau):
            x, _ = jax.lax.scan(lambda x, u: (step(x[:2], x[2:], u), None), jnp.ones(4), tau)
            return (x**2).sum()

        def written(tau):
            x = jnp.ones(4)
            for u in tau:
                x = step(x[:2], x[2:], u)
            return (x**2).sum()

        exact = way(written)(tau)
        assert_close(jax.jit(way(scanned))(tau), exact, 1e-12)
    assert_close(jax.jit(way(jax.checkpoint(scanned)))(tau), exact, 1e-12)
    slope = central_differences(lambda z: np.asarray(jax.grad(scanned)(z.reshape(2, 2))).ravel(), tau.ravel())
    assert_close(np.reshape(exact, (4, 4)), slope, 1e-6)
