"""Problems at the edges of what doubles can tell, made from seeds: see stress.py."""
import numpy as np

from hard_families import cascade, psd, squash, stable, tens, cayley


def unimodular(r, n):
    """An integer matrix of determinant one and its inverse, exact."""
    T = np.eye(n) + np.tril(r.integers(-1, 2, (n, n)), -1)
    U = np.eye(n) + np.triu(r.integers(-1, 2, (n, n)), 1)
    return T @ U, np.round(np.linalg.inv(T @ U))


def second_order(r, k, damping, low=0.0, high=5.0, rates=False):
    """A' = [0 I; -K/m -d K/m] of a chain of masses, a force and a sensor anywhere."""
    m, c = 10.0 ** r.uniform(-1, 1, k), 10.0 ** r.uniform(low, high, k)
    K = np.diag(c)
    for i in range(1, k):
        K[i - 1, i - 1] += c[i]
        K[i - 1, i] -= c[i]
        K[i, i - 1] -= c[i]
    top = np.sqrt(np.linalg.eigvals(K / m[:, None]).real.max())
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-K / m[:, None], -damping / top * K / m[:, None]]])
    B, C = np.zeros((2 * k, 1)), np.zeros((1, 2 * k))
    at = int(r.integers(0, k))
    B[k + at, 0], C[0, int(r.integers(0, k)) + (k if rates else 0)] = 1 / m[at], 1.0
    return A, B, C


# --- Riccati and Lyapunov equations -----------------------------------------------------------------------------------------

def nearly_lost(r):
    """A mode on the axis, or beside it, that the input hardly reaches."""
    n = int(r.integers(2, 6))
    T, inverse = unimodular(r, n)
    A, B = np.triu(r.integers(-3, 4, (n, n))).astype(float), r.integers(-2, 3, (n, 1)).astype(float) + 0.5
    A[-1, :] = 0
    A[-1, -1] = r.choice([0.0, 1e-10, 1e-6, -1e-9, 1.0])
    B[-1, 0] = 2.0 ** -int(r.integers(10, 45))
    if r.random() < 0.5:
        return dict(A=A, B=B, Q=psd(r, n, n), R=np.eye(1))
    return dict(A=T @ A @ inverse, B=T @ B, Q=np.eye(n), R=np.eye(1))


def jordan(r):
    """A Jordan block of six to nine states, driven at its end, with or without rotated integers."""
    n = int(r.integers(6, 10))
    a, c = float(r.choice([-1, -0.5, 0, 0.5, 1])), 2.0 ** r.integers(-4, 5)
    A, B, Q = a * np.eye(n) + np.diag(np.full(n - 1, c), 1), np.eye(n)[:, [-1]], np.zeros((n, n))
    Q[0, 0] = tens(r, -3, 3)
    if r.random() < 0.5:
        T = np.eye(n) + np.diag(r.integers(-1, 2, n - 1), -1)
        inverse = np.round(np.linalg.inv(T))
        A, B, Q = T @ A @ inverse, T @ B, np.eye(n)
    return dict(A=A, B=B, Q=Q, R=np.eye(1) * tens(r, -6, 6))


def structure(r):
    """A chain of masses, stiff, with any damping."""
    A, B, C = second_order(r, int(r.integers(2, 7)), 10.0 ** r.uniform(-9, 0))
    return dict(A=A, B=B, Q=C.T @ C * tens(r, -2, 8), R=np.eye(1))


def any_weight(r):
    """A very light or a very heavy weight of the input."""
    n, m = int(r.integers(1, 7)), int(r.integers(1, 3))
    return dict(A=r.standard_normal((n, n)), B=r.standard_normal((n, m)), Q=psd(r, n, n), R=np.eye(m) * tens(r, -16, 16))


def nonminimal(r, unit=1.0):
    """Two copies of one system side by side, one of them out of reach, the other out of sight, stable, in integer coordinates."""
    n = int(r.integers(1, 4))
    A0 = np.triu(r.integers(-2, 3, (n, n)), 1) - np.diag(r.integers(1, 4, n))
    A = np.kron(np.eye(3), A0 * unit).astype(float)
    A[:n, :n] += 2 * unit * np.diag(r.integers(0, 3, n))
    B = np.r_[r.integers(-2, 3, (n, 1)) + 0.5, np.zeros((n, 1)), r.integers(-2, 3, (n, 1))]
    C = np.c_[r.integers(-2, 3, (1, n)) + 0.5, r.integers(-2, 3, (1, n)), np.zeros((1, n))]
    T, inverse = unimodular(r, 3 * n)
    return dict(A=T @ A @ inverse, B=T @ B, Q=inverse.T @ C.T @ C @ inverse, R=np.eye(1) * tens(r, -3, 3))


def dead_beat(r):
    """A chain of delays, to thirty, behind a mode of any speed."""
    n = int(r.integers(6, 32))
    A = np.diag(np.ones(n - 1), -1)
    A[0, 0] = r.choice([0.0, 0.5, 1.0, 1 - 1e-6, 1.2, -1.0])
    B, Q = np.zeros((n, 1)), np.zeros((n, n))
    B[0, 0], Q[-1, -1] = tens(r, -3, 3), tens(r, -3, 3)
    return dict(A=A, B=B, Q=Q, R=np.eye(1) * tens(r, -12, 6))


