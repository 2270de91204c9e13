"""Problems made from seeds: see hard.py."""
import numpy as np

KINDS = ['care', 'dare', 'gcare', 'gdare', 'lyap', 'dlyap', 'glyap', 'margins', 'zeros', 'linfnorm', 'h2norm', 'descriptor']


def rng(kind, family, seed):
    return np.random.default_rng([seed, sum(map(ord, kind)), sum(map(ord, family))])


def problems(kind, seed):
    """One problem of each family of the kind."""
    for family, make in FAMILIES[kind].items():
        problem = make(rng(kind, family, seed))
        if problem is None:
            continue
        problem = {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in problem.items()}
        yield dict(problem, kind=problem.get('kind', kind), family=family, seed=seed)


def tens(r, low, high):
    return 10.0 ** r.integers(low, high + 1)


def size(r, most=6):
    return int(r.integers(1, most + 1))


def psd(r, n, rank=None):
    C = r.standard_normal((rank or max(1, n // 2), n))
    return C.T @ C


# --- Riccati equations -------------------------------------------------------------------------------------------------

def weighted(r, A, B, discrete=False):
    n, m = B.shape
    return dict(A=A, B=B, Q=psd(r, n), R=np.eye(m))


def benign(r):
    n = size(r)
    return weighted(r, r.standard_normal((n, n)), r.standard_normal((n, 1 + n // 3)))


def graded(r):
    """Units of the states spread over twelve decades."""
    n = size(r)
    d = 10.0 ** r.uniform(-6, 6, n)
    A, B, C = r.standard_normal((n, n)), r.standard_normal((n, 1)), r.standard_normal((1, n))
    A, B, C = A * d[:, None] / d, B * d[:, None], C / d
    return dict(A=A, B=B, Q=C.T @ C, R=np.eye(1))


def powers(r):
    """Every entry a power of ten or zero."""
    n = size(r, 4)
    entry = lambda *shape: np.where(r.random(shape) < 0.6, 10.0 ** r.integers(-6, 7, shape) * r.choice([-1, 1], shape), 0.0)
    A, B = entry(n, n), entry(n, 1)
    B[r.integers(n), 0] = tens(r, -3, 3)
    return dict(A=A, B=B, Q=np.diag(np.abs(entry(n)) + tens(r, -6, 3)), R=np.array([[tens(r, -8, 4)]]))


def near_boundary(r):
    n = size(r, 4)
    slow = -tens(r, -12, -2) * r.choice([1, -1], n)
    A = np.diag(slow)
    A[0, 0] = r.choice([1.0, -1.0])
    A += np.triu(r.integers(0, 2, (n, n)), 1)
    return dict(A=A, B=np.ones((n, 1)), Q=np.diag(np.r_[1.0, r.integers(0, 2, n - 1)]), R=np.eye(1) * tens(r, -4, 4))


def defective(r):
    n = size(r, 5)
    a = r.choice([1000.0, 1.0, 0.0, -1.0, 1e-3])
    A = a * np.eye(n) + np.diag(np.full(n - 1, tens(r, -2, 2)), -1)
    B, Q = np.zeros((n, 1)), np.zeros((n, n))
    B[0, 0], Q[-1, -1] = tens(r, -2, 2), tens(r, -5, 2)
    return dict(A=A, B=B, Q=Q, R=np.eye(1) * tens(r, -2, 2))


def rigid(r):
    """A free mechanism with flexible modes in physical coordinates."""
    k = int(r.integers(2, 4))
    m = 10.0 ** r.uniform(-2, 2, k)
    K = np.zeros((k, k))
    for i in range(k - 1):
        c = 10.0 ** r.uniform(1, 6)
        K[i:i + 2, i:i + 2] += c * np.array([[1, -1], [-1, 1]])
    damping = r.choice([0.0, 1e-4])
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-K / m[:, None], -damping * K / m[:, None]]])
    B = np.zeros((2 * k, 1))
    B[k, 0] = 1 / m[0]
    Q = np.zeros((2 * k, 2 * k))
    Q[k - 1, k - 1] = tens(r, 0, 8)
    return dict(A=A, B=B, Q=Q, R=np.eye(1))


def small_weight(r):
    n = size(r, 4)
    p = weighted(r, r.standard_normal((n, n)), r.standard_normal((n, 1)))
    return dict(p, R=np.array([[tens(r, -18, -6)]]))


def unstable(r):
    n = size(r)
    A = r.standard_normal((n, n)) + 2 * np.sqrt(n) * np.eye(n)
    return weighted(r, A, r.standard_normal((n, 2)))


def lost(r):
    """A mode that is not stable and that the input does not reach, in exact integer coordinates."""
    n = int(r.integers(2, 5))
    T = np.eye(n) + np.tril(r.integers(-2, 3, (n, n)), -1)
    U = np.eye(n) - np.tril(np.zeros((n, n)))
    inverse = np.round(np.linalg.inv(T))
    A0 = np.triu(r.integers(-3, 4, (n, n))).astype(float)
    A0[-1, -1] = r.integers(0, 3)
    B0 = r.integers(-2, 3, (n, 1)).astype(float)
    B0[-1, 0] = 0.0
    return dict(A=T @ A0 @ inverse, B=T @ B0, Q=np.eye(n), R=np.eye(1), exists=False)


def reflected(e):
    V = np.eye(3) - 2 / 3 * np.ones((3, 3))
    sym = lambda M: (M + M.T) / 2
    return sym(V @ np.diag([e, 2 * e, 3 * e]) @ V), sym(V @ np.diag([1 / e, 1, e]) @ V)


def carex_25(r):
    e = tens(r, -7, 0)
    Q = np.array([[4 * e - 11, 2 * e - 5], [2 * e - 5, 2 * e - 2]])
    return dict(A=np.array([[3 - e, 1.0], [4, 2 - e]]), B=np.ones((2, 1)), Q=Q, R=np.eye(1))


def carex_26(r):
    e = tens(r, 0, 12) * r.integers(1, 10)
    A, Q = reflected(e)
    return dict(A=A, G=np.eye(3) / e, Q=Q, kind='care_g')


def carex_4x(r):
    n = int(r.integers(2, 9))
    A = np.diag(np.ones(n - 1), 1)
    B, Q = np.zeros((n, 1)), np.zeros((n, n))
    B[-1, 0], Q[0, 0] = 1, tens(r, -6, 6)
    return dict(A=A, B=B, Q=Q, R=np.eye(1) * tens(r, -6, 6))


def carex_21(r):
    e = tens(r, -12, 0)
    return dict(A=np.diag([1.0, -2]), B=np.array([[e], [0]]), Q=np.ones((2, 2)), R=np.eye(1))


def carex_22(r):
    e, c = tens(r, -13, 0), np.array([[10.0, 100]])
    return dict(A=np.diag([-0.1, -0.02]), B=np.array([[0.1, 0], [0.001, 0.01]]), Q=c.T @ c, R=np.array([[1 + e, 1], [1, 1]]))


def carex_23(r):
    e = tens(r, -12, 12)
    return dict(A=np.array([[0, e], [0, 0]]), B=np.array([[0], [1.0]]), Q=np.eye(2), R=np.eye(1))


def carex_24(r):
    e = tens(r, -12, 3)
    return dict(A=np.array([[e + 1, 1], [1, e + 1]]), B=e * np.eye(2), Q=e * e * np.eye(2), R=np.eye(2))


def carex_27(r):
    """A slow and a fast part: a motor with its amplifier."""
    e = tens(r, -12, 0)
    A = np.array([[0, 0.4, 0, 0], [0, 0, 0.345, 0], [0, -0.524 / e, -0.465 / e, 0.262 / e], [0, 0, 0, -1 / e]])
    return dict(A=A, B=np.array([[0], [0], [0], [1 / e]]), Q=np.diag([1.0, 0, 1, 0]), R=np.eye(1))


def carex_28(r):
    e, b = tens(r, -12, 0), np.ones((4, 1))
    A = np.array([[-e, 1, 0, 0], [-1, -e, 0, 0], [0, 0, e, 1], [0, 0, -1, e]])
    return dict(A=A, B=b, Q=b @ b.T, R=np.eye(1))


def darex_21(r):
    return dict(A=np.array([[4, 3], [-4.5, -3.5]]), B=np.array([[1.0], [-1]]), Q=np.array([[9.0, 6], [6, 4]]), R=np.eye(1) * tens(r, -12, 12))


def darex_22(r):
    d = tens(r, -9, 9)
    return dict(A=np.diag([0.9512, 0.9048]), B=np.array([[4.877, 4.877], [-1.1895, 3.569]]), Q=np.diag([0.005, 0.02]), R=np.diag([1 / (3 * d), 3 * d]))


def darex_23(r):
    return carex_23(r)


def darex_24(r):
    e = tens(r, -6, 12)
    V = np.eye(3) - 2 / 3 * np.ones((3, 3))
    sym = lambda M: (M + M.T) / 2
    # G = I / e as B R^-1 B' with R = e I.
    return dict(A=e * sym(V @ np.diag([0.0, 1, 3]) @ V), B=np.eye(3), Q=e * np.eye(3), R=e * np.eye(3))


def half_unstable(r):
    """Dense, half of the modes not stable, few inputs: larger than the others."""
    n = int(r.integers(8, 17))
    return weighted(r, r.standard_normal((n, n)), r.standard_normal((n, 2)))


def squash(A):
    """Eigenvalues moved near the unit circle."""
    return A / max(1e-3, np.abs(np.linalg.eigvals(A)).max())


def d_benign(r):
    p = benign(r)
    return dict(p, A=squash(p['A']) * r.uniform(0.2, 2))


def d_graded(r):
    p = graded(r)
    return dict(p, A=squash(p['A']) * r.uniform(0.2, 2))


def d_powers(r):
    p = powers(r)
    return dict(p, R=p['R'] * r.choice([1.0, 1.0, 0.0]))


def d_slow(r):
    """A delay line behind a slow lag (the paper machine)."""
    n = int(r.integers(2, 6))
    e = tens(r, -12, -2)
    A = np.diag(np.ones(n - 1), -1)
    A[0, 0] = 1 - e
    B, Q = np.zeros((n, 1)), np.zeros((n, n))
    B[0, 0], Q[-1, -1] = e, 1.0
    return dict(A=A, B=B, Q=Q, R=np.eye(1) * tens(r, -3, 2) / 4)


def d_no_weight(r):
    n = int(r.integers(1, 5))
    A, B = r.integers(-3, 4, (n, n)).astype(float), r.integers(-2, 3, (n, 1)).astype(float)
    return dict(A=A, B=B, Q=np.eye(n), R=np.zeros((1, 1)), may_lack=True)


def d_defective(r):
    p = defective(r)
    A = np.array(p['A'])
    return dict(p, A=A / max(1.0, np.abs(A).max()))


def d_rigid(r):
    import scipy.linalg as sla
    p = rigid(r)
    n, h = len(p['A']), 10.0 ** r.uniform(-4, -2)
    E = sla.expm(h * np.block([[p['A'], p['B']], [np.zeros((1, n + 1))]]))
    return dict(p, A=E[:n, :n], B=E[:n, n:])


def with_mass(make, spread):
    """E x' = ...: a random mass matrix, well conditioned or with masses over many decades, before the derivatives of a family."""
    def made(r):
        p = make(r)
        A = np.array(p['A'])
        n = len(A)
        E = np.eye(n) + 0.3 * r.standard_normal((n, n)) / np.sqrt(n)
        E = E * 10.0 ** r.uniform(-spread, spread, n)[:, None]
        return dict(p, A=E @ A, E=E, B=E @ p['B'] if 'B' in p else None)
    return made


# --- Lyapunov equations ------------------------------------------------------------------------------------------------

def stable(r, n):
    A = r.standard_normal((n, n))
    return A - (np.linalg.eigvals(A).real.max() + 10.0 ** r.uniform(-3, 0)) * np.eye(n)


def l_benign(r):
    n = size(r, 8)
    return dict(A=stable(r, n), Q=psd(r, n))


def l_graded(r):
    n = size(r, 6)
    d = 10.0 ** r.uniform(-6, 6, n)
    return dict(A=stable(r, n) * d[:, None] / d, Q=psd(r, n) * np.outer(d, d))


def l_modes(r):
    """Slow modes beside fast ones."""
    n = size(r, 5)
    return dict(A=np.diag(-10.0 ** r.integers(-6, 7, n)) + np.triu(r.integers(-2, 3, (n, n)), 1), Q=np.eye(n))


def l_singular(r):
    """An integrator, or a pair that sums to zero, in integer coordinates."""
    n = int(r.integers(2, 5))
    T = np.eye(n) + np.tril(r.integers(-2, 3, (n, n)), -1)
    U = np.eye(n) + np.triu(r.integers(-1, 2, (n, n)), 1)
    T = T @ U
    inverse = np.round(np.linalg.inv(T))
    A0 = np.diag(-r.integers(1, 5, n)).astype(float) + np.triu(r.integers(-2, 3, (n, n)), 1)
    A0[0, 0] = 0.0 if r.random() < 0.6 else -A0[1, 1]
    return dict(A=T @ A0 @ inverse, Q=np.eye(n), exists=False)


def l_damped(r):
    """Lightly damped, unscaled."""
    k = size(r, 4)
    w = np.sort(10.0 ** r.uniform(0, 4, k))
    z = tens(r, -8, -2)
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-np.diag(w ** 2), -np.diag(2 * z * w)]])
    return dict(A=A, Q=np.diag(np.r_[np.zeros(k), np.ones(k)]))


