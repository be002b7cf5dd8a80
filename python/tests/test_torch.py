"""Functions of PyTorch: derivatives, maps, errors; every derivative is computed by costate."""

import costate
import numpy as np
import pytest
from conftest import assert_close, load

torch = pytest.importorskip("torch")
import costate.torch


@pytest.fixture(scope="module")
def dynamics():
    return costate.Dynamics(load("two_link.toml"))


@pytest.fixture
def z(random):
    return [torch.tensor(part, requires_grad=True) for part in random.normal(size=(3, 4, 2))]


def functions(dynamics):
    model = costate.torch.Model(dynamics)
    return {"f": model.f, "aba": model.aba, "rnea": model.rnea, "step": model.step("rk4", 0.05)}


@pytest.mark.parametrize("name", ["f", "aba", "rnea", "step"])
@pytest.mark.parametrize("coordinates", ["qv", "qp"])
def test_gradients_twice(dynamics, z, name, coordinates):
    function = functions(costate.Dynamics(dynamics.robot, coordinates))[name]
    assert torch.autograd.gradcheck(function, z)
    assert torch.autograd.gradgradcheck(function, z)


def test_values_and_exact_hessians(dynamics, random):
    model = costate.torch.Model(dynamics)
    q, v, tau = random.normal(size=(3, 2))
    y, d = random.normal(size=4), random.normal(size=6)
    cost = lambda z: torch.tensor(y) @ model.f(*z.split(2))
    at = torch.tensor(np.concatenate([q, v, tau]), requires_grad=True)
    assert_close(model.f(*torch.tensor(np.stack([q, v, tau]))).numpy(), dynamics.f(q, v, tau), 1e-15)
    slope = torch.autograd.grad(cost(at), at, create_graph=True)[0]
    assert_close(slope.detach().numpy(), dynamics.adjoint(q, v, tau, y))
    product = torch.autograd.grad(slope @ torch.tensor(d), at)[0]
    assert_close(product.numpy(), dynamics.hvp(q, v, tau, y, d), 1e-11)
    assert_close(torch.autograd.functional.hessian(cost, at).numpy(), dynamics.hessian(q, v, tau, y), 1e-11)


@pytest.mark.parametrize("name", ["f", "aba", "rnea", "step"])
def test_second_derivatives_of_compositions_in_all_modes(dynamics, random, name):
    """Of arguments that are curved functions themselves: what forward mode hands on has derivatives too."""
    function = functions(dynamics)[name]
    z, mixed = torch.tensor(random.normal(size=6)), torch.tensor(random.normal(size=(6, 6)))
    y = torch.tensor(random.normal(size=4 if name in ("f", "step") else 2))
    cost = lambda z: y @ function(*(torch.sin(mixed @ z) * (1 + z[0])).split(2))
    gradient, h = torch.func.grad(cost), 1e-5
    expected = torch.stack([(gradient(z + h * unit) - gradient(z - h * unit)) / (2 * h) for unit in torch.eye(6).double()])
    for outer in (torch.func.jacfwd, torch.func.jacrev):
        for inner in (torch.func.jacfwd, torch.func.jacrev):
            assert_close(outer(inner(cost))(z).numpy(), expected.numpy(), 1e-7)


def test_maps_and_broadcasting(dynamics, random):
    model = costate.torch.Model(dynamics)
    q, v, tau = (torch.tensor(part) for part in random.normal(size=(3, 5, 2)))
    expected = dynamics.jacobian(*(part.numpy() for part in (q, v, tau)))
    jacobian = torch.func.vmap(torch.func.jacrev(lambda z: model.f(*z.split(2))))(torch.cat([q, v, tau], -1))
    assert_close(jacobian.numpy(), expected)
    assert_close(torch.func.vmap(model.f, (0, None, 1))(q, v[0], tau.T).numpy(), model.f(q, v[:1], tau).numpy(), 1e-12)
    # Arguments that are broadcast get the sum of all gradients.
    shared = v[0].clone().requires_grad_()
    model.f(q, shared, tau).sum().backward()
    at = (q.numpy(), v[0].numpy(), tau.numpy())
    assert_close(shared.grad.numpy(), dynamics.adjoint(*at, np.ones(4))[:, 2:4].sum(axis=0))


def test_costate_computes_every_derivative(dynamics, monkeypatch, z):
    calls = []

    class Counted:
        def __getattr__(self, name):
            value = getattr(dynamics, name)
            if callable(value):
                return lambda *arguments: (calls.append(name), value(*arguments))[1]
            return value

    model = costate.torch.Model(Counted())
    slope = torch.autograd.grad(model.f(*z).sum(), z, create_graph=True)
    assert calls == ["f", "jacobian"]
    torch.autograd.grad(sum(part.sum() for part in slope), z)
    assert calls == ["f", "jacobian", "hessian"]
    del calls[:]
    torch.func.jvp(model.f, tuple(part.detach() for part in z), tuple(torch.ones_like(part) for part in z))
    assert calls == ["f", "jacobian"]
    del calls[:]
    at = torch.cat([part.detach()[0] for part in z])
    torch.func.hessian(lambda z: model.f(*z.split(2)).sum())(at)
    assert calls.count("f") == 1 and calls.count("hessian") == 1


