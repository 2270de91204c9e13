"""Systems composed of parts, and equations near what they cannot solve, made from seeds: see composed.py."""
import numpy as np
import scipy.linalg as sla
import scipy.signal

from hard_families import psd, stable, tens
from stress_families import of_kind, unimodular


# --- parts and how they are joined -------------------------------------------------------------------------------------------

def servo(r):
    """A motor and its load on a flexible shaft, lightly damped, from torque to a rate or an angle: A, B, C."""
    J, J2 = 10.0 ** r.uniform(-3, 1, 2)
    k, d, friction = 10.0 ** r.uniform(1, 6), 10.0 ** r.uniform(-5, -1), 10.0 ** r.uniform(-4, -1)
    d *= np.sqrt(k * J)
    A = np.array([[-(d + friction) / J, d / J, -k / J], [d / J2, -d / J2, k / J2], [1.0, -1.0, 0.0]])
    B = np.array([[1 / J], [0.0], [0.0]])
    C = np.array([[1.0, 0, 0]]) if r.random() < 0.5 else np.array([[0, 1.0, 0]])
    return A, B, C, np.zeros((1, 1))


def lag(r):
    w = 10.0 ** r.uniform(0, 4)
    return np.array([[-w]]), np.array([[w]]), np.ones((1, 1)), np.zeros((1, 1))


def compensator(r):
    """A filter with a pole and a zero, in parallel with its direct path."""
    pole, ratio = 10.0 ** r.uniform(0, 3), 10.0 ** r.uniform(-1, 1)
    return np.array([[-pole]]), np.array([[pole * (ratio - 1)]]), np.ones((1, 1)), np.ones((1, 1))


def delay(r, order=None, seconds=None):
    """Pade's approximant of a delay, in companion form in units of the delay."""
    order, seconds = order or int(r.integers(1, 6)), seconds or 10.0 ** r.uniform(-4, -1)
    c = np.ones(order + 1)
    for j in range(1, order + 1):
        c[j] = c[j - 1] * (order - j + 1) / (j * (2 * order - j + 1))
    lead, sign = c[-1], (-1.0) ** order
    a = c[:-1] / lead
    b = (c * (-1.0) ** np.arange(order + 1) / lead)
    A = np.diag(np.ones(order - 1), 1)
    A[-1] = -a
    B, C = np.zeros((order, 1)), (b[:-1] - sign * a)[None, :]
    B[-1, 0] = 1.0
    return A / seconds, B / seconds, C, np.array([[sign]])


def series(first, second):
    """The second behind the first."""
    (A, B, C, D), (a, b, c, d) = first, second
    n, m = len(A), len(a)
    return np.block([[A, np.zeros((n, m))], [b @ C, a]]), np.r_[B, b @ D], np.c_[d @ C, c], d @ D


def parallel(first, second):
    (A, B, C, D), (a, b, c, d) = first, second
    return sla.block_diag(A, a), np.r_[B, b], np.c_[C, c], D + d


def closed(g, gain):
    """The loop of a strictly proper system under a negative gain."""
    A, B, C, D = g
    return A - gain * B @ C, B, C, D


def chain(r, most=4, lags=True):
    """Servo, lags, compensators and a delay, in any order."""
    makers = [servo, compensator, delay] + ([lag] if lags else [])
    parts = [servo(r)] + [makers[int(r.integers(len(makers)))](r) for _ in range(int(r.integers(1, most)))]
    g = parts[0]
    for part in [parts[k] for k in r.permutation(np.arange(1, len(parts)))]:
        g = series(g, part)
    return g


def stable_loop(r):
    """A chain that feedback leaves stable: a gain, halved until it is, of a chain that is stable."""
    g = chain(r)
    while np.linalg.eigvals(g[0]).real.max() >= -1e-9:
        g = chain(r)
    if np.abs(g[3]).max() == 0:
        gain = 10.0 ** r.uniform(-1, 3)
        while np.linalg.eigvals(closed(g, gain)[0]).real.max() >= -1e-12 and gain > 1e-9:
            gain /= 2
        g = closed(g, gain) if gain > 1e-9 else g
    return g


