"""References and errors of the kinds that composed.py adds: generalised Stein equations, the inverse of Tustin's map, sampled costs, pole placement, and the
least level of H-infinity synthesis."""
import functools

import flint
import numpy as np

import hard_references as hard
import wide_references as wide
from hard_references import absolute, eye, long, mid, plain, solve, stein

POINTS = ((0.0, 0.01), (0.0, 0.3), (0.0, 1.0), (0.0, 5.0), (0.1, 0.2))
LEVEL_BITS = 400  # of Riccati equations beside the least level, whose solutions lose half of them


def numbers(problem, keys, random=None):
    return [flint.arb_mat([[flint.arb(e) for e in row] for row in wide.fractions(problem[k], random)]) for k in keys]


def sampled_condition(made, exact, distance):
    """Ten times what a share of 2^-90 in the data changes."""
    return 10 * max(distance(made(np.random.default_rng(seed)), exact) for seed in range(wide.SEEDS)) / hard.SHARE


def gdlyap(problem):
    A, E, Q = numbers(problem, 'AEQ')
    inverse = solve(E, eye(E.nrows()))
    A1, Q1 = mid(inverse * A), mid(inverse * Q * inverse.transpose())
    X = stein(A1.transpose(), Q1)
    if X is None:
        return dict(exists=False)
    i, a, e = absolute(inverse), absolute(A), absolute(E)
    inner = i @ (a + e @ absolute(A1))
    change = inner @ absolute(X) @ absolute(A1).T
    error = plain(stein(A1.transpose(), long(change + change.T + i @ absolute(Q) @ i.T)))
    d = np.sqrt(np.maximum(np.abs(np.diag(plain(X))), 1e-300))
    return dict(exists=True, X=plain(X), condition=float(np.max(np.abs(error) / np.outer(d, d))))


# --- the inverse of Tustin's map ------------------------------------------------------------------------------------------------

def continuous_points(problem):
    return [flint.acb(re, im) * (2 / flint.arb(problem['period'])) for re, im in POINTS]


def d2c(problem):
    def made(random=None):
        system = numbers(problem, 'ABCD', random)
        step = flint.arb(problem['period']) / 2
        return [wide.response(*system, (1 + s * step) / (1 - s * step)) for s in continuous_points(problem)]
    exact = made()
    return dict(exists=True, values=exact, condition=sampled_condition(made, exact, wide.distance))


def d2c_error(answer, reference, problem):
    if 'A' not in answer:
        return float('inf')
    at = lambda matrices: [wide.response(*matrices, s) for s in continuous_points(problem)]
    r, found = np.random.default_rng(7), at([long(answer[k]) for k in 'ABCD'])
    rounded = lambda M: long((np.array(M, float) * (1 + 2.0 ** -52 * r.integers(-1, 2, np.shape(M)))).tolist())
    noise = max(wide.distance(at([rounded(answer[k]) for k in 'ABCD']), found) for _ in range(wide.SEEDS))
    return max(0.0, wide.distance(found, reference['values']) - 10 * noise)


# --- the cost of a period ---------------------------------------------------------------------------------------------------------

def cost(problem):
    def made(random=None):
        A, B, Q, R, S = numbers(problem, 'ABQRS', random)
        Q = mid((Q + Q.transpose()) / 2)
        n, m, h = A.nrows(), B.ncols(), flint.arb(problem['h'])
        F = [[A[i, j] if j < n else B[i, j - n] for j in range(n + m)] if i < n else [flint.arb(0)] * (n + m) for i in range(n + m)]
        W = [[(Q[i, j] if j < n else S[i, j - n]) if i < n else (S[j, i - n] if j < n else R[i - n, j - n]) for j in range(n + m)] for i in range(n + m)]
        F, W = flint.arb_mat(F) * h, flint.arb_mat(W) * h
        E = wide.exponential([[-F.transpose(), W], [wide.zero(n + m, n + m), F]])
        k = n + m
        return mid(wide.block(E, k, k, k, k).transpose() * wide.block(E, 0, k, k, k))
    exact = made()
    return dict(exists=True, X=plain(exact), condition=cost_condition(made, exact))


def cost_condition(made, exact):
    d = [max(float(abs(exact[i, i]).mid()), 1e-300) ** 0.5 for i in range(exact.nrows())]
    change = 0.0
    for seed in range(wide.SEEDS):
        difference = mid(made(np.random.default_rng(seed)) - exact)
        change = max([change] + [float(abs(difference[i, j]).mid()) / (d[i] * d[j]) for i in range(len(d)) for j in range(len(d))])
    return 10 * change / hard.SHARE