def test_what_does_not_fit_is_refused(dynamics):
    model, zero = costate.torch.Model(dynamics), torch.zeros(2, dtype=torch.float64)
    for given, words in [
        (torch.zeros(2), r"torch.float32, not torch.float64; pass v.double\(\)"),
        (torch.zeros(2, dtype=torch.float64, device="meta"), r"on meta.*pass v.cpu\(\)"),
        (np.zeros(2), "v is not a tensor"),
        (torch.zeros(3, dtype=torch.float64), r"shape \[3\], not \(..., 2\)"),
    ]:
        with pytest.raises(costate.ArgumentError, match=words) as raised:
            model.f(zero, given, zero)
        assert raised.value.argument == "v"
    with pytest.raises(costate.ArgumentError, match="broadcast"):
        model.f(zero.expand(2, 2), zero.expand(3, 2), zero)
    with pytest.raises(costate.NonFiniteState, match=r"tau\[1\]"):
        model.f(zero, zero, torch.tensor([0.0, float("nan")], dtype=torch.float64))
    q = zero.clone().requires_grad_()
    slope = torch.autograd.grad(model.f(q, zero, zero).sum(), q, create_graph=True)[0]
    bend = torch.autograd.grad(slope.sum(), q, create_graph=True)[0]
    with pytest.raises(RuntimeError, match="third"):
        torch.autograd.grad(bend.sum(), q)
    for way in (torch.func.jacrev, torch.func.jacfwd):
        for twice in (torch.func.hessian, lambda f: torch.func.jacfwd(torch.func.jacfwd(f))):
            with pytest.raises(RuntimeError, match="third"):
                way(twice(lambda q: model.f(q, zero, zero).sum()))(zero)


@pytest.mark.parametrize("name", ["f", "aba", "rnea", "step"])
@pytest.mark.parametrize("coordinates", ["qv", "qp"])
def test_all_modes_agree(dynamics, random, name, coordinates):
    """Reverse and forward mode, and each over the other."""
    function = functions(costate.Dynamics(dynamics.robot, coordinates))[name]
    z, many = torch.tensor(random.normal(size=6)), torch.tensor(random.normal(size=(5, 6)))
    of = lambda z: function(*z.split(2))
    entries = of(z).shape[0]
    exact = torch.stack([torch.autograd.functional.hessian(lambda z, k=k: of(z)[k], z) for k in range(entries)]).numpy()
    modes = (torch.func.jacrev, torch.func.jacfwd)
    for outer in modes:
        assert_close(outer(of)(z).numpy(), torch.autograd.functional.jacobian(of, z).numpy())
        for inner in modes:
            assert_close(outer(inner(of))(z).numpy(), exact, 1e-11)
            assert_close(torch.func.vmap(outer(inner(of)))(many)[3].numpy(), outer(inner(of))(many[3]).numpy(), 1e-11)
    at = z.clone().requires_grad_()
    assert torch.autograd.gradcheck(of, at, check_forward_ad=True)
    assert torch.autograd.gradgradcheck(of, at, check_fwd_over_rev=True)


def test_directional_derivatives(dynamics, random):
    """One argument moves; the others have no tangents."""
    model = costate.torch.Model(dynamics)
    q, v, tau, d = (torch.tensor(part) for part in random.normal(size=(4, 3, 2)))
    J = dynamics.jacobian(q.numpy(), v.numpy(), tau.numpy())
    value, change = torch.func.jvp(lambda v: model.f(q, v, tau), (v,), (d,))
    assert_close(value.numpy(), model.f(q, v, tau).numpy(), 1e-12)
    assert_close(change.numpy(), np.einsum("...ij,...j->...i", J[..., 2:4], d.numpy()))
    with torch.autograd.forward_ad.dual_level():
        dual = torch.autograd.forward_ad.make_dual(v, d)
        again = torch.autograd.forward_ad.unpack_dual(model.f(q, dual, tau)).tangent
    assert_close(again.numpy(), change.numpy(), 1e-15)


def test_models_and_steps_are_pickled_and_compared(dynamics, tmp_path):
    import copy
    import pickle

    model = costate.torch.Model(dynamics)
    torch.save(model, tmp_path / "model.pt")
    again = torch.load(tmp_path / "model.pt", weights_only=False)
    z = torch.tensor([0.1, 0.2], dtype=torch.float64)
    assert torch.equal(again.f(z, z, z), model.f(z, z, z))
    assert again == model == copy.deepcopy(model) and hash(again) == hash(model)
    assert model != costate.torch.Model(costate.Dynamics(dynamics.robot, "qp")) and model != 1
    step = model.step("rk4", 0.1)
    assert torch.equal(pickle.loads(pickle.dumps(step))(z, z, z), step(z, z, z))
