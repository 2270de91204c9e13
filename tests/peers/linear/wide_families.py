"""More families of hard problems: widely drawn members of those of hard_families.py, and kinds of their own: see wide.py."""
import numpy as np

import margin_families

from hard_families import cascade, modal, psd, s_dense, size, squash, stable, tens


def integers(r, *shape, most=3):
    return r.integers(-most, most + 1, shape).astype(float)


def unimodular(r, n):
    """An integer matrix of determinant one and its inverse, exact."""
    T = np.eye(n) + np.tril(r.integers(-1, 2, (n, n)), -1)
    U = np.eye(n) + np.triu(r.integers(-1, 2, (n, n)), 1)
    return T @ U, np.round(np.linalg.inv(T @ U))


# --- Riccati equations -------------------------------------------------------------------------------------------------

def scalar(r):
    """One state and one input, each number over sixteen decades."""
    p = dict(A=np.array([[tens(r, -8, 8) * r.choice([-1.0, 0.0, 1.0])]]), B=np.array([[tens(r, -8, 8)]]),
             Q=np.array([[tens(r, -8, 8)]]), R=np.array([[tens(r, -8, 8)]]))
    return p


def many_inputs(r):
    """Inputs whose weights spread over twelve decades."""
    n, m = size(r, 7), int(r.integers(2, 5))
    return dict(A=r.standard_normal((n, n)), B=r.standard_normal((n, m)), Q=psd(r, n), R=np.diag(10.0 ** r.uniform(-6, 6, m)))


def cross(r):
    """A cross term that keeps [Q S; S' R] positive semidefinite."""
    n, m = size(r, 6), int(r.integers(1, 3))
    W = r.standard_normal((n + m, n + m)) * 10.0 ** r.uniform(-2, 2, n + m)
    W = W.T @ W
    return dict(A=r.standard_normal((n, n)), B=r.standard_normal((n, m)), Q=W[:n, :n], S=W[:n, n:], R=W[n:, n:])


def units(r):
    """A benign problem with time in another unit and cost in another currency."""
    n, time, cost = size(r, 6), 10.0 ** r.uniform(-9, 9), 10.0 ** r.uniform(-20, 20)
    return dict(A=r.standard_normal((n, n)) * time, B=r.standard_normal((n, 1)) * time, Q=psd(r, n) * cost, R=np.eye(1) * cost)


def no_cost(r):
    """Q = 0 with modes on both sides: the smallest effort that stabilises."""
    n = size(r, 6)
    A = r.standard_normal((n, n))
    A[0, 0] += 3
    return dict(A=A, B=r.standard_normal((n, 1)), Q=np.zeros((n, n)), R=np.eye(1))


def stabilisable(r, unit=1.0):
    """Stable modes out of reach and out of sight, in coordinates of few digits."""
    n = int(r.integers(3, 7))
    T, inverse = unimodular(r, n)
    k = int(r.integers(1, n - 1))
    A = np.triu(integers(r, n, n))
    A[k:, :k] = 0
    A[k:, k:] = -unit * np.diag(r.integers(1, 5, n - k))
    B = np.r_[integers(r, k, 1) + 4, np.zeros((n - k, 1))]
    C = np.c_[integers(r, 1, k) + 5, integers(r, 1, n - k)]
    return dict(A=T @ A @ inverse, B=T @ B, Q=inverse.T @ C.T @ C @ inverse, R=np.eye(1))


def companion(r):
    """Companion form of real poles over several decades, from their polynomial."""
    n = int(r.integers(2, 6))
    poles = r.choice([-1, 1], n) * 10.0 ** r.uniform(-2, 2, n)
    A = np.diag(np.ones(n - 1), 1)
    A[-1] = -np.poly(poles)[:0:-1]
    B, Q = np.zeros((n, 1)), np.zeros((n, n))
    B[-1, 0], Q[0, 0] = 1, tens(r, -4, 4)
    return dict(A=A, B=B, Q=Q, R=np.eye(1))