def as_system(g, gain=1.0, **more):
    A, B, C, D = g
    return dict(A=A, B=B, C=C * gain, D=D * gain, **more)


def kronecker(r):
    """I x F + G x I: sums of eigenvalues, in clusters of two or three that lie 1e-9 to 1e-2 of themselves apart."""
    p, q = int(r.integers(2, 4)), int(r.integers(1, 4))
    gap = 10.0 ** r.uniform(-9, -2)
    F = np.triu(r.integers(-2, 3, (p, p)), 1) - np.diag(r.integers(1, 3, p) * (1 + gap * r.integers(0, 3, p)))
    G = np.triu(r.integers(-2, 3, (q, q)), 1) - np.diag(r.integers(0, 3, q) * (1 + gap * r.integers(0, 3, q)))
    return np.kron(np.eye(q), F) + np.kron(G, np.eye(p))


def clustered(r):
    """A companion matrix of clusters of eigenvalues."""
    centre = -10.0 ** r.uniform(-1, 1, int(r.integers(1, 4)))
    roots = np.concatenate([c * (1 + 10.0 ** r.uniform(-6, -1) * r.standard_normal(int(r.integers(1, 4)))) for c in centre])
    a = np.poly(roots)
    A = np.diag(np.ones(len(roots) - 1), 1)
    A[-1] = -a[:0:-1]
    return A


def triangular(r):
    """Blocks on the diagonal whose sizes lie up to ten decades apart, and coupling above them of any size."""
    sizes, blocks = [], []
    for _ in range(int(r.integers(2, 4))):
        k, speed = int(r.integers(1, 4)), 10.0 ** r.uniform(-5, 5)
        blocks.append(stable(r, k) * speed)
        sizes.append((k, speed))
    A = sla.block_diag(*blocks)
    at = 0
    for k, _ in sizes:
        above = r.standard_normal((at, k)) * 10.0 ** r.uniform(-5, 5)
        A[:at, at:at + k] = above
        at += k
    return A


def rounded_zeros(r):
    """An upper triangular matrix with an eigenvalue that is repeated, and rounding errors of 2^-40 to 2^-60 below its diagonal, as a rotation leaves them."""
    n = int(r.integers(3, 7))
    A = np.triu(r.integers(-9, 10, (n, n)), 1) * float(r.choice([1, 4, 16])) - np.eye(n) * float(r.choice([1, 2, 4]))
    below = 2.0 ** -int(r.integers(40, 60)) * r.integers(-1, 2, n - 1)
    A[np.arange(1, n), np.arange(n - 1)] = below
    return A


# --- equations ----------------------------------------------------------------------------------------------------------------

def e_chain(r):
    A, B, C, _ = chain(r)
    return dict(A=A, B=B, Q=C.T @ C * tens(r, -2, 6), R=np.eye(1) * tens(r, -4, 4))


def e_kronecker(r):
    A = kronecker(r)
    n = len(A)
    return dict(A=A + r.choice([0.0, 1.0, 2.5]) * np.eye(n), B=r.integers(-2, 3, (n, 2)) + 0.5, Q=psd(r, n, n), R=np.eye(2))


def e_clustered(r):
    A = clustered(r) * r.choice([1, -1])
    n = len(A)
    return dict(A=A, B=np.eye(n)[:, [-1]], Q=psd(r, n, n), R=np.eye(1) * tens(r, -3, 3))


def e_triangular(r):
    A = triangular(r)
    n = len(A)
    A[int(r.integers(n)):, :] *= r.choice([1, -1])
    return dict(A=A, B=r.standard_normal((n, 2)), Q=psd(r, n, n), R=np.eye(2) * tens(r, -3, 3))


