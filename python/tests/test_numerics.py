"""The numerical core against SciPy and python-control on random problems, and its refusals."""

import control
import numpy as np
import pytest
import scipy.linalg

import counterpoise as cp


def random_system(seed, n=5, m=2, p=3):
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((n, n)) - (np.sqrt(n) + 0.5) * np.eye(n)
    return A, rng.standard_normal((n, m)), rng.standard_normal((p, n))


@pytest.mark.parametrize("seed", range(20))
def test_riccati_solutions_are_those_of_scipy(seed):
    A, B, C = random_system(seed)
    Q, R, S = C.T @ C, np.diag([0.5, 2.0]), 0.01 * B
    X, poles, gain = cp.care(A, B, Q, R, S)
    peer = scipy.linalg.solve_continuous_are(A, B, Q, R, s=S)
    assert np.allclose(X, peer, rtol=1e-9, atol=1e-12)
    assert np.allclose(np.sort_complex(poles), np.sort_complex(np.linalg.eigvals(A - B @ gain)), atol=1e-8)
    X, _, gain = cp.dare(0.2 * A, B, Q, R)
    assert np.allclose(X, scipy.linalg.solve_discrete_are(0.2 * A, B, Q, R), rtol=1e-9, atol=1e-12)
    E = np.eye(5) + 0.1 * np.random.default_rng(seed).standard_normal((5, 5))
    # SciPy refuses some of these, so the equation itself is the judge
    X, poles, gain = cp.care(A, B, Q, R, E=E)
    terms = [A.T @ X @ E, E.T @ X @ A, -(E.T @ X @ B) @ np.linalg.solve(R, B.T @ X @ E), Q]
    assert np.linalg.norm(sum(terms)) < 1e-12 * sum(np.linalg.norm(term) for term in terms)
    assert np.all(scipy.linalg.eigvals(A - B @ gain, E).real < 0) and np.all(poles.real < 0)


@pytest.mark.parametrize("seed", range(10))
def test_lyapunov_equations_hold_as_python_control_writes_them(seed):
    A, B, _ = random_system(seed, m=5)
    Q, E = B @ B.T, np.eye(5) + 0.1 * B
    C = np.random.default_rng(seed).standard_normal((5, 5))
    small = 1e-10 * np.linalg.norm(A) ** 2
    X = cp.lyap(A, Q)
    assert np.linalg.norm(A @ X + X @ A.T + Q) < small * np.linalg.norm(X)
    X = cp.lyap(A, A, C)
    assert np.linalg.norm(A @ X + X @ A + C) < small * np.linalg.norm(X)
    X = cp.lyap(A, Q, E=E)
    assert np.linalg.norm(A @ X @ E.T + E @ X @ A.T + Q) < small * np.linalg.norm(X)
    A = 0.2 * A
    X = cp.dlyap(A, Q)
    assert np.linalg.norm(A @ X @ A.T - X + Q) < small * np.linalg.norm(X)
    X = cp.dlyap(A, 0.3 * A, C)
    assert np.linalg.norm(A @ X @ (0.3 * A).T - X + C) < small * np.linalg.norm(X)


def test_a_certificate_comes_with_the_solution():
    found = cp.riccati([[0, 1], [0, 0]], [[0], [1]], np.eye(2))
    assert np.allclose(found.X, [[np.sqrt(3), 1], [1, np.sqrt(3)]], rtol=1e-15)
    assert found.certificate["relative_residual"] < 1e-14
    assert found.certificate["forward_error"].shape == (2, 2)


def test_an_equation_without_a_solution_says_why():
    with pytest.raises(cp.NumericalError, match="."):
        cp.care([[1.0, 0.0], [0.0, -1.0]], [[0.0], [1.0]], np.eye(2))
    with pytest.raises(cp.NumericalError):
        cp.care([[np.nan]], [[1.0]], [[1.0]])
    with pytest.raises(cp.NumericalError):
        cp.care(np.eye(2), np.ones((3, 1)), np.eye(2))
    with pytest.raises(cp.NumericalError):
        cp.lyap([[1.0, 0.0], [0.0, -1.0]], np.eye(2))
    with pytest.raises(ValueError):
        cp.lyap(np.zeros((2, 2, 2)), np.eye(2))


def test_margins_and_norms_are_those_of_python_control():
    loop = control.ss(control.tf([8.0], [1.0, 3.0, 3.0, 1.0]) / 2)
    for ours, theirs in zip(cp.margin(loop), control.margin(loop), strict=True):
        assert ours == pytest.approx(theirs, rel=1e-6)
    resonance = control.ss(control.tf([1.0], [1.0, 0.02, 1.0]))
    gain, rate = cp.linfnorm(resonance)
    assert gain == pytest.approx(1 / (2 * 0.01 * np.sqrt(1 - 0.01**2)), rel=1e-9)
    assert rate == pytest.approx(np.sqrt(1 - 2 * 0.01**2), rel=1e-4)
    assert cp.h2norm(control.tf([1.0], [1.0, 1.0])) == pytest.approx(np.sqrt(0.5), rel=1e-12)
    assert cp.margins(loop)["is_stable"]


def test_a_balanced_reduction_keeps_its_bound():
    A, B, C = random_system(3, n=12)
    plant = control.ss(A, B, C, np.zeros((3, 2)))
    small = cp.balred(plant, 6)
    Wc, Wo = cp.lyap(A, B @ B.T), cp.lyap(A.T, C.T @ C)
    hankel = np.sort(np.sqrt(np.linalg.eigvals(Wc @ Wo).real))[::-1]
    error, _ = cp.linfnorm(plant - small)
    assert small.nstates == 6
    assert hankel[6] * (1 - 1e-6) <= error <= 2 * hankel[6:].sum() * (1 + 1e-6)
    assert [one.nstates for one in cp.balred(plant, [2, 4])] == [2, 4]


def test_syntheses_reach_what_they_promise():
    # x' = x + w1 + u; z = (x, u); y = x + w2: both Riccati equations are X^2 - 2 X - 1 = 0
    plant = control.ss([[1.0]], [[1.0, 0.0, 1.0]], [[1.0], [0.0], [1.0]], [[0, 0, 0], [0, 0, 1], [0, 1, 0]])
    K = cp.h2syn(plant, 1, 1)
    X = 1 + np.sqrt(2)
    assert np.allclose(K.poles(), 1 - 2 * X)
    K, closed, norm, unreachable = cp.hinfsyn(plant, 1, 1)
    assert np.all(closed.poles().real < 0)
    assert cp.linfnorm(closed)[0] == pytest.approx(norm, rel=1e-6)
    assert unreachable <= norm <= unreachable * (1 + 3e-4)