def cayley(A):
    n = len(A)
    return np.linalg.solve(np.eye(n) - A, np.eye(n) + A)


def l_discrete(make):
    def made(r):
        p = make(r)
        A = np.array(p['A'])
        return dict(p, A=cayley(A / max(np.abs(np.linalg.eigvals(A)).max(), 1e-300)))
    return made


def dl_singular(r):
    n = int(r.integers(2, 5))
    T = np.eye(n) + np.tril(r.integers(-2, 3, (n, n)), -1)
    inverse = np.round(np.linalg.inv(T))
    A0 = np.diag(np.full(n, 0.5)) + np.triu(r.integers(-2, 3, (n, n)), 1)
    if r.random() < 0.5:
        A0[0, 0] = r.choice([1.0, -1.0])
    else:
        A0[:2, :2] = [[0, 1], [-1, r.integers(-1, 2)]]
    return dict(A=T @ A0 @ inverse, Q=np.eye(n), exists=False)


# --- systems with one input and one output ---------------------------------------------------------------------------------

def cascade(poles, zeros, gain):
    """Sections in series, x_i' = p_i x_i + y_(i-1); what is not there is exactly zero. Real poles and zeros."""
    n = len(poles)
    A, B, C, D = np.zeros((n, n)), np.zeros((n, 1)), np.zeros((1, n)), np.array([[1.0]])
    for i, p in enumerate(poles):
        A[i], B[i], A[i, i] = C[0], D[0], p
        if i < len(zeros):
            C[0, i] = p - zeros[i]  # (s - z)/(s - p) = 1 + (p - z)/(s - p)
        else:
            C, D = np.eye(n)[[i]], np.zeros((1, 1))
    return dict(A=A, B=B, C=gain * C, D=gain * D)