def e_weak_input(r):
    """Two inputs that nearly agree, and an unstable mode that only their difference reaches well."""
    n = int(r.integers(2, 6))
    A, b = r.standard_normal((n, n)), r.standard_normal((n, 1))
    return dict(A=A, B=np.c_[b, b + 10.0 ** r.uniform(-9, -2) * r.standard_normal((n, 1))], Q=psd(r, n, n), R=np.eye(2) * tens(r, -6, 2))


def e_rounded_zeros(r):
    A = rounded_zeros(r)
    n = len(A)
    return dict(A=A + r.choice([0.0, 2.0, 5.0]) * np.eye(n), B=r.integers(-2, 3, (n, 2)) + 0.5, Q=psd(r, n, n), R=np.eye(2))


def hold(A, B, h):
    n, m = B.shape
    E = sla.expm(h * np.block([[A, B], [np.zeros((m, n + m))]]))
    return E[:n, :n], E[:n, n:]


def sampled_equation(make, low=-3, high=0):
    def made(r):
        p = make(r)
        A, B = np.array(p['A']), np.array(p['B'])
        h = 10.0 ** r.uniform(low, high) / max(np.abs(np.linalg.eigvals(A)).max(), 1e-3)
        F, G = hold(A, B, h)
        return dict(p, A=F, B=G, Q=p['Q'] * h, R=p['R'] * h)
    return made


def heavy(r, n):
    """A matrix E of condition 1e2 to 1e11: rotated, of a consistent mass, or triangular."""
    way = r.random()
    if way < 0.4:
        U, V = (np.linalg.qr(r.standard_normal((n, n)))[0] for _ in 'UV')
        return U @ np.diag(np.logspace(0, -r.uniform(2, 11), n)) @ V
    if way < 0.7:
        M = np.array([[1 / (i + j + 1) for j in range(n)] for i in range(n)])
        return M
    return np.eye(n) - np.triu(np.ones((n, n)), 1) * r.uniform(0.5, 2)


def with_heavy(make):
    def made(r):
        p = make(r)
        n = len(p['A'])
        E = heavy(r, n)
        return dict(p, E=E, A=E @ p['A'])
    return made


def g_riccati(r):
    n = int(r.integers(2, 7))
    return dict(A=r.standard_normal((n, n)), B=r.standard_normal((n, 2)), Q=psd(r, n, n), R=np.eye(2))


def g_lyapunov(r):
    n = int(r.integers(2, 7))
    return dict(A=stable(r, n), Q=psd(r, n, n))


def g_stein(r):
    n = int(r.integers(2, 7))
    A = r.standard_normal((n, n))
    return dict(A=A / np.abs(np.linalg.eigvals(A)).max() * r.uniform(0.3, 0.99), Q=psd(r, n, n))


def g_sampled_riccati(r):
    n = int(r.integers(2, 7))
    return dict(A=r.standard_normal((n, n)) / np.sqrt(n), B=r.standard_normal((n, 2)), Q=psd(r, n, n), R=np.eye(2))


def l_chain(r):
    A, B, _, _ = stable_loop(r)
    return dict(A=A, Q=B @ B.T)


def l_kronecker(r):
    A = kronecker(r)
    return dict(A=A, Q=psd(r, len(A), len(A)))


def l_clustered(r):
    A = clustered(r)
    return dict(A=A, Q=psd(r, len(A), len(A)))


def l_triangular(r):
    A = triangular(r)
    return dict(A=A, Q=psd(r, len(A), len(A)))


def l_opposite(r):
    """Two eigenvalues whose sum is 1e-14 to 1e-3, by exact integers and one small number; not stable."""
    n = int(r.integers(2, 6))
    T, inverse = unimodular(r, n)
    d = r.permutation(np.arange(1, n + 1)).astype(float)
    d[-1] = -d[0] + 2.0 ** -int(r.integers(8, 45))
    return dict(A=T @ (np.diag(d) + np.triu(r.integers(-1, 2, (n, n)), 1)) @ inverse, Q=psd(r, n, n), direct=True)


