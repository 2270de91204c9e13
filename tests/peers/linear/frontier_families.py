"""Long chains, peaks that nearly touch, poles beside plus and minus one, free bodies and nearly singular matrices E, made from seeds: see frontier.py."""
import numpy as np
import scipy.linalg as sla

from composed_families import parallel, sampling, series
from hard_families import tens
from stress_families import of_kind, unimodular


# --- chains ------------------------------------------------------------------------------------------------------------------

def lags(r):
    """Eight to forty lags in series, of equal rates or over some decades, with one input and one output."""
    n = int(r.integers(8, 41))
    w = np.ones(n) * tens(r, -3, 3) if r.random() < 0.5 else 10.0 ** r.uniform(-1.5, 1.5, n)
    A = np.diag(-w) + np.diag(w[1:], -1)
    B, C = np.zeros((n, 1)), np.zeros((1, n))
    B[0], C[0, -1] = w[0], 1.0
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)))


def rod(r):
    """Masses and springs in a row, in physical units: force at one end, position at the other."""
    k = int(r.integers(5, 17))
    m, c, d = 10.0 ** r.uniform(-2, 2), 10.0 ** r.uniform(2, 6), 10.0 ** r.uniform(-5, -1)
    K = c * (2 * np.eye(k) - np.diag(np.ones(k - 1), 1) - np.diag(np.ones(k - 1), -1))
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-K / m, -d / np.sqrt(c * m) * K]])
    B, C = np.zeros((2 * k, 1)), np.zeros((1, 2 * k))
    B[k], C[0, k - 1] = 1 / m, 1.0
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)))


def ladder(r):
    """States that hand on over one to six decades a step, forward and a little back."""
    n = int(r.integers(6, 20))
    forward, back = 10.0 ** r.uniform(-4, 2, n - 1), 10.0 ** r.uniform(-12, -2, n - 1)
    A = np.diag(forward, -1) + np.diag(back, 1) - np.diag(10.0 ** r.uniform(-2, 1, n))
    A -= max(0.0, np.linalg.eigvals(A).real.max() + 1e-2) * np.eye(n)
    B, C = np.zeros((n, 1)), np.zeros((1, n))
    B[0], C[0, -1] = 1.0, 1.0
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)))


# --- norms ---------------------------------------------------------------------------------------------------------------------

def mode(w, z, gain):
    """A mode whose peak is the gain: its height is that of 2 z sqrt(1 - z^2)."""
    height = 2 * z * np.sqrt(1 - z * z)
    return np.array([[0.0, w], [-w, -2 * z * w]]), np.array([[0.0], [w]]), np.array([[gain * height, 0.0]]), np.zeros((1, 1))


def touching(r):
    """Two to four resonances, decades apart, whose peaks differ by 1e-3 to 1e-13 of their height."""
    count = int(r.integers(2, 5))
    w = 10.0 ** (r.uniform(-3, 0) + 1.5 * np.arange(count))
    g = None
    for wi in w:
        part = mode(wi, 10.0 ** r.uniform(-4, -0.5), 1 + 10.0 ** r.uniform(-13, -3))
        g = part if g is None else parallel(g, part)
    return dict(zip('ABCD', g))


def touching_channels(r):
    """The same with a channel for each resonance, so that no response adds to another."""
    count = int(r.integers(2, 4))
    parts = [mode(10.0 ** r.uniform(-3, 3), 10.0 ** r.uniform(-5, -0.3), 1 + 10.0 ** r.uniform(-13, -3)) for _ in range(count)]
    return dict(zip('ABCD', (sla.block_diag(*(p[k] for p in parts)) for k in range(4))))


def in_other_units(make, decades=6):
    """The same system with its states in units over twice so many decades."""
    def made(r):
        p = make(r)
        d = 2.0 ** np.round(r.uniform(-decades, decades, len(p['A'])) * np.log2(10))
        return dict(p, A=p['A'] * d[:, None] / d, B=p['B'] * d[:, None], C=p['C'] / d)
    return made


def over_decades(r):
    """Lags and modes over twelve decades, their gains of any size."""
    g = None
    for _ in range(int(r.integers(2, 6))):
        w = 10.0 ** r.uniform(-6, 6)
        part = mode(w, 10.0 ** r.uniform(-6, -0.2), 10.0 ** r.uniform(-3, 3)) if r.random() < 0.5 else \
            (np.array([[-w]]), np.array([[w]]), np.array([[10.0 ** r.uniform(-3, 3) * r.choice([1, -1])]]), np.zeros((1, 1)))
        g = part if g is None else parallel(g, part)
    return dict(zip('ABCD', g))