def cost_error(answer, reference, problem):
    if 'X' not in answer:
        return float('inf')
    X, exact = np.array(answer['X']), reference['X']
    d = np.sqrt(np.maximum(np.abs(np.diag(exact)), 1e-300))
    return float(np.max(np.abs(X - exact) / np.outer(d, d)))


# --- loops with a delay ---------------------------------------------------------------------------------------------------------

def delayed(problem):
    """The reference of wide_references with the condition found by changing every entry of the data by at most 2^-40."""
    exact = wide_delayed(problem)
    changed = [changed_crossings(problem, np.random.default_rng(seed)) for seed in range(wide.SEEDS)]
    as_answer = lambda r: dict(phase=[(0, w) for w in r['phase']], gain=[(0, w) for w in r['gain']])
    change = max(wide.delayed_error(as_answer(other), exact, problem) for other in changed)
    return dict(exact, condition=max(exact['condition'], 10 * change * 2.0 ** 40))


def changed_crossings(problem, random):
    changed = lambda M: [[e * (1 + 2.0 ** -40 * random.uniform(-1, 1)) for e in row] for row in M]
    return wide_delayed(dict(problem, **{key: changed(problem[key]) for key in 'ABC'}))


# --- placement ----------------------------------------------------------------------------------------------------------------------

def place(problem):
    """Whether every mode is within reach of the inputs is not asked: the families are."""
    return dict(exists=True, condition=1.0)


def poles_of(A, B, F):
    return [v.mid() for v in flint.acb_mat(mid(A - B * F)).eig(algorithm='approx')]


def poles_distance(found, exact):
    found, worst = list(found), 0.0
    for z in exact:
        k = min(range(len(found)), key=lambda k: float(abs(found[k] - z).mid()))
        worst = max(worst, float((abs(found.pop(k) - z) / abs(z)).mid()))
    return worst


def place_error(answer, reference, problem):
    """How far the poles are off, less ten times what rounding the plant and the gain moves them."""
    F = answer.get('F') if isinstance(answer, dict) else answer
    if F is None or not np.isfinite(np.array(F)).all():
        return float('inf')
    A, B, F = (np.atleast_2d(np.array(M, float)) for M in (problem['A'], problem['B'], F))
    wanted, r = [flint.acb(*p) for p in problem['poles']], np.random.default_rng(3)
    found = poles_of(long(A), long(B), long(F))
    rounded = lambda M: long(M * (1 + 2.0 ** -52 * r.choice([-1, 1], M.shape)))
    noise = max(poles_distance(poles_of(rounded(A), rounded(B), rounded(F)), found) for _ in range(wide.SEEDS))
    return max(0.0, poles_distance(found, wanted) - 10 * noise)


def place_peers(problem):
    import scipy.signal
    A, B = np.array(problem['A']), np.array(problem['B'])
    poles = np.array([complex(*p) for p in problem['poles']])
    yield 'scipy', lambda: scipy.signal.place_poles(A, B, poles).gain_matrix


# --- the least level of H-infinity synthesis -----------------------------------------------------------------------------------------

def stabilising(A, R, Q):
    """X with A'X + XA + XRX + Q = 0 and A + RX stable, and whether it exists and is not negative."""
    n = A.nrows()
    H = flint.acb_mat([[A[i, j] for j in range(n)] + [R[i, j] for j in range(n)] for i in range(n)]
                      + [[-Q[i, j] for j in range(n)] + [-A[j, i] for j in range(n)] for i in range(n)])
    values, vectors = H.eig(right=True, algorithm='approx')
    stable = [k for k, v in enumerate(values) if float((v.real / abs(v)).mid()) < -1e-40]
    if len(stable) != n:
        return None
    top = flint.acb_mat([[vectors[i, k].mid() for k in stable] for i in range(n)])
    low = flint.acb_mat([[vectors[n + i, k].mid() for k in stable] for i in range(n)])
    try:
        X = top.transpose().solve(low.transpose()).transpose().mid()
    except ZeroDivisionError:
        return None
    X = flint.arb_mat([[((X[i, j] + X[j, i].conjugate()) / 2).real.mid() for j in range(n)] for i in range(n)])
    least = min(float(v.real.mid()) for v in flint.acb_mat(X).eig(algorithm='approx'))
    return X if least > -1e-40 * max(1.0, hard.largest(X)) else None