def l_near_axis(r):
    """A pair of eigenvalues beside the axis, 1e-3 to 1e-13 of its rate, in integer coordinates."""
    n = int(r.integers(3, 7))
    T, inverse = unimodular(r, n)
    A = np.triu(r.integers(-2, 3, (n, n)), 1) - np.diag(r.integers(1, 4, n)).astype(float)
    w = float(r.integers(1, 5))
    A[:2, :2] = [[-2.0 ** -int(r.integers(8, 44)), w], [-w, -2.0 ** -int(r.integers(8, 44))]]
    return dict(A=T @ A @ inverse, Q=psd(r, n, n))


def l_rounded_zeros(r):
    A = rounded_zeros(r)
    b = r.integers(-3, 4, (len(A), 1)) + 0.5
    return dict(A=A, Q=b @ b.T)


def stein_of(make):
    def made(r):
        p = make(r)
        A = np.array(p['A'])
        h = 10.0 ** r.uniform(-2, 0) / np.abs(np.linalg.eigvals(A)).max()
        return dict(p, A=sla.expm(A * h))
    return made


# --- systems ------------------------------------------------------------------------------------------------------------------

def s_chain(r):
    return as_system(chain(r), tens(r, -2, 4))


def s_loop(r):
    return as_system(stable_loop(r), tens(r, -1, 2))


def s_parallel(r):
    """Two chains side by side, one weighed lightly."""
    return as_system(parallel(stable_loop(r), tuple(np.array(M) * (1 if k < 2 else 10.0 ** r.uniform(-6, 0)) for k, M in enumerate(stable_loop(r)))))


def s_triangular(r):
    A = triangular(r)
    n = len(A)
    return dict(A=A, B=r.standard_normal((n, 1)), C=r.standard_normal((1, n)) * tens(r, -2, 2), D=np.zeros((1, 1)))


def s_clustered(r):
    A = clustered(r)
    n = len(A)
    return dict(A=A, B=np.eye(n)[:, [-1]], C=r.integers(-3, 4, (1, n)) + 0.5, D=np.zeros((1, 1)))


def s_kronecker(r):
    A = kronecker(r)
    A -= max(0.0, np.ceil(np.linalg.eigvals(A).real.max() + 0.5)) * np.eye(len(A))
    n = len(A)
    return dict(A=A, B=r.integers(-2, 3, (n, 1)) + 0.5, C=r.integers(-2, 3, (1, n)) + 0.5, D=np.zeros((1, 1)))


def s_rounded_zeros(r):
    A = rounded_zeros(r)
    n = len(A)
    return dict(A=A, B=r.integers(-2, 3, (n, 1)) + 0.5, C=r.integers(-2, 3, (1, n)) + 0.5, D=np.zeros((1, 1)))


def s_crossings(r):
    """Several light modes with gains about one, so that the response crosses the circle many times."""
    k = int(r.integers(2, 5))
    w, z = np.sort(10.0 ** r.uniform(0, 3, k)), 10.0 ** r.uniform(-4, -1.5, k)
    g = None
    for wi, zi in zip(w, z):
        part = np.array([[0, 1.0], [-wi * wi, -2 * zi * wi]]), np.array([[0], [wi * wi]]), np.array([[1.0, 0]]) * 10.0 ** r.uniform(-3, 0.5) * r.choice([1, -1]), \
            np.zeros((1, 1))
        g = part if g is None else parallel(g, part)
    return as_system(series(g, delay(r)) if r.random() < 0.5 else g)


def d_crossings(r):
    p = s_crossings(r)
    while np.abs(p['D']).max() > 0:
        p = s_crossings(r)
    return dict(p, delay=10.0 ** r.uniform(-4, -1))