def nearly_all_pass(r):
    """All-pass functions behind each other with a small lag beside: a gain that hardly changes over all frequencies."""
    g = np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.ones((1, 1))
    for w in 10.0 ** r.uniform(-2, 3, int(r.integers(1, 5))):
        g = series(g, (np.array([[-w]]), np.array([[1.0]]), np.array([[-2 * w]]), np.ones((1, 1))))
    w = 10.0 ** r.uniform(-2, 3)
    small = np.array([[-w]]), np.array([[w]]), np.array([[10.0 ** r.uniform(-9, -1)]]), np.zeros((1, 1))
    return dict(zip('ABCD', parallel(g, small)))


def beside_the_circle(r):
    """Sampled modes at distances of 1e-1 to 1e-9 from plus one, minus one and the circle."""
    blocks = []
    for _ in range(int(r.integers(1, 4))):
        distance = 10.0 ** r.uniform(-9, -1)
        angle = r.choice([0.0, np.pi, r.uniform(0.1, 3.0)])
        z = (1 - distance) * np.exp(1j * angle)
        blocks.append(np.array([[z.real]]) if angle in (0.0, np.pi) else np.array([[z.real, z.imag], [-z.imag, z.real]]))
    A = sla.block_diag(*blocks)
    n = len(A)
    return dict(A=A, B=r.integers(-3, 4, (n, 1)) + 0.5, C=(r.integers(-3, 4, (1, n)) + 0.5) * tens(r, -3, 3), D=np.zeros((1, 1)), period=10.0 ** r.uniform(-3, 0))


# --- loops -----------------------------------------------------------------------------------------------------------------------

def on_the_circle(r):
    """A sampled loop with poles at plus one, at minus one, or at both, in integer coordinates."""
    real = [1.0] * int(r.integers(0, 3)) + [-1.0] * int(r.integers(0, 2)) + list(r.integers(-7, 8, int(r.integers(1, 3))) / 8.0)
    n = len(real)
    A = np.diag(real) + np.triu(r.integers(-1, 2, (n, n)), 1)
    T, inverse = unimodular(r, n)
    gain = 2.0 ** -int(r.integers(0, 14))
    return dict(A=T @ A @ inverse, B=T @ (r.integers(-2, 3, (n, 1)) + 0.5), C=gain * (r.integers(-2, 3, (1, n)) + 0.5) @ inverse, D=np.zeros((1, 1)),
                period=10.0 ** r.uniform(-3, 0))


def loop_of(make):
    """A gain that lets the response cross one near some pole."""
    def made(r):
        p = make(r)
        w = np.abs(np.linalg.eigvals(p['A']))
        w = w[w > 1e-9]
        s = 1j * float(r.choice(w)) if len(w) else 1j
        peak = abs(p['C'] @ np.linalg.solve(s * np.eye(len(p['A'])) - p['A'], p['B']) + p['D'])[0, 0]
        scale = 10.0 ** r.uniform(-0.5, 1.5) / max(peak, 1e-150)
        return dict(p, C=p['C'] * scale, D=p['D'] * scale)
    return made


def with_delay(make):
    """The same with a delay of a thousandth to ten of its fastest time constants: a longer one turns the response too often to list every crossing."""
    def made(r):
        p = loop_of(make)(r)
        return dict(p, D=0 * p['D'], delay=10.0 ** r.uniform(-3, 1) / np.abs(np.linalg.eigvals(p['A'])).max(), kind='delayed')
    return made


def free_bodies(r):
    """Two to four bodies, springs over twelve decades between some of them, a force on the first, the position or the rate of one."""
    k = int(r.integers(2, 5))
    m = 10.0 ** r.integers(-3, 4, k)
    K = np.zeros((k, k))
    for i in range(k - 1):
        c = 0.0 if r.random() < 0.15 else 10.0 ** float(r.integers(-6, 7))
        K[i, i] += c
        K[i + 1, i + 1] += c
        K[i, i + 1] -= c
        K[i + 1, i] -= c
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-K / m[:, None], -10.0 ** r.uniform(-6, -2) * K / m[:, None]]])
    B, C = np.zeros((2 * k, 1)), np.zeros((1, 2 * k))
    B[k], C[0, int(r.integers(0, 2)) * k] = 1 / m[0], 1.0
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)))


# --- equations --------------------------------------------------------------------------------------------------------------------