def repeated(r):
    """One eigenvalue many times, with one input a block."""
    n, m = int(r.integers(3, 9)), int(r.integers(2, 4))
    T, inverse = unimodular(r, n)
    a = float(r.choice([-2, -1, 0, 1, 2]))
    N = np.diag((r.random(n - 1) < 0.6).astype(float), 1)
    return dict(A=T @ (a * np.eye(n) + N) @ inverse, B=r.standard_normal((n, max(m, int(n - N.sum())))), Q=psd(r, n, n),
                R=np.eye(max(m, int(n - N.sum()))))


def axis(r):
    """Undamped oscillators and integrators that the cost hardly sees."""
    k = int(r.integers(1, 4))
    w = 10.0 ** r.uniform(-3, 3, k)
    A = np.zeros((2 * k, 2 * k))
    for i in range(k):
        A[2 * i:2 * i + 2, 2 * i:2 * i + 2] = [[0, w[i]], [-w[i], 0]]
    B = r.standard_normal((2 * k, 1))
    C = r.standard_normal((1, 2 * k)) * np.repeat(10.0 ** r.integers(-5, 1, k), 2)
    return dict(A=A, B=B, Q=C.T @ C, R=np.eye(1))


def odd_sizes(r):
    n = int(r.choice([7, 9, 11, 13, 17, 19]))
    d = 10.0 ** r.uniform(-3, 3, n)
    return dict(A=r.standard_normal((n, n)) * d[:, None] / d, B=r.standard_normal((n, 2)) * d[:, None],
                Q=psd(r, n) / np.outer(d, d), R=np.eye(2))


def indefinite(r):
    """G of both signs, as H-infinity synthesis has them, at a level that can be reached."""
    n = size(r, 6)
    A = stable(r, n)
    B1, B2, C = r.standard_normal((n, 2)), r.standard_normal((n, 1)), r.standard_normal((2, n))
    level = 10.0 ** r.uniform(1.5, 3)
    return dict(A=A, G=B2 @ B2.T - B1 @ B1.T / level ** 2, Q=C.T @ C, kind='care_g')


def issue_care(r):
    """The shapes of reports from users, with their numbers drawn anew."""
    which = int(r.integers(0, 4))
    if which == 0:
        return dict(A=np.diag([tens(r, -2, 2), -tens(r, -12, -3)]), B=np.ones((2, 1)), Q=np.diag([1.0, 0]), R=np.eye(1))
    if which == 1:
        a, c = tens(r, 0, 4), tens(r, -3, 1)
        return dict(A=np.array([[a, 0], [1, a]]), B=np.array([[c], [0]]), Q=np.diag([0, tens(r, -8, 0)]), R=np.eye(1) * tens(r, -1, 4))
    if which == 2:
        n = int(r.integers(1, 4))
        return dict(A=integers(r, n, n), B=integers(r, n, 1) + 0.5, Q=np.eye(n), R=np.eye(1) * tens(r, -18, -10))
    n = int(r.integers(2, 6))
    A = np.diag(np.full(n, float(r.choice([-1, 0, 1])))) + np.diag(10.0 ** r.integers(-4, 5, n - 1), 1)
    return dict(A=A, B=np.eye(n)[:, [-1]] * tens(r, -4, 4), Q=np.eye(n) * tens(r, -6, 6), R=np.eye(1))


def carex_31(r):
    """A string of vehicles, weights over twelve decades."""
    N = int(r.integers(2, 11))
    n = 2 * N - 1
    A = np.zeros((n, n))
    for k in range(N):
        A[2 * k, 2 * k] = -1
        if k < N - 1:
            A[2 * k + 1, 2 * k], A[2 * k + 1, 2 * k + 2] = 1, -1
    B = np.eye(n)[:, ::2]
    return dict(A=A, B=B, Q=np.diag(np.tile([0.0, 10 * tens(r, -6, 6)], N)[:n]), R=np.eye(N) * tens(r, -6, 6))


def carex_32(r):
    """A circulant matrix."""
    n = int(r.integers(3, 25))
    A = -2 * np.eye(n) + np.roll(np.eye(n), 1, 0) + np.roll(np.eye(n), -1, 0)
    return dict(A=A, B=np.eye(n), Q=np.eye(n) * tens(r, -6, 6), R=np.eye(n) * tens(r, -6, 6))