def is_reachable(parts, level):
    A, B1, B2, C1, C2 = parts
    t = lambda M: M.transpose()
    square = level * level
    X = stabilising(A, mid(B1 * t(B1) / square - B2 * t(B2)), mid(t(C1) * C1))
    Y = stabilising(t(A), mid(t(C1) * C1 / square - t(C2) * C2), mid(B1 * t(B1)))
    if X is None or Y is None:
        return False
    return max(float(abs(v).mid()) for v in flint.acb_mat(mid(X * Y)).eig(algorithm='approx')) < float(square.mid())


def level(problem):
    """By bisection of the conditions of Doyle, Glover, Khargonekar and Francis, IEEE Trans. Automat. Control 34 (1989)."""
    before, flint.ctx.prec = flint.ctx.prec, LEVEL_BITS
    try:
        parts = numbers(problem['parts'], ('A', 'B1', 'B2', 'C1', 'C2'))
        high = 1.0
        while not is_reachable(parts, flint.arb(high)):
            high *= 4
            if high > 1e12:
                return dict(exists=None)
        low = high / 4
        while low > 1e-12 and is_reachable(parts, flint.arb(low)):
            high, low = low, low / 4
        while high / low > 1 + 1e-9:
            middle = float(np.sqrt(high * low))
            low, high = (low, middle) if is_reachable(parts, flint.arb(middle)) else (middle, high)
        return dict(exists=True, value=high, condition=1.0)
    finally:
        flint.ctx.prec = before


def level_error(answer, reference, problem):
    """How far above the least level the norm lies; a norm or a bound that is claimed wrongly counts as 1."""
    if 'value' not in answer:
        return float('inf')
    exact = reference['value']
    if answer['value'] < exact * (1 - 1e-7) or (answer['unreachable'] or 0) > exact * (1 + 1e-6):
        return 1.0
    real = loop_norm(problem, answer)
    return 1.0 if real is None or real > answer['value'] * (1 + 1e-6) else answer['value'] / exact - 1


def loop_norm(problem, answer):
    """The norm of the loop in long numbers; None if it is not stable."""
    A, B, C, D = numbers(problem, 'ABCD')
    m2, p2, n = problem['controls'], problem['measurements'], A.nrows()
    m1, p1, k = B.ncols() - m2, C.nrows() - p2, len(answer['A'])
    part = wide.block
    B1, B2, C1, C2 = part(B, 0, 0, n, m1), part(B, 0, m1, n, m2), part(C, 0, 0, p1, n), part(C, p1, 0, p2, n)
    D11, D12, D21 = part(D, 0, 0, p1, m1), part(D, 0, m1, p1, m2), part(D, p1, 0, p2, m1)
    shape = dict(A=(k, k), B=(k, p2), C=(m2, k), D=(m2, p2))
    a, b, c, d = (long(np.array(answer[key], float).reshape(shape[key])) if 0 not in shape[key] else wide.zero(*shape[key]) for key in 'ABCD')
    rows = lambda *blocks: flint.arb_mat([[M[i, j] for M in line for j in range(M.ncols())] for line in blocks for i in range(line[0].nrows())])
    sum_of = lambda *Ms: mid(functools.reduce(lambda x, y: x + y, Ms))
    if k == 0:
        system = sum_of(A, B2 * d * C2), sum_of(B1, B2 * d * D21), sum_of(C1, D12 * d * C2), sum_of(D11, D12 * d * D21)
    else:
        system = (rows([sum_of(A, B2 * d * C2), mid(B2 * c)], [mid(b * C2), a]), rows([sum_of(B1, B2 * d * D21)], [mid(b * D21)]),
                  rows([sum_of(C1, D12 * d * C2), mid(D12 * c)]), sum_of(D11, D12 * d * D21))
    if max(float(v.real.mid()) for v in flint.acb_mat(system[0]).eig(algorithm='approx')) >= 0:
        return None
    return float(wide.norm_of(system))


wide_delayed = wide.delayed
wide.KINDS.update(gdlyap=gdlyap, delayed=delayed, d2c=d2c, cost=cost, place=place, level=level)
wide.ERRORS.update(d2c=d2c_error, cost=cost_error, place=place_error, level=level_error)


def peers(kind, problem):
    return place_peers(problem) if problem['kind'] == 'place' else wide.peers_of_wide(kind, problem)


wide.peers_of_wide, wide.peers = wide.peers, peers