def bodies_equation(r):
    p = free_bodies(r)
    k = len(p['A'])
    Q = p['C'].T @ p['C'] * tens(r, -3, 6) + np.diag(10.0 ** r.uniform(-8, 0, k))
    return dict(A=p['A'], B=np.c_[p['B'], np.eye(k)[:, [k // 2 + k // 4]] * tens(r, -2, 2)], Q=Q, R=np.diag(10.0 ** r.integers(-4, 5, 2).astype(float)))


def alternating_equation(r):
    """Poles at and beside plus and minus one that the input reaches, in integer coordinates."""
    n = int(r.integers(2, 6))
    A = np.diag(r.choice([1.0, -1.0, 1 - 2.0 ** -20, -1 + 2.0 ** -26, 0.5, 1.25], n)) + np.triu(r.integers(-1, 2, (n, n)), 1)
    T, inverse = unimodular(r, n)
    C = (r.integers(-2, 3, (n, n)) + 0.25) @ inverse
    return dict(A=T @ A @ inverse, B=T @ (r.integers(-2, 3, (n, 2)) + 0.5), Q=C.T @ C * tens(r, -4, 4), R=np.eye(2) * tens(r, -4, 4))


def with_fast_states(r):
    """E diag(1, .., 1e-2 to 1e-10): states that are nearly algebraic."""
    n, k = int(r.integers(2, 5)), int(r.integers(1, 3))
    A = r.standard_normal((n + k, n + k))
    A[n:, n:] = -np.eye(k) * r.uniform(1, 3, k)
    E = np.eye(n + k)
    E[n:, n:] = np.diag(10.0 ** -r.uniform(2, 10, k))
    B, C = r.standard_normal((n + k, 2)), r.standard_normal((2, n + k))
    return dict(A=A, E=E, B=B, Q=C.T @ C, R=np.eye(2))


def stiff_equation(discrete=False):
    """Rates over eight decades beside each other in integer coordinates."""
    def make(r):
        n = int(r.integers(3, 7))
        rates = -(2.0 ** r.integers(-13, 14, n))
        A = np.diag(rates) + np.triu(r.integers(-1, 2, (n, n)), 1)
        if discrete:
            A = np.diag(r.choice([1, -1], n) * (1 - 2.0 ** -r.integers(1, 26, n))) + np.triu(r.integers(-1, 2, (n, n)) / 4, 1)
        T, inverse = unimodular(r, n)
        C = r.integers(-2, 3, (n, n)).astype(float)
        return dict(A=T @ A @ inverse, Q=T @ C @ C.T @ T.T)
    return make


def stable(make):
    def made(r):
        p = make(r)
        while np.linalg.eigvals(p['A']).real.max() > -1e-12:
            p = make(r)
        return p
    return made


def reduced(make):
    return lambda r: (lambda p: dict(p, order=int(r.integers(1, len(p['A']) + 1)), kind='balred'))(make(r))


def short(make, most=12):
    def made(r):
        p = make(r)
        while len(p['A']) > most:
            p = make(r)
        return p
    return made


NORMS = dict(touching=touching, touching_channels=touching_channels, touching_units=in_other_units(touching), decades=over_decades,
             decades_units=in_other_units(over_decades), all_pass=nearly_all_pass, beside_the_circle=beside_the_circle)

FAMILIES = {
    'c2d': dict(lags=sampling(lags, ('zoh', 'foh')), rod=sampling(rod, ('zoh', 'foh')), ladder=sampling(ladder, ('zoh', 'foh')), delayed_lags=sampling(short(lags, 20), kind='c2d_delayed'),
                bodies=sampling(free_bodies), decades=sampling(over_decades), units=sampling(in_other_units(short(rod)), ('zoh', 'foh'))),
    'norms': {name: of_kind('bounds', make) for name, make in NORMS.items()},
    'linfnorm': dict(touching=touching, touching_units=in_other_units(touching), decades=over_decades, all_pass=nearly_all_pass, beside_the_circle=beside_the_circle),
    'mh2': {name: of_kind('mh2', make) for name, make in
            dict(lags=lags, rod=short(rod, 16), ladder=ladder, decades=over_decades, touching_units=in_other_units(touching),
                 beside_the_circle=beside_the_circle).items()},
    'margins': dict(lags=loop_of(short(lags, 16)), rod=loop_of(short(rod, 14)), ladder=loop_of(short(ladder)), on_the_circle=on_the_circle, bodies=loop_of(free_bodies),
                    decades=loop_of(over_decades), units=loop_of(in_other_units(short(rod))), beside_the_circle=beside_the_circle),
    'delayed': dict(bodies=with_delay(free_bodies), rod=with_delay(short(rod)), decades=with_delay(over_decades)),
    'zeros': dict(ladder=short(ladder), on_the_circle=on_the_circle, bodies=free_bodies, decades=over_decades, touching_units=in_other_units(touching),
                  all_pass=nearly_all_pass),
    'care': dict(bodies=bodies_equation),
    'dare': dict(alternating=alternating_equation),
    'gcare': dict(fast_states=with_fast_states),
    'lyap': dict(stiff=stiff_equation()),
    'dlyap': dict(stiff=stiff_equation(True)),
    'balred': dict(ladder=reduced(short(ladder)), rod=reduced(short(rod)), lags=reduced(short(lags)), decades=reduced(over_decades),
                   units=reduced(in_other_units(short(rod))), touching_units=reduced(in_other_units(touching))),
}