def carex_42(r):
    """Heat in a rod by finite elements, actuator and sensor on parts of it."""
    n = int(r.integers(4, 25))
    tridiagonal = lambda a, b: b * np.eye(n) + a * np.eye(n, k=1) + a * np.eye(n, k=-1)
    E, K = tridiagonal(1.0, 4.0) / (6 * (n + 1)), -tens(r, -3, 1) * (n + 1) * tridiagonal(-1.0, 2.0)
    x = np.arange(1, n + 1) / (n + 1)
    place = lambda low, high: ((x >= low) & (x <= high)).astype(float)[:, None]
    low = r.uniform(0, 0.6)
    C = tens(r, -2, 2) * place(low, low + 0.4).T
    return dict(A=np.linalg.solve(E, K), B=np.linalg.solve(E, place(0.2, 0.6)), Q=C.T @ C, R=np.eye(1) * tens(r, -6, 2))


def carex_43(r):
    """Masses between springs and dashpots, a force at each end."""
    k = int(r.integers(2, 10))
    m, d, c = tens(r, -1, 2), tens(r, -6, 1), tens(r, -2, 4)
    N = 2 * np.eye(k) - np.eye(k, k=1) - np.eye(k, k=-1)
    N[0, 0] = N[-1, -1] = 1
    D = np.zeros((k, 2))
    D[0, 0], D[-1, 1] = 1, -1
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-c / m * N, -d / m * np.eye(k)]])
    return dict(A=A, B=np.r_[np.zeros((k, 2)), D / m], Q=np.eye(2 * k), R=np.eye(2))


def darex_41(r):
    """A delay line of any length."""
    n = int(r.integers(2, 25))
    return dict(A=np.eye(n, k=1), B=np.eye(n)[:, [-1]], Q=np.eye(n), R=np.eye(1) * tens(r, -12, 12))


# --- the discrete equation ------------------------------------------------------------------------------------------------

def discrete(make):
    def made(r):
        p = make(r)
        return dict(p, A=squash(p['A']) * r.uniform(0.3, 2.5))
    return made


def d_scalar(r):
    p = scalar(r)
    return dict(p, A=np.array([[r.choice([0.0, 1.0, -1.0, 0.5, 2.0, 1 - 1e-9, 1 + 1e-9, 1e3])]]), R=p['R'] * r.choice([0.0, 1.0, 1.0]))


def d_no_weight(r):
    """R = 0 with one or several inputs, integer data."""
    n = int(r.integers(1, 6))
    m = int(r.integers(1, min(n, 3) + 1))
    Q = np.eye(n) if r.random() < 0.5 else psd(r, n, n)
    return dict(A=integers(r, n, n), B=integers(r, n, m, most=2), Q=Q, R=np.zeros((m, m)))


def d_some_weights(r):
    """R of lower rank: some inputs cost nothing."""
    n, m = int(r.integers(2, 6)), int(r.integers(2, 4))
    R = np.diag(np.r_[np.zeros(1), 10.0 ** r.integers(-3, 4, m - 1)])
    return dict(A=r.standard_normal((n, n)), B=r.standard_normal((n, m)), Q=psd(r, n, n), R=R)


def d_cross(r):
    p = cross(r)
    return dict(p, A=squash(p['A']) * r.uniform(0.3, 2))


def d_nilpotent(r):
    """Pure delays beside an unstable mode."""
    n = int(r.integers(2, 8))
    A = np.diag(np.ones(n - 1), -1)
    A[0, 0] = r.choice([0.0, 1.0, 1.5, -1.0])
    B, Q = np.zeros((n, 1)), np.zeros((n, n))
    B[0, 0], Q[-1, -1] = tens(r, -3, 3), tens(r, -3, 3)
    return dict(A=A, B=B, Q=Q, R=np.eye(1) * tens(r, -6, 3))


def d_fast(r):
    """A chain of integrators sampled fast."""
    import math
    n, h = int(r.integers(1, 5)), 10.0 ** -r.uniform(1, 5)
    A = np.array([[h ** (j - i) / math.factorial(j - i) if j >= i else 0.0 for j in range(n)] for i in range(n)])
    B = np.array([[h ** (n - i) / math.factorial(n - i)] for i in range(n)])
    Q = np.zeros((n, n))
    Q[0, 0] = 1
    return dict(A=A, B=B, Q=Q, R=np.eye(1) * tens(r, -6, 4))