def modal(r, k, damping, rigid=0):
    """A sum of modes with collocated signs or any; rigid-body modes first."""
    n = 2 * k
    w = np.sort(10.0 ** r.uniform(0, 4, k))
    w[:rigid] = 0
    A, B, C = np.zeros((n, n)), np.zeros((n, 1)), np.zeros((1, n))
    for i in range(k):
        A[2 * i:2 * i + 2, 2 * i:2 * i + 2] = [[0, 1], [-w[i] ** 2, -2 * damping * w[i]]]
        B[2 * i + 1, 0] = 1.0
        C[0, 2 * i] = 10.0 ** r.uniform(-1, 1) * (1 if r.random() < 0.7 else -1)
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)))


def s_spread(r):
    """Real roots over twelve decades."""
    n = int(r.integers(2, 7))
    m = int(r.integers(1, n + 1))
    return cascade(-10.0 ** r.integers(-6, 7, n), -10.0 ** r.integers(-6, 7, m) * r.choice([1, -1, 2], m), tens(r, -3, 3))


def s_multiple(r):
    n, k = int(r.integers(2, 5)), int(r.integers(1, 3))
    poles = np.r_[np.full(n, -tens(r, -2, 1)), -tens(r, 1, 3)]
    return cascade(poles, -tens(r, 0, 4) * np.arange(1, k + 1), 1.0)