def d_chain(r):
    g = chain(r, lags=True)
    while np.abs(g[3]).max() > 0:
        g = chain(r)
    A, B, C, D = g
    peak = abs(C @ np.linalg.solve(1j * 3.0 * np.eye(len(A)) - A, B))[0, 0]
    return dict(A=A, B=B, C=C * tens(r, -1, 1) / max(peak, 1e-12), D=D, delay=10.0 ** r.uniform(-4, -1))


def sampled_system(make):
    """A system behind a hold, sampled 2 to 200 times a period of its fastest mode."""
    def made(r):
        p = make(r)
        A, B = np.array(p['A']), np.array(p['B'])
        h = 10.0 ** r.uniform(-1.5, 0.5) / np.abs(np.linalg.eigvals(A)).max()
        F, G = hold(A, B, h)
        return dict(p, A=F, B=G, period=h)
    return made


def z_not_square(r):
    """More outputs than inputs or the other way, with one or two common zeros, planted in integers or by a common part in series."""
    n, m = int(r.integers(2, 5)), int(r.integers(1, 3))
    p = m + int(r.integers(1, 3))
    A, B, C = (r.integers(-3, 4, shape).astype(float) for shape in ((n, n), (n, m), (p, n)))
    g = A, B, C, np.zeros((p, m))
    common = sla.block_diag(*[np.diag(-r.integers(1, 6, m).astype(float))]), np.eye(m), np.diag(r.integers(1, 4, m).astype(float)), np.eye(m)
    g = series(common, g)
    if r.random() < 0.5:
        g = g[0].T, g[2].T, g[1].T, g[3].T
    T, inverse = unimodular(r, len(g[0]))
    return dict(A=T @ g[0] @ inverse, B=T @ g[1], C=g[2] @ inverse, D=g[3], kind='mzeros')


def z_channels(r):
    """Two chains that couple through constant matrices, as many outputs as inputs."""
    a, b = chain(r, 3), chain(r, 3)
    A, B, C, D = (sla.block_diag(x, y) for x, y in zip(a, b))
    return dict(A=A, B=B @ np.array([[1.0, 0.5], [-0.25, 1.0]]), C=np.array([[1.0, -0.5], [0.25, 2.0]]) @ C, D=D * 0, kind='mzeros')


def loops(r):
    """Two or three closed servo loops that couple."""
    m = int(r.integers(2, 4))
    while True:
        parts = [chain(r, 2) for _ in range(m)]
        if all(np.abs(g[3]).max() == 0 for g in parts):
            break
    A, B, C = (sla.block_diag(*(g[k] for g in parts)) for k in range(3))
    mix = np.eye(m) + 10.0 ** r.uniform(-3, -0.3) * r.standard_normal((m, m))
    gain = 10.0 ** r.uniform(0, 3)
    for _ in range(60):
        if np.linalg.eigvals(A - gain * B @ mix @ C).real.max() < 0:
            break
        gain /= 2
    return dict(A=A, B=gain * B @ mix, C=C, D=np.zeros((m, m)), kind='multiloop')


def b_nearly_minimal(r):
    """States that input or output hardly touch: 1e-3 to 1e-9 of the others, in rotated integers."""
    n, k = int(r.integers(2, 5)), int(r.integers(1, 3))
    A = np.triu(r.integers(-2, 3, (n + k, n + k)), 1) - np.diag(r.integers(1, 6, n + k)).astype(float)
    A[n:, :n], A[:n, n:] = 0, 0
    B, C = r.integers(-2, 3, (n + k, 1)) + 0.5, r.integers(-2, 3, (1, n + k)) + 0.5
    B[n:] *= 2.0 ** -int(r.integers(10, 31))
    C[:, n:] *= 2.0 ** -int(r.integers(0, 20))
    T, inverse = unimodular(r, n + k)
    return dict(A=T @ A @ inverse, B=T @ B, C=C @ inverse, D=np.zeros((1, 1)))