def d_slow(r):
    """Slow lags of any count in front of delays."""
    n = int(r.integers(2, 7))
    k = int(r.integers(1, n))
    e = 10.0 ** r.uniform(-12, -2)
    A = np.diag(np.ones(n - 1), -1)
    for i in range(k):
        A[i, i] = 1 - e * (i + 1)
    B, Q = np.zeros((n, 1)), np.zeros((n, n))
    B[0, 0], Q[-1, -1] = e, 1.0
    return dict(A=A, B=B, Q=Q, R=np.eye(1) * 10.0 ** r.uniform(-3, 3))


# --- Lyapunov equations ------------------------------------------------------------------------------------------------

def l_mixed(r):
    """Modes on both sides of the axis."""
    n = size(r, 5)
    d = 10.0 ** r.uniform(-3, 3, n)
    return dict(A=r.standard_normal((n, n)) * d[:, None] / d, Q=psd(r, n, n), direct=True)


def l_near(r):
    """Two modes whose sum is nearly zero, or one near zero, in integer coordinates."""
    n = int(r.integers(2, 5))
    T, inverse = unimodular(r, n)
    A = np.diag(-r.integers(1, 5, n)).astype(float)
    A[0, 0] = -2.0 ** -int(r.integers(4, 36))
    if r.random() < 0.4:
        A[0, 0] = -A[1, 1] * (1 - 2.0 ** -int(r.integers(4, 30)))
    return dict(A=T @ A @ inverse, Q=np.eye(n), direct=True)


def l_defective(r):
    n = int(r.integers(2, 8))
    A = -tens(r, -4, 2) * np.eye(n) + np.diag(10.0 ** r.integers(-2, 3, n - 1), 1)
    return dict(A=A, Q=psd(r, n))


def l_integrators(r):
    """Exact integrators in physical coordinates: no finite answer."""
    k = int(r.integers(1, 4))
    K = np.zeros((k, k))
    for i in range(k - 1):
        K[i:i + 2, i:i + 2] += float(r.integers(1, 9)) * np.array([[1, -1], [-1, 1]])
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-K, -K * 0.5]])
    return dict(A=A, Q=np.eye(2 * k), exists=False)


def dl_mixed(r):
    n = size(r, 5)
    return dict(A=squash(r.standard_normal((n, n))) * r.uniform(1.1, 3), Q=psd(r, n, n), direct=True)


def dl_slow(r):
    n = size(r, 5)
    A = np.diag(1 - 10.0 ** r.uniform(-9, -1, n)) + np.triu(integers(r, n, n), 1) * tens(r, -6, 0)
    return dict(A=A, Q=psd(r, n))


# --- systems -------------------------------------------------------------------------------------------------------------

def s_long(r):
    """Long cascades of real roots over four decades."""
    n = int(r.integers(8, 14))
    m = int(r.integers(1, n))
    return cascade(-10.0 ** r.uniform(-2, 2, n), -10.0 ** r.uniform(-2, 2, m) * r.choice([1, 1, -1], m), tens(r, -2, 2))


def s_issue(r):
    """(s + b)/((s + a)(s + c)^k): the reported shape with other numbers."""
    k = int(r.integers(1, 5))
    poles = np.r_[-10.0 ** r.uniform(-6, 6), np.full(k, -10.0 ** r.uniform(-4, 4))]
    return cascade(poles, [-10.0 ** r.uniform(-6, 6)], 1.0)


def s_direct(r):
    """As many zeros as poles."""
    n = size(r, 5)
    return dict(s_dense(r) if n < 0 else dict(A=stable(r, n), B=r.standard_normal((n, 1)), C=r.standard_normal((1, n)), D=np.array([[tens(r, -8, 2)]])))


def s_light(r):
    """Damping down to 1e-10 of the critical one."""
    return modal(r, int(r.integers(2, 6)), 10.0 ** r.uniform(-10, -6))


def sampled(make):
    """The sampled system of a family, at a rate that suits its fastest mode."""
    import scipy.linalg as sla

    def made(r):
        p = make(r)
        n = len(p['A'])
        h = 10.0 ** r.uniform(-2, 0.3) / max(np.abs(np.linalg.eigvals(p['A'])).max(), 1e-3)
        E = sla.expm(h * np.block([[p['A'], p['B']], [np.zeros((1, n + 1))]]))
        return dict(p, A=E[:n, :n], B=E[:n, n:], period=float(h))
    return made


