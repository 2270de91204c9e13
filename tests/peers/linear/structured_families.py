"""Problems with a structure that fast formulas may overlook: see structured.py."""
import numpy as np
import scipy.linalg as sla

from composed_families import plant, wanted
from hard_families import psd, size
from stress_families import of_kind
from wide_families import unimodular

# --- chains whose largest ways are not the shortest ------------------------------------------------------------------------------


def damped_rod(r, most=10):
    """Masses between springs and dashpots far weaker than these: the shortest way leads through the dashpots."""
    k = int(r.integers(4, most + 1))
    m, s, d = (10.0 ** r.uniform(-0.3, 0.3, count) for count in (k, k + 1, k + 1))
    link = lambda c: np.diag(c[:-1] + c[1:]) - np.diag(c[1:-1], 1) - np.diag(c[1:-1], -1)
    K, D = link(s) / m[:, None], link(d) * 10.0 ** r.uniform(-8, 0) / m[:, None]
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-K, -D]])
    B, C = np.zeros((2 * k, 1)), np.zeros((1, 2 * k))
    B[k, 0], C[0, k - 1] = 1.0, 1.0
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)))


def two_way(r):
    """A chain that acts on both neighbours, forward and backward by factors over four decades, with shortcuts that are weaker by far."""
    n = int(r.integers(6, 21))
    forward, back = 10.0 ** r.uniform(-2, 0, n - 1), 10.0 ** r.uniform(-4, -1, n - 1)
    A = np.diag(forward, -1) + np.diag(back, 1) - np.diag(10.0 ** r.uniform(-2, 0, n) + 0.5)
    for _ in range(int(r.integers(0, 4))):
        i, j = sorted(r.integers(0, n, 2))
        A[j, i] += 10.0 ** r.uniform(-30, -8)
    B, C = np.zeros((n, 1)), np.zeros((1, n))
    B[0, 0], C[0, -1] = 1.0, 1.0
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)))


def held(make):
    def made(r):
        p = make(r)
        h = float(10.0 ** r.uniform(-3, 0.7) / np.abs(np.linalg.eigvals(p['A'])).max())
        return dict(p, h=h, method=str(r.choice(['zoh', 'foh'])), kind='c2d')
    return made


def beside_a_sample(make):
    """A delay of whole periods, and of a few roundings to a thousandth of a period more or less."""
    def made(r):
        p = make(r)
        h = float(10.0 ** r.uniform(-3, 0.7) / np.abs(np.linalg.eigvals(p['A'])).max())
        offset = float(r.choice([-1, 0, 1])) * 2.0 ** -int(r.integers(10, 53))
        return dict(p, h=h, delay=max(0.0, h * (int(r.integers(0, 4)) + offset)), method='zoh', kind='c2d_delayed')
    return made


# --- equations with E --------------------------------------------------------------------------------------------------------------

def units(r, n, decades=6):
    return 10.0 ** r.uniform(-decades, decades, n)