def d_of(make, most=1.5):
    def made(r):
        p = make(r)
        return dict(p, A=squash(p['A']) * r.uniform(0.3, most))
    return made


def d_nearly_lost(r):
    p = nearly_lost(r)
    A = np.array(p['A'])
    return dict(p, A=np.eye(len(A)) + A / 8)


def l_structure(r):
    A, B, C = second_order(r, int(r.integers(2, 6)), 10.0 ** r.uniform(-9, 0))
    return dict(A=A, Q=B @ B.T)


def l_jordan(r):
    n = int(r.integers(6, 10))
    A = -(2.0 ** -r.integers(0, 4)) * np.eye(n) + np.diag(np.full(n - 1, 2.0 ** -r.integers(0, 5)), 1)
    return dict(A=A, Q=psd(r, n, n))


def dl_jordan(r):
    p = l_jordan(r)
    return dict(p, A=cayley(p['A'] / max(1.0, np.abs(p['A']).max())))


def dl_chain(r):
    """Delays behind a mode near one."""
    p = dead_beat(r)
    A = np.array(p['A'])
    A[0, 0] = r.choice([0.0, 0.5, 1 - 1e-3, 1 - 1e-8, -0.9])
    return dict(A=A, Q=np.array(p['B']) @ np.array(p['B']).T)


# --- systems with one input and one output ------------------------------------------------------------------------------------

def siso(A, B, C, gain=1.0, **more):
    return dict(A=A, B=B, C=C * gain, D=np.zeros((1, 1)), **more)


def s_order(r, most=12, unstable=False):
    """Real and complex roots of one to twelve poles over twelve decades, as sections in series."""
    n = int(r.integers(1, most + 1))
    m = int(r.integers(0, n + 1))
    return cascade(-10.0 ** r.uniform(-6, 6, n), -10.0 ** r.uniform(-6, 6, m) * r.choice([1, -1, 1], m), tens(r, -3, 3))


def s_companion(r):
    """Companion form of two to eight poles within four decades."""
    n = int(r.integers(2, 9))
    a, b = np.poly(-10.0 ** r.uniform(-2, 2, n)), np.atleast_1d(np.poly(-10.0 ** r.uniform(-2, 2, int(r.integers(0, n)))))
    A, B, C = np.diag(np.ones(n - 1), 1), np.zeros((n, 1)), np.zeros((1, n))
    A[-1] = -a[:0:-1]
    B[-1, 0], C[0, :len(b)] = 1, b[::-1]
    return siso(A, B, C, tens(r, -2, 6))


def s_structure(r):
    A, B, C = second_order(r, int(r.integers(2, 6)), 10.0 ** r.uniform(-9, 0), rates=r.random() < 0.4)
    return siso(A, B, C, tens(r, -2, 5))


def s_jordan(r):
    """A Jordan block of six states or more, plain or in rotated integers."""
    n = int(r.integers(6, 10))
    A = -(2.0 ** -r.integers(0, 4)) * np.eye(n) + np.diag(np.full(n - 1, 2.0 ** -r.integers(0, 5)), 1)
    B, C = np.eye(n)[:, [-1]], np.zeros((1, n))
    C[0, :int(r.integers(1, n))] = 1.0
    if r.random() < 0.5:
        T = np.eye(n) + np.diag(r.integers(-1, 2, n - 1), -1)
        inverse = np.round(np.linalg.inv(T))
        A, B, C = T @ A @ inverse, T @ B, C @ inverse
    return siso(A, B, C, tens(r, -2, 4))


def s_nonminimal(r):
    """States out of reach and out of sight, in integer coordinates."""
    p = nonminimal(r)
    A, n = np.array(p['A']), len(p['A'])
    C = r.integers(-2, 3, (1, n)) + 0.0
    C[0, r.integers(n)] += 0.5
    return siso(A, np.array(p['B']), C, 2.0 ** r.integers(-6, 7))


def s_stable_nonminimal(r):
    p = s_nonminimal(r)
    A = np.array(p['A'])
    return dict(p, A=A - np.ceil(max(0.0, np.linalg.eigvals(A).real.max()) + 1) * np.eye(len(A)))


def s_chain(r):
    """A mode behind up to thirty delays, and a zero."""
    n = int(r.integers(6, 32))
    A, B, C = np.diag(np.ones(n - 1), -1), np.zeros((n, 1)), np.zeros((1, n))
    A[0, 0] = r.choice([0.0, 0.5, 0.9, 1 - 1e-4])
    B[0, 0], C[0, -1], C[0, -2] = 1.0, 1.0, r.choice([0.0, 0.5, -0.9])
    return siso(A, B, C, 10.0 ** r.uniform(-1.5, 1.5), period=10.0 ** -r.uniform(0, 4))


def s_integrating_chain(r):
    p = s_chain(r)
    A = np.array(p['A'])
    A[0, 0] = 1.0
    return dict(p, A=A, C=p['C'] * 10.0 ** r.uniform(-3, -0.5))