def m_issue(r):
    """Reported loops with other numbers."""
    which = int(r.integers(0, 3))
    gain = 10.0 ** r.uniform(-9, 9)
    if which == 0:
        return cascade([0.0, -10.0 ** r.uniform(-3, 3)], [], gain)
    if which == 1:
        return cascade([-10.0 ** r.uniform(-3, 3)], [], gain)
    return cascade([0.0, 0.0, -10.0 ** r.uniform(0, 4)], [-10.0 ** r.uniform(-2, 2)], gain)


def m_delay_line(r):
    """Sampled integrators with delay and a lag."""
    d = int(r.integers(1, 6))
    n = d + 2
    A, B, C = np.diag(np.ones(n - 1), -1), np.zeros((n, 1)), np.zeros((1, n))
    A[0, 0], A[1, 1] = 1.0, r.uniform(0, 0.95)
    B[0, 0], C[0, -1] = 10.0 ** r.uniform(-4, -0.5), 1.0
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)), period=10.0 ** -r.uniform(0, 5))


def with_delay(make):
    """A loop with a delay of about its slowest or its fastest time."""
    def made(r):
        p = make(r)
        sizes = np.abs(np.linalg.eigvals(p['A']))
        sizes = sizes[sizes > 1e-9]
        rate = float(np.exp(r.uniform(np.log(sizes.min()), np.log(sizes.max())))) if len(sizes) else 1.0
        gain = 10.0 ** r.uniform(-2, 2)
        return dict(p, C=p['C'] * gain, D=p['D'] * min(gain, 1e-3), delay=10.0 ** r.uniform(-2, 0.3) / rate, kind='delayed')
    return made


def t_lag(r):
    """One to three lags, with an integrator or without."""
    n = int(r.integers(1, 4))
    poles = -10.0 ** r.uniform(-1, 1, n)
    poles[0] = 0.0 if r.random() < 0.5 else poles[0]
    return cascade(poles, [], float(np.prod(np.where(poles == 0, 1, np.abs(poles)))))


def t_modes(r):
    """Modes within two decades."""
    k = int(r.integers(1, 4))
    w, z = 10.0 ** r.uniform(-1, 1, k), 10.0 ** r.uniform(-3, -0.5)
    A, B, C = np.zeros((2 * k, 2 * k)), np.zeros((2 * k, 1)), np.zeros((1, 2 * k))
    for i in range(k):
        A[2 * i:2 * i + 2, 2 * i:2 * i + 2] = [[0, 1], [-w[i] ** 2, -2 * z * w[i]]]
        B[2 * i + 1], C[0, 2 * i] = 1.0, w[i] ** 2 * r.uniform(0.2, 1)
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)))


# --- systems with several inputs and outputs -----------------------------------------------------------------------------------

def z_planted(r):
    """Integer data with decoupling zeros and transmission zeros, any shape."""
    n, m, p = int(r.integers(2, 7)), int(r.integers(1, 4)), int(r.integers(1, 4))
    T, inverse = unimodular(r, n)
    A, B, C = np.triu(integers(r, n, n)), integers(r, n, m), integers(r, p, n)
    for i in range(n):
        if r.random() < 0.25 and not np.any(A[i, i + 1:]):
            B[i] = 0
        if r.random() < 0.25 and not np.any(A[:i, i]):
            C[:, i] = 0
    D = integers(r, p, m) * (r.random() < 0.5)
    return dict(A=T @ A @ inverse, B=T @ B, C=C @ inverse, D=D, kind='mzeros')


def z_square(r):
    n, m = int(r.integers(2, 8)), int(r.integers(2, 4))
    d = 2.0 ** r.integers(-20, 21, n)
    g = r.standard_normal
    return dict(A=g((n, n)) * d[:, None] / d, B=g((n, m)) * d[:, None], C=g((m, n)) / d, D=g((m, m)) * (r.random() < 0.3), kind='mzeros')