def s_flexible(r):
    return modal(r, int(r.integers(1, 5)), tens(r, -6, -2))


def s_rigid(r):
    return modal(r, int(r.integers(2, 5)), tens(r, -4, -2), rigid=1)


def s_dense(r):
    n = size(r, 6)
    return dict(A=stable(r, n), B=r.standard_normal((n, 1)), C=r.standard_normal((1, n)), D=np.zeros((1, 1)))


def s_graded(r):
    p, d = s_dense(r), None
    n = len(p['A'])
    d = 2.0 ** r.integers(-20, 21, n)
    return dict(p, A=p['A'] * d[:, None] / d, B=p['B'] * d[:, None], C=p['C'] / d)


def loop(make):
    """A loop whose gain is far from one at its roots, either way."""
    def made(r):
        p = make(r)
        factor = tens(r, -8, 8)
        return dict(p, C=p['C'] * factor, D=p['D'] * factor)
    return made


def m_integrators(r):
    n = int(r.integers(1, 4))
    return cascade(np.r_[np.zeros(int(r.integers(1, 3))), -10.0 ** r.integers(-2, 3, n - 1)], [], tens(r, -9, 9))


def m_delayed(r):
    """An integrator with whole samples of delay, sampled fast."""
    d = int(r.integers(1, 4))
    n = d + 1
    A, B, C = np.diag(np.ones(d), -1), np.zeros((n, 1)), np.zeros((1, n))
    A[0, 0], B[0, 0], C[0, -1] = 1.0, r.choice([0.01, 0.1, 0.2, 0.3]), 1.0
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)), period=10.0 ** -int(r.integers(0, 5)))