def s_fast_sampled(r):
    """A low-order loop sampled very fast: all poles beside one."""
    import scipy.linalg as sla
    n = int(r.integers(1, 5))
    A, B, h = stable(r, n), r.standard_normal((n, 1)), 10.0 ** -r.uniform(2, 5)
    E = sla.expm(h * np.block([[A, B], [np.zeros((1, n + 1))]]))
    return siso(E[:n, :n], E[:n, n:], r.standard_normal((1, n)), tens(r, -1, 3), period=h)


# --- several inputs and outputs -----------------------------------------------------------------------------------------------

def loops(r):
    """Two to four channels that couple, dense."""
    m = int(r.integers(2, 5))
    n = int(r.integers(m, 9))
    return dict(A=stable(r, n), B=r.standard_normal((n, m)), C=r.standard_normal((m, n)) * tens(r, -1, 2), D=np.zeros((m, m)))


def flexible_loops(r):
    """Two channels of a lightly damped structure, rates fed back where forces act."""
    k = int(r.integers(2, 6))
    w, z = 10.0 ** r.uniform(-1, 3, k), 10.0 ** r.uniform(-6, -1)
    Phi = r.standard_normal((k, 2))
    A = np.block([[np.zeros((k, k)), np.diag(w)], [-np.diag(w), -2 * z * np.diag(w)]])
    return dict(A=A, B=np.r_[np.zeros((k, 2)), Phi], C=np.c_[np.zeros((2, k)), Phi.T] * tens(r, -2, 2), D=np.zeros((2, 2)))


def skewed_loops(r):
    """Channels in units many decades apart."""
    p = loops(r)
    d, e = 10.0 ** r.uniform(-4, 4, len(p['C'])), 10.0 ** r.uniform(-6, 6, len(p['A']))
    return dict(p, A=p['A'] * e[:, None] / e, B=p['B'] * e[:, None] / d, C=p['C'] / e * d[:, None])


def sampled_loops(r):
    n, m = int(r.integers(2, 8)), int(r.integers(2, 4))
    A = squash(r.standard_normal((n, n))) * (1 - 10.0 ** r.uniform(-4, -0.3))
    return dict(A=A, B=r.standard_normal((n, m)), C=r.standard_normal((m, n)) * 10.0 ** r.uniform(-2, 0), D=np.zeros((m, m)), period=10.0 ** r.uniform(-4, 0))


def of_kind(kind, make, **more):
    return lambda r: dict(make(r), kind=kind, **more)


def reduced(make):
    def made(r):
        p = make(r)
        return dict(p, order=int(r.integers(1, len(p['A']) + 1)), kind='balred')
    return made


def sampling(make):
    def made(r):
        p = make(r)
        fastest = max(np.abs(np.linalg.eigvals(p['A'])).max(), 1e-3)
        return dict(p, h=float(10.0 ** r.uniform(-4, 1) / fastest), method=str(r.choice(['zoh', 'foh', 'tustin'])), kind='c2d')
    return made


SYSTEMS = dict(order=s_order, companion=s_companion, structure=s_structure, jordan=s_jordan, chain=s_chain, fast_sampled=s_fast_sampled)

FAMILIES = {
    'care': dict(nearly_lost=nearly_lost, jordan=jordan, structure=structure, any_weight=any_weight, nonminimal=nonminimal),
    'dare': dict(nearly_lost=d_nearly_lost, jordan=d_of(jordan), structure=d_of(structure, 1.0), any_weight=d_of(any_weight),
                 nonminimal=lambda r: nonminimal(r, 0.125), dead_beat=dead_beat),
    'lyap': dict(structure=l_structure, jordan=l_jordan),
    'dlyap': dict(jordan=dl_jordan, chain=dl_chain),
    'zeros': dict(SYSTEMS, nonminimal=s_nonminimal),
    'margins': dict(SYSTEMS, nonminimal=s_nonminimal, integrating_chain=s_integrating_chain),
    'linfnorm': dict(SYSTEMS, nonminimal=s_stable_nonminimal),
    'norms': dict(structure=of_kind('bounds', s_structure), jordan=of_kind('bounds', s_jordan), companion=of_kind('bounds', s_companion),
                  chain=of_kind('bounds', s_chain)),
    'mh2': dict(structure=of_kind('mh2', s_structure), jordan=of_kind('mh2', s_jordan), companion=of_kind('mh2', s_companion), chain=of_kind('mh2', s_chain)),
    'c2d': dict(structure=sampling(s_structure), jordan=sampling(s_jordan), companion=sampling(s_companion), order=sampling(lambda r: s_order(r, 6))),
    'balred': dict(structure=reduced(s_structure), jordan=reduced(s_jordan), companion=reduced(s_companion)),
    'minimal': dict(nonminimal=of_kind('minimal', s_stable_nonminimal)),
    'multiloop': dict(dense=of_kind('multiloop', loops), flexible=of_kind('multiloop', flexible_loops), skewed=of_kind('multiloop', skewed_loops),
                      sampled=of_kind('multiloop', sampled_loops)),
}