def z_structure(r):
    """A flexible structure with two forces and two rates, collocated or not."""
    k = int(r.integers(2, 5))
    w, z = np.sort(10.0 ** r.uniform(0, 3, k)), 10.0 ** r.uniform(-5, -1)
    w[0] = 0 if r.random() < 0.5 else w[0]
    Phi, Psi = r.standard_normal((k, 2)), r.standard_normal((k, 2))
    Psi = Phi if r.random() < 0.6 else Psi
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-np.diag(w ** 2), -2 * z * np.diag(w)]])
    return dict(A=A, B=np.r_[np.zeros((k, 2)), Phi], C=np.c_[np.zeros((2, k)), Psi.T] if r.random() < 0.5 else np.c_[Psi.T, np.zeros((2, k))],
                D=np.zeros((2, 2)), kind='mzeros')


def n_dense(r):
    n, m, p = int(r.integers(1, 9)), int(r.integers(1, 4)), int(r.integers(1, 4))
    return dict(A=stable(r, n), B=r.standard_normal((n, m)), C=r.standard_normal((p, n)), D=r.standard_normal((p, m)) * r.choice([0.0, 0.01, 1.0]))


def n_graded(r):
    p = n_dense(r)
    d = 10.0 ** r.uniform(-6, 6, len(p['A']))
    return dict(p, A=p['A'] * d[:, None] / d, B=p['B'] * d[:, None], C=p['C'] / d)


def n_modes(r):
    """Resonances of any damping, several inputs and outputs."""
    k = int(r.integers(1, 5))
    w, z = 10.0 ** r.uniform(-2, 4, k), 10.0 ** r.uniform(-8, -1, k)
    A = np.zeros((2 * k, 2 * k))
    for i in range(k):
        A[2 * i:2 * i + 2, 2 * i:2 * i + 2] = [[0, 1], [-w[i] ** 2, -2 * z[i] * w[i]]]
    return dict(A=A, B=r.standard_normal((2 * k, 2)), C=r.standard_normal((2, 2 * k)), D=np.zeros((2, 2)))


def n_error(r):
    """The error of a truncation in balanced coordinates: two systems that nearly cancel."""
    import scipy.linalg as sla
    n = int(r.integers(4, 9))
    A = -np.diag(10.0 ** r.uniform(-2, 3, n)) + 0.1 * np.triu(r.standard_normal((n, n)), 1)
    B, C = r.standard_normal((n, 1)), r.standard_normal((1, n))
    P, W = (sla.solve_continuous_lyapunov(M, -N @ N.T) for M, N in ((A, B), (A.T, C.T)))
    L = sla.cholesky(P + 1e-12 * np.trace(P) * np.eye(n), lower=True)
    U, s, _ = sla.svd(L.T @ W @ L)
    T = L @ U / np.sqrt(np.sqrt(np.maximum(s, 1e-30)))
    At, Bt, Ct = np.linalg.solve(T, A @ T), np.linalg.solve(T, B), C @ T
    k = int(r.integers(1, n - 1))
    Z = np.zeros((n, k))
    return dict(A=np.block([[At, Z], [Z.T, At[:k, :k]]]), B=np.r_[Bt, Bt[:k]], C=np.c_[Ct, -Ct[:, :k]], D=np.zeros((1, 1)))


def n_sampled(r):
    n, m, p = int(r.integers(1, 7)), int(r.integers(1, 3)), int(r.integers(1, 3))
    A = squash(r.standard_normal((n, n))) * (1 - 10.0 ** r.uniform(-6, -0.3))
    return dict(A=A, B=r.standard_normal((n, m)), C=r.standard_normal((p, n)), D=r.standard_normal((p, m)) * (r.random() < 0.5),
                period=10.0 ** r.uniform(-5, 1))


def of_kind(kind, make):
    return lambda r: dict(make(r), kind=kind)


def without_direct(make):
    def made(r):
        p = make(r)
        return dict(p, D=0 * p['D'])
    return made


def h2_integrators(r):
    """Integrators and undamped modes, seen or not, in integer coordinates: an infinite norm if seen and reached."""
    n = int(r.integers(2, 6))
    T, inverse = unimodular(r, n)
    A = np.diag(-r.integers(1, 5, n)).astype(float)
    k = int(r.integers(1, n))
    A[0, 0] = 0.0
    A[0, k] = float(r.integers(0, 3))
    B, C = integers(r, n, 1) + 0.5, integers(r, 1, n) + 0.5
    return dict(A=T @ A @ inverse, B=T @ B, C=C @ inverse, D=np.zeros((1, 1)), infinite=True, kind='mh2')