def e_reduced(r):
    """The error of a truncation: two systems that nearly cancel."""
    p = s_dense(r)
    n = len(p['A'])
    k = max(1, n // 2)
    small = tens(r, -8, -3)
    A = np.block([[p['A'], np.zeros((n, n))], [np.zeros((n, n)), p['A'] * (1 + small)]])
    return dict(A=A, B=np.r_[p['B'], p['B']], C=np.c_[p['C'], -p['C'] * (1 + small)], D=p['D'])


# --- descriptor systems ------------------------------------------------------------------------------------------------------

def g_index(r):
    """A chain of constraints of index one to three, rotated, and a proper part."""
    n, index = int(r.integers(1, 4)), int(r.integers(1, 4))
    N = np.diag(np.ones(index - 1), 1) if index > 1 else np.zeros((1, 1))
    E = np.block([[np.eye(n), np.zeros((n, index))], [np.zeros((index, n)), N]])
    A = np.block([[stable(r, n), np.zeros((n, index))], [np.zeros((index, n)), np.eye(index)]])
    B, C = r.standard_normal((n + index, 1)), r.standard_normal((1, n + index))
    return dict(E=E, A=A, B=B, C=C, D=np.zeros((1, 1)))


def g_rotated(r):
    p = g_index(r)
    n = len(p['E'])
    U, V = (np.linalg.qr(r.standard_normal((n, n)))[0] for _ in 'UV')
    return dict(p, E=U @ p['E'] @ V, A=U @ p['A'] @ V, B=U @ p['B'], C=p['C'] @ V, rotated=True, plain=[p[k].tolist() for k in 'EABCD'])


def g_scaled(r):
    p = g_index(r)
    n = len(p['E'])
    d, e = 10.0 ** r.uniform(-5, 5, n), 10.0 ** r.uniform(-5, 5, n)
    scaled = lambda M: M * d[:, None] * e
    return dict(p, E=scaled(p['E']), A=scaled(p['A']), B=p['B'] * d[:, None], C=p['C'] * e)


FAMILIES = {
    'care': dict(benign=benign, graded=graded, powers=powers, near_boundary=near_boundary, defective=defective, rigid=rigid,
                 small_weight=small_weight, unstable=unstable, lost=lost, carex_25=carex_25, carex_26=carex_26, carex_4x=carex_4x,
                 carex_21=carex_21, carex_22=carex_22, carex_23=carex_23, carex_24=carex_24, carex_27=carex_27, carex_28=carex_28,
                 half_unstable=half_unstable),
    'dare': dict(benign=d_benign, graded=d_graded, powers=d_powers, slow=d_slow, no_weight=d_no_weight, defective=d_defective,
                 rigid=d_rigid, small_weight=small_weight, darex_21=darex_21, darex_22=darex_22, darex_23=darex_23, darex_24=darex_24),
    'gcare': dict(benign=with_mass(benign, 0), masses=with_mass(benign, 4), rigid=with_mass(rigid, 1)),
    'gdare': dict(benign=with_mass(d_benign, 0), masses=with_mass(d_benign, 4)),
    'glyap': dict(benign=with_mass(l_benign, 0), masses=with_mass(l_benign, 4)),
    'lyap': dict(benign=l_benign, graded=l_graded, modes=l_modes, singular=l_singular, damped=l_damped),
    'dlyap': dict(benign=l_discrete(l_benign), modes=l_discrete(l_modes), singular=dl_singular, damped=l_discrete(l_damped)),
    'zeros': dict(spread=s_spread, multiple=s_multiple, flexible=s_flexible, rigid=s_rigid, dense=s_dense, graded=s_graded),
    'margins': dict(spread=loop(s_spread), integrators=m_integrators, delayed=m_delayed, flexible=loop(s_flexible), rigid=loop(s_rigid), dense=loop(s_dense)),
    'linfnorm': dict(spread=s_spread, flexible=s_flexible, dense=s_dense, graded=s_graded, error=e_reduced),
    'h2norm': dict(dense=s_dense, flexible=s_flexible, graded=s_graded),
    'descriptor': dict(index=g_index, rotated=g_rotated, scaled=g_scaled),
}
