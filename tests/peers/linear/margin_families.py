"""Loops whose margins are hard to find, made from seeds: see wide.py."""
import numpy as np

from hard_families import cascade, modal, size, stable, tens


def tustin(p, period):
    """The loop by the bilinear map: every zero at infinity becomes a zero at half the sampling rate."""
    A, B, C, D = (np.array(p[k], float) for k in 'ABCD')
    inverse = np.linalg.inv(np.eye(len(A)) - 0.5 * period * A)
    return dict(A=inverse @ (np.eye(len(A)) + 0.5 * period * A), B=inverse @ B * period, C=C @ inverse,
                D=D + 0.5 * period * C @ inverse @ B, period=float(period))


def m_tustin(r):
    """Lags, integrators and modes, by the bilinear map."""
    gain = 10.0 ** r.uniform(-2, 3)
    if r.random() < 0.5:
        p = cascade(-np.r_[0.0 if r.random() < 0.5 else 1.0, 10.0 ** r.uniform(-2, 2, int(r.integers(1, 4)))], [], gain)
    else:
        p = modal(r, int(r.integers(1, 4)), tens(r, -4, -1), rigid=int(r.integers(0, 2)))
        p = dict(p, C=p['C'] * gain)
    fastest = max(np.abs(np.linalg.eigvals(p['A'])).max(), 1e-2)
    return tustin(p, 10.0 ** r.uniform(-2, 0) / fastest)


def m_chain(r):
    """Masses and springs without damping: zeros and poles alternate on the axis if the force acts where the position is measured."""
    k = int(r.integers(2, 5))
    m, c = 10.0 ** r.uniform(-1, 1, k), 10.0 ** r.uniform(0, 4, k)
    K = np.diag(c)
    for i in range(1, k):
        K[i - 1, i - 1] += c[i]
        K[i - 1, i] -= c[i]
        K[i, i - 1] -= c[i]
    damping = r.choice([0.0, 0.0, 1e-6, 1e-3])
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-K / m[:, None], -damping * K / m[:, None]]])
    B, C = np.zeros((2 * k, 1)), np.zeros((1, 2 * k))
    B[k, 0], C[0, int(r.integers(0, k))] = 1 / m[0], 10.0 ** r.uniform(0, 4)
    if r.random() < 0.5:
        C[0, k:] = C[0, :k] * 10.0 ** r.uniform(-3, 0)
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)))


def m_flat(r):
    """A gain that is one, or nearly one, at zero frequency or at the end of the axis."""
    near = r.choice([1.0, 1 + 1e-3, 1 - 1e-6, 1 + 1e-10, 1 - 1e-13]) * r.choice([1, -1])
    n = int(r.integers(1, 4))
    poles, zeros = -10.0 ** r.uniform(-2, 2, n), -10.0 ** r.uniform(-2, 2, n) * r.choice([1, 1, -1], n)
    if r.random() < 0.5:
        return cascade(poles, zeros, near)  # gain at infinity
    return cascade(poles, zeros, near * np.prod(poles / zeros))


def m_nyquist(r):
    """Sampled loops that cross near half the sampling rate: delays, and zeros and poles beside -1."""
    d = int(r.integers(2, 12))
    n = d + 1
    A, B, C = np.diag(np.ones(n - 1), -1), np.zeros((n, 1)), np.zeros((1, n))
    A[0, 0] = r.choice([1.0, 0.9, -0.9, -1 + 1e-4, 0.0])
    B[0, 0], C[0, -1] = 10.0 ** r.uniform(-3, 0.5), 1.0
    C[0, -2] = r.choice([0.0, 1.0, 1 - 1e-5, 1 + 1e-3, 0.5])
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)), period=10.0 ** -r.uniform(0, 5))


def m_powers(r):
    """Every entry a power of ten or zero."""
    n = size(r, 4)
    entry = lambda *shape: np.where(r.random(shape) < 0.6, 10.0 ** r.integers(-4, 5, shape) * r.choice([-1, 1], shape), 0.0)
    A, B, C = entry(n, n), entry(n, 1), entry(1, n)
    B[r.integers(n), 0], C[0, r.integers(n)] = tens(r, -3, 3), tens(r, -3, 3)
    return dict(A=A, B=B, C=C, D=np.zeros((1, 1)))


def m_defective(r):
    """A Jordan block in rotated integer coordinates."""
    n = int(r.integers(2, 6))
    T = np.eye(n) + np.tril(r.integers(-2, 3, (n, n)), -1)
    A = T @ (r.choice([-1.0, -0.5, 0.0, -8.0]) * np.eye(n) + np.diag(np.full(n - 1, 2.0 ** r.integers(-3, 4)), 1)) @ np.round(np.linalg.inv(T))
    return dict(A=A, B=r.integers(-2, 3, (n, 1)).astype(float), C=r.integers(-2, 3, (1, n)) * 2.0 ** r.integers(-8, 9), D=np.zeros((1, 1)))


def m_units(r):
    """A dense loop in states whose units spread over twelve decades."""
    n = size(r, 6)
    d, gain = 10.0 ** r.uniform(-6, 6, n), 10.0 ** r.uniform(-2, 3)
    A, B, C = stable(r, n), r.standard_normal((n, 1)), gain * r.standard_normal((1, n))
    return dict(A=A * d[:, None] / d, B=B * d[:, None], C=C / d, D=np.zeros((1, 1)))


def m_rigid(r):
    """Free masses with springs in physical coordinates, with a lead network."""
    k = int(r.integers(2, 4))
    m = 10.0 ** r.uniform(-2, 2, k)
    K = np.zeros((k, k))
    for i in range(k - 1):
        K[i:i + 2, i:i + 2] += 10.0 ** r.uniform(1, 6) * np.array([[1, -1], [-1, 1]])
    damping = r.choice([1e-6, 1e-4, 1e-3])
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-K / m[:, None], -damping * K / m[:, None]]])
    B, C = np.zeros((2 * k, 1)), np.zeros((1, 2 * k))
    B[k, 0], C[0, r.integers(k)] = 1 / m[0], m.sum() * 10.0 ** r.uniform(-2, 4)
    lead = 10.0 ** r.uniform(-1, 2)
    A = np.block([[A, np.zeros((2 * k, 1))], [C, np.array([[-10 * lead]])]])
    return dict(A=A, B=np.r_[B, [[0.0]]], C=np.c_[10 * C, [[-90 * lead]]], D=np.zeros((1, 1)))


FAMILIES = dict(tustin=m_tustin, chain=m_chain, flat=m_flat, nyquist=m_nyquist, powers=m_powers, defective=m_defective, units=m_units,
                rigid=m_rigid)