# --- sampling, reduction ------------------------------------------------------------------------------------------------------

def c_any(make):
    def made(r):
        p = make(r)
        fastest = max(np.abs(np.linalg.eigvals(p['A'])).max(), 1e-3)
        return dict(p, h=float(10.0 ** r.uniform(-4, 1) / fastest), method=str(r.choice(['zoh', 'foh', 'tustin'])), kind='c2d')
    return made


def n_stiff(r):
    """Rates over a dozen decades: lags of their own, triangles, and states that act back weakly or with the root of both rates, in other units."""
    n = int(r.integers(2, 6))
    rates = 10.0 ** r.uniform(-3, 9, n)
    form = r.integers(0, 4)
    A = [np.zeros((n, n)), np.triu(r.uniform(-1, 1, (n, n)) * 10.0 ** r.uniform(-3, 3, (n, n)), 1), r.uniform(-1, 1, (n, n)),
         np.sqrt(np.outer(rates, rates)) * r.uniform(-0.3, 0.3, (n, n))][form]
    np.fill_diagonal(A, -rates if form != 2 else -10.0 ** r.uniform(0, 10, n))
    d = 10.0 ** r.uniform(-6, 6, n) if form == 3 and r.random() < 0.5 else np.ones(n)
    return dict(A=A * d[:, None] / d, B=r.uniform(-1, 1, (n, 1)) * d[:, None], C=r.uniform(-1, 1, (1, n)) / d, D=np.zeros((1, 1)))


def c_stiff(r):
    """A stiff plant over about the time of its slowest state."""
    p = n_stiff(r)
    slowest = np.abs(np.diag(p['A'])).min()
    h = float(10.0 ** r.uniform(-1, 1) / slowest)
    if r.random() < 0.3:
        return dict(p, h=h, delay=float(h * r.uniform(0, 3)), method='zoh', kind='c2d_delayed')
    return dict(p, h=h, method=str(r.choice(['zoh', 'foh'])), kind='c2d')


def k_units(r):
    """The same as k_minimal, or lags some of which are out of reach or out of sight, in units up to 2^40 either way, exact."""
    p = k_minimal(r)
    if r.random() < 0.5:
        n = int(r.integers(2, 8))
        reach, sight = r.integers(0, 4, n) > 0, r.integers(0, 4, n) > 0
        p = dict(A=-np.diag(r.permutation(np.arange(1.0, n + 1))), B=(reach * r.integers(1, 5, n))[:, None].astype(float),
                 C=(sight * r.integers(1, 5, n))[None].astype(float), D=np.zeros((1, 1)), kind='minimal')
    d = 2.0 ** r.integers(-40, 41, len(p['A']))
    return dict(p, A=p['A'] * d[:, None] / d, B=p['B'] * d[:, None], C=p['C'] / d)


def z_far(r):
    """Lags whose residues sum to a share of 1e-3 to 1e-12 of themselves: a zero that far away."""
    n = int(r.integers(2, 5))
    c = r.integers(1, 1000, n) / 64.0
    c[-1] = -c[:-1].sum() * (1 - 10.0 ** r.uniform(-11.5, -3))
    d = 2.0 ** r.integers(-30, 31, n) if r.random() < 0.5 else np.ones(n)
    return dict(A=-np.diag(r.permutation(np.arange(1.0, n + 1))), B=d[:, None], C=(c / d)[None], D=np.zeros((1, 1)), kind='zeros')


def c_delay(make):
    def made(r):
        p = dict(make(r))
        n = len(p['A'])
        p['D'] = np.zeros((len(p['C']), p['B'].shape[1])) if r.random() < 0.7 else p['D']
        h = float(10.0 ** r.uniform(-3, 0.5) / max(np.abs(np.linalg.eigvals(p['A'])).max(), 1e-3))
        return dict(p, h=h, delay=float(h * r.uniform(0, 3)), method='zoh', kind='c2d_delayed')
    return made


def b_stable(make):
    def made(r):
        p = make(r)
        n = len(p['A'])
        return dict(p, order=int(r.integers(1, n + 1)), kind='balred')
    return made