def reduced(make):
    return lambda r: (lambda p: dict(p, order=int(r.integers(1, len(p['A']) + 1)), kind='balred'))(make(r))


def minimal(r):
    """A loop whose compensator cancels poles of the plant exactly, in integer coordinates: the order is that of the rest."""
    n = int(r.integers(2, 5))
    A = np.triu(r.integers(-2, 3, (n, n)), 1) - np.diag(r.integers(1, 6, n)).astype(float)
    plant = A, r.integers(1, 4, (n, 1)).astype(float), r.integers(1, 4, (1, n)).astype(float), np.zeros((1, 1))
    pole = -A[0, 0]
    cancel = np.array([[-pole - 2.0]]), np.ones((1, 1)), np.array([[-2.0]]), np.ones((1, 1))  # (s + pole) / (s + pole + 2)
    A, B, C, D = series(plant, cancel)
    A = A - B @ C * r.integers(0, 2)
    A = A - max(0.0, np.ceil(np.linalg.eigvals(A).real.max() + 1)) * np.eye(len(A))
    T, inverse = unimodular(r, len(A))
    return dict(A=T @ A @ inverse, B=T @ B, C=C @ inverse, D=D, kind='minimal')


# --- sampling -------------------------------------------------------------------------------------------------------------------

def stiff_plant(r):
    """A servo with modes to a thousand times its rate, behind lags."""
    g = chain(r, 3)
    k = int(r.integers(1, 4))
    w, z = 10.0 ** r.uniform(1, 5, k), 10.0 ** r.uniform(-6, -1, k)
    for wi, zi in zip(w, z):
        g = parallel(g, (np.array([[0, wi], [-wi, -2 * zi * wi]]), np.array([[0], [1.0]]), np.array([[1.0, 0]]) * 10.0 ** r.uniform(-4, 0), np.zeros((1, 1))))
    return as_system(g)


def sampling(make, methods=('zoh', 'foh', 'tustin'), kind='c2d', low=-4, high=1.5):
    def made(r):
        p = make(r)
        h = float(10.0 ** r.uniform(low, high) / max(np.abs(np.linalg.eigvals(p['A'])).max(), 1e-3))
        p = dict(p, h=h, method=str(r.choice(methods)), kind=kind)
        return dict(p, delay=h * float(r.uniform(0, 3)), method='zoh') if kind == 'c2d_delayed' else p
    return made


def bilinear(make):
    """A system that Tustin's method has sampled."""
    def made(r):
        p = make(r)
        h = float(10.0 ** r.uniform(-2, 1) / np.abs(np.linalg.eigvals(p['A'])).max())
        A, B, C, D, _ = scipy.signal.cont2discrete(tuple(np.array(p[k]) for k in 'ABCD'), h, 'bilinear')
        return dict(A=A, B=B, C=C, D=D, period=h, kind='d2c')
    return made


def costs(make):
    """A plant and a quadratic cost over a period."""
    def made(r):
        p = make(r)
        n = len(p['A'])
        h = float(10.0 ** r.uniform(-3, 0.5) / max(np.abs(np.linalg.eigvals(p['A'])).max(), 1e-3))
        C = np.array(p['C'])
        return dict(A=p['A'], B=p['B'], Q=C.T @ C, R=np.eye(p['B'].shape[1]) * tens(r, -4, 2), S=C.T @ np.ones((1, p['B'].shape[1])) * 0.1, h=h, kind='cost')
    return made


# --- placement ------------------------------------------------------------------------------------------------------------------

def wanted(r, n, speed=1.0, repeated=1):
    poles = []
    while len(poles) < n:
        re, im = -speed * 10.0 ** r.uniform(-0.5, 0.5), speed * 10.0 ** r.uniform(-1, 0.5)
        left = n - len(poles)
        if left >= 2 and r.random() < 0.5:
            times = repeated if left >= 2 * repeated else 1
            poles += [[re, im], [re, -im]] * times
        else:
            poles += [[re, 0.0]] * min(repeated, left)
    return poles