def equation(r, n, discrete=False):
    A = r.standard_normal((n, n))
    if discrete:
        A = A / np.abs(np.linalg.eigvals(A)).max() * r.uniform(0.5, 1.5)
    return dict(A=A, B=r.standard_normal((n, 1 + n // 3)), Q=psd(r, n), R=np.eye(1 + n // 3))


def in_units(r, p):
    """Equations and states in units over twelve decades each."""
    n = len(p['A'])
    left, right = units(r, n), units(r, n)
    scaled = dict(p, A=p['A'] * left[:, None] * right, E=p['E'] * left[:, None] * right)
    if 'B' in p:
        return dict(scaled, B=p['B'] * left[:, None], Q=p['Q'] * right[:, None] * right)
    return dict(scaled, Q=p['Q'] * left[:, None] * left)


def mass(r, n):
    """A mass matrix that is well conditioned but for units, or rotated with singular values over up to eight decades."""
    if r.random() < 0.5:
        return r.standard_normal((n, n)) + 2 * np.eye(n)
    U, V = (np.linalg.qr(r.standard_normal((n, n)))[0] for _ in range(2))
    return U @ np.diag(10.0 ** -r.uniform(0, 8, n)) @ V


def weighted(discrete=False, scaled=True):
    def made(r):
        n = size(r)
        p = equation(r, n, discrete)
        E = mass(r, n)
        p = dict(p, A=p['A'] @ E, E=E)
        return in_units(r, p) if scaled else p
    return made


def weighted_lyapunov(r):
    n = size(r)
    A = r.standard_normal((n, n))
    A = A - (np.linalg.eigvals(A).real.max() + 10.0 ** r.uniform(-3, 0)) * np.eye(n)
    E = mass(r, n)
    return in_units(r, dict(A=A @ E, E=E, Q=psd(r, n)))


# --- placement ----------------------------------------------------------------------------------------------------------------------

def place_wide(r):
    """Poles over six decades, some of them those of the plant."""
    n, m = int(r.integers(2, 7)), int(r.integers(1, 4))
    A = r.standard_normal((n, n)) + np.diag(-10.0 ** r.uniform(-3, 3, n))
    poles = [[-10.0 ** u, 0.0] for u in r.uniform(-3, 3, n)]
    own = [l.real for l in np.linalg.eigvals(A) if l.imag == 0 and l.real < 0]
    for k, l in enumerate(own[:int(r.integers(0, 3))]):
        poles[k] = [float(l), 0.0]
    return dict(A=A, B=r.standard_normal((n, m)), poles=poles, kind='place')


def place_parallel(r):
    """Inputs that are parallel but for 1e-2 to 1e-9."""
    n, m = int(r.integers(3, 7)), int(r.integers(2, 4))
    b = r.standard_normal((n, 1))
    B = b @ r.standard_normal((1, m)) + 10.0 ** -r.uniform(2, 9) * r.standard_normal((n, m))
    return dict(A=r.standard_normal((n, n)), B=B, poles=wanted(r, n), kind='place')


# --- reductions ----------------------------------------------------------------------------------------------------------------------

def copies(r):
    """Two or three copies of one system in parallel, and states that only the output or only the input knows, in rotated integers and units."""
    n, k = int(r.integers(1, 4)), int(r.integers(2, 4))
    A = np.triu(r.integers(-2, 3, (n, n)), 1) - np.diag(r.permutation(np.arange(1, 7))[:n]).astype(float)
    B, C = r.integers(1, 4, (n, 1)).astype(float), r.integers(1, 4, (1, n)).astype(float)
    A, B, C = sla.block_diag(*[A] * k), np.r_[tuple([B] * k)], np.c_[tuple([C * 2.0 ** -int(r.integers(0, 8)) for _ in range(k)])]
    T, inverse = unimodular(r, n * k)
    d = 2.0 ** r.integers(-12, 13, n * k)
    return dict(A=T @ A @ inverse * d[:, None] / d, B=T @ B * d[:, None], C=C @ inverse / d, D=np.zeros((1, 1)), kind='minimal')


# --- loops and syntheses ----------------------------------------------------------------------------------------------------------------

def skewed_servos(r):
    """Servos behind a gain matrix of condition up to 1e6, closed through nearly its inverse."""
    m = int(r.integers(2, 4))
    U, V = (np.linalg.qr(r.standard_normal((m, m)))[0] for _ in range(2))
    s = np.diag(10.0 ** -np.sort(r.uniform(0, 6, m)))
    gain, decoupling = U @ s @ V, V.T @ np.diag(1 / np.diag(s) * r.uniform(0.7, 1.4, m)) @ U.T
    rates = 10.0 ** r.uniform(-1, 1, m)
    A = np.block([[-np.diag(rates), np.zeros((m, m))], [np.diag(rates), np.zeros((m, m))]])
    B, C = np.r_[np.eye(m), np.zeros((m, m))], np.c_[np.zeros((m, m)), np.eye(m)] * 0.3
    B, C = B @ decoupling, gain @ C
    while np.linalg.eigvals(A - B @ C).real.max() >= 0:
        C = C / 2
    return dict(A=A, B=B, C=C, D=np.zeros((m, m)), kind='multiloop')


def weak_control(r):
    """Unstable poles that the control hardly reaches or the measurement hardly sees."""
    n, g = int(r.integers(2, 6)), r.standard_normal
    A = g((n, n))
    B2, C2 = g((n, 1)), g((1, n))
    B2[0] *= 10.0 ** r.uniform(-4, 0)
    C2[0, -1] *= 10.0 ** r.uniform(-4, 0)
    return plant(A, g((n, 2)), B2, g((2, n)), C2)


def fast_unstable(r):
    """An unstable pole among slow ones, a hundred to ten thousand times as fast."""
    n, g = int(r.integers(2, 6)), r.standard_normal
    A = g((n, n))
    A[0] *= 10.0 ** r.uniform(2, 4)
    A[0, 0] = abs(A[0, 0])
    return plant(A, g((n, 1)), g((n, 1)), g((1, n)), g((1, n)))


FAMILIES = {
    'c2d': dict(damped_rod=held(damped_rod), two_way=held(two_way), beside_a_sample=beside_a_sample(two_way), rod_beside_a_sample=beside_a_sample(damped_rod)),
    'gcare': dict(weighted=weighted(), rotated=weighted(scaled=False)),
    'gdare': dict(weighted=weighted(True), rotated=weighted(True, scaled=False)),
    'glyap': dict(weighted=weighted_lyapunov),
    'place': dict(wide=place_wide, parallel=place_parallel),
    'minimal': dict(copies=copies),
    'multiloop': dict(skewed_servos=skewed_servos),
    'level': dict(weak_control=weak_control, fast_unstable=fast_unstable),
    'mh2': dict(damped_rod=of_kind('mh2', damped_rod), two_way=of_kind('mh2', two_way)),
}