def b_rigid(r):
    """A free body with flexible modes in physical coordinates."""
    k = int(r.integers(2, 5))
    m = 10.0 ** r.uniform(-2, 2, k)
    K = np.zeros((k, k))
    for i in range(k - 1):
        K[i:i + 2, i:i + 2] += 10.0 ** r.uniform(1, 6) * np.array([[1, -1], [-1, 1]])
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-K / m[:, None], -10.0 ** r.uniform(-5, -3) * K / m[:, None]]])
    B = np.zeros((2 * k, 1))
    B[k, 0] = 1 / m[0]
    C = np.zeros((1, 2 * k))
    C[0, k - 1] = 1
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)), order=int(r.integers(2, 2 * k + 1)), kind='balred', rigid=2)


def k_minimal(r):
    """Integer data with parts out of reach and out of sight: the order of the minimal part is known."""
    n = int(r.integers(3, 9))
    T, inverse = unimodular(r, n)
    sizes = np.sort(r.integers(0, n + 1, 3))
    a, b, c = sizes
    A = integers(r, n, n)
    A[a:, :a] = 0  # Kalman form: seen by the input first
    A = np.triu(A) - np.diag(np.arange(1.0, n + 1))
    B, C = integers(r, n, 1) + 0.5, integers(r, 1, n) + 0.5
    B[a:] = 0
    C[:, :min(b - a, a)] = 0
    d = 2.0 ** r.integers(-10, 11, n) if r.random() < 0.5 else np.ones(n)
    A, B, C = T @ A @ inverse, T @ B, C @ inverse
    return dict(A=A * d[:, None] / d, B=B * d[:, None], C=C / d, D=np.zeros((1, 1)), kind='minimal')


FAMILIES = {
    'care': dict(scalar=scalar, many_inputs=many_inputs, cross=cross, units=units, no_cost=no_cost, stabilisable=stabilisable,
                 companion=companion, repeated=repeated, axis=axis, odd_sizes=odd_sizes, indefinite=indefinite, issue=issue_care, carex_31=carex_31, carex_32=carex_32, carex_42=carex_42, carex_43=carex_43),
    'dare': dict(scalar=d_scalar, many_inputs=discrete(many_inputs), units=discrete(units), stabilisable=lambda r: stabilisable(r, 0.125),
                 free_inputs=d_no_weight, some_weights=d_some_weights, cross=d_cross, nilpotent=d_nilpotent, fast=d_fast, slow_lags=d_slow,
                 odd_sizes=discrete(odd_sizes), repeated=discrete(repeated), darex_41=darex_41),
    'lyap': dict(mixed=l_mixed, near=l_near, defective=l_defective, integrators=l_integrators),
    'dlyap': dict(mixed=dl_mixed, slow=dl_slow),
    'zeros': dict(long=s_long, issue=s_issue, direct=s_direct, light=s_light, sampled=sampled(s_dense), planted=z_planted, square=z_square,
                  structure=z_structure, far=z_far),
    'margins': dict(issue=m_issue, delay_line=m_delay_line, direct=s_direct, light=s_light, sampled=sampled(s_dense), long=s_long,
                    **margin_families.FAMILIES),
    'delayed': dict(lags=with_delay(t_lag), modes=with_delay(t_modes)),
    'norms': dict(dense=of_kind('bounds', n_dense), graded=of_kind('bounds', n_graded), modes=of_kind('bounds', n_modes),
                  error=of_kind('bounds', n_error), sampled=of_kind('bounds', n_sampled)),
    'mh2': dict(dense=of_kind('mh2', without_direct(n_dense)), graded=of_kind('mh2', without_direct(n_graded)),
                modes=of_kind('mh2', n_modes), sampled=of_kind('mh2', n_sampled), integrators=h2_integrators),
    'c2d': dict(dense=c_any(n_dense), graded=c_any(n_graded), modes=c_any(n_modes), delayed=c_delay(n_dense), delayed_modes=c_delay(n_modes), stiff=c_stiff),
    'balred': dict(dense=b_stable(n_dense), graded=b_stable(n_graded), modes=b_stable(n_modes), rigid=b_rigid),
    'minimal': dict(kalman=k_minimal, units=k_units),
}