def place_weak(r):
    """A mode that the inputs reach by 1e-2 to 1e-7 only."""
    n, m = int(r.integers(2, 7)), int(r.integers(1, 4))
    A, B = stable(r, n), r.standard_normal((n, m))
    A[-1, :-1] = 0
    B[-1] *= 10.0 ** r.uniform(-7, -2)
    U = np.linalg.qr(r.standard_normal((n, n)))[0]
    return dict(A=U @ A @ U.T, B=U @ B, poles=wanted(r, n), kind='place')


def place_repeated(r):
    """Poles wanted as often as there are inputs; inputs that repeat each other in part."""
    n, m = int(r.integers(3, 9)), int(r.integers(2, 4))
    B = r.standard_normal((n, m))
    B = np.c_[B, B[:, [0]]] if r.random() < 0.5 else B
    return dict(A=r.standard_normal((n, n)), B=B, poles=wanted(r, n, repeated=m), kind='place')


def place_chain(r):
    """A chain of parts with units over decades, poles of its own speed."""
    A, B, C, _ = chain(r, 3)
    speed = np.abs(np.linalg.eigvals(A))
    speed = np.exp(np.log(speed[speed > 1e-6]).mean())
    return dict(A=A, B=B, poles=wanted(r, len(A), speed), kind='place')


def place_units(r):
    n, m = int(r.integers(2, 7)), int(r.integers(1, 4))
    d, e = 10.0 ** r.uniform(-4, 4, n), 10.0 ** r.uniform(-5, 5, m)
    return dict(A=r.standard_normal((n, n)) * d[:, None] / d, B=r.standard_normal((n, m)) * d[:, None] * e, poles=wanted(r, n), kind='place')


# --- synthesis ------------------------------------------------------------------------------------------------------------------

def plant(A, B1, B2, C1, C2):
    """A plant of the simple form: D12 = [0; I], D21 = [0, I], C1 and B1 without what these see."""
    n, (m1, m2), (p1, p2) = len(A), (B1.shape[1], B2.shape[1]), (len(C1), len(C2))
    D = np.zeros((p1 + m2 + p2, m1 + p2 + m2))
    D[p1:p1 + m2, m1 + p2:] = np.eye(m2)
    D[p1 + m2:, m1:m1 + p2] = np.eye(p2)
    return dict(A=A, B=np.c_[B1, np.zeros((n, p2)), B2], C=np.r_[C1, np.zeros((m2, n)), C2], D=D, controls=m2, measurements=p2,
                parts=dict(A=A.tolist(), B1=B1.tolist(), B2=B2.tolist(), C1=C1.tolist(), C2=C2.tolist()), kind='level')


def h_dense(r):
    n, g = int(r.integers(1, 7)), r.standard_normal
    return plant(g((n, n)), g((n, 2)), g((n, int(r.integers(1, 3)))), g((2, n)), g((int(r.integers(1, 3)), n)))


def h_chain(r):
    A, B, C, _ = chain(r, 2)
    return plant(A, B * tens(r, -2, 1), B, C * tens(r, -2, 1), C)


def h_modes(r):
    k = int(r.integers(1, 4))
    w, z = 10.0 ** r.uniform(-1, 2, k), 10.0 ** r.uniform(-4, -1)
    A = np.block([[np.zeros((k, k)), np.diag(w)], [-np.diag(w), -2 * z * np.diag(w)]])
    g = lambda a, b: np.r_[np.zeros((k, b)), r.standard_normal((k, b))]
    return plant(A, g(k, 1), g(k, 1), g(k, 1).T, g(k, 1).T)


def h_graded(r):
    p = h_dense(r)
    A, B1, B2, C1, C2 = (np.array(p['parts'][k]) for k in ('A', 'B1', 'B2', 'C1', 'C2'))
    d = 10.0 ** r.uniform(-4, 4, len(A))
    return plant(A * d[:, None] / d, B1 * d[:, None], B2 * d[:, None], C1 / d, C2 / d)


SYSTEMS = dict(chain=s_chain, loop=s_loop, triangular=s_triangular, clustered=s_clustered, kronecker=s_kronecker, rounded_zeros=s_rounded_zeros)
STABLE = dict(loop=s_loop, parallel=s_parallel, triangular=s_triangular, clustered=s_clustered, kronecker=s_kronecker, rounded_zeros=s_rounded_zeros)

FAMILIES = {
    'care': dict(chain=e_chain, kronecker=e_kronecker, clustered=e_clustered, triangular=e_triangular, weak_input=e_weak_input,
                 rounded_zeros=e_rounded_zeros),
    'dare': dict(chain=sampled_equation(e_chain), kronecker=sampled_equation(e_kronecker), triangular=sampled_equation(e_triangular),
                 weak_input=sampled_equation(e_weak_input)),
    'gcare': dict(heavy=with_heavy(g_riccati), chain=with_heavy(e_chain)),
    'gdare': dict(heavy=with_heavy(g_sampled_riccati)),
    'glyap': dict(heavy=with_heavy(g_lyapunov)),
    'gdlyap': dict(heavy=with_heavy(g_stein)),
    'lyap': dict(chain=l_chain, kronecker=l_kronecker, clustered=l_clustered, triangular=l_triangular, opposite=l_opposite, near_axis=l_near_axis,
                 rounded_zeros=l_rounded_zeros),
    'dlyap': dict(chain=stein_of(l_chain), kronecker=stein_of(l_kronecker), triangular=stein_of(l_triangular), near_axis=stein_of(l_near_axis),
                  rounded_zeros=lambda r: (lambda p: dict(p, A=p['A'] / 8))(l_rounded_zeros(r))),
    'zeros': dict(SYSTEMS, parallel=s_parallel, not_square=z_not_square, channels=z_channels),
    'margins': dict(SYSTEMS, parallel=s_parallel, crossings=s_crossings, sampled=sampled_system(s_crossings), sampled_chain=sampled_system(s_chain)),
    'delayed': dict(crossings=of_kind('delayed', d_crossings), chain=of_kind('delayed', d_chain)),
    'multiloop': dict(servos=loops),
    'linfnorm': dict(STABLE, sampled=sampled_system(s_loop)),
    'norms': {name: of_kind('bounds', make) for name, make in STABLE.items()},
    'mh2': {name: of_kind('mh2', lambda r, make=make: (lambda p: dict(p, D=np.array(p['D']) * 0))(make(r))) for name, make in STABLE.items()},
    'c2d': dict(stiff=sampling(stiff_plant), chain=sampling(s_chain), triangular=sampling(s_triangular), clustered=sampling(s_clustered),
                rounded_zeros=sampling(s_rounded_zeros),
                delayed=sampling(stiff_plant, kind='c2d_delayed'), delayed_chain=sampling(s_chain, kind='c2d_delayed')),
    'd2c': dict(stiff=bilinear(stiff_plant), loop=bilinear(s_loop)),
    'cost': dict(stiff=costs(stiff_plant), loop=costs(s_loop), triangular=costs(s_triangular)),
    'balred': dict(loop=reduced(s_loop), parallel=reduced(s_parallel), nearly_minimal=reduced(b_nearly_minimal), clustered=reduced(s_clustered), rounded_zeros=reduced(s_rounded_zeros)),
    'minimal': dict(cancelled=minimal),
    'place': dict(weak=place_weak, repeated=place_repeated, chain=place_chain, units=place_units),
    'level': dict(dense=h_dense, chain=h_chain, modes=h_modes, graded=h_graded),
}
