"""References of wide.py: exact fractions, and numbers of 1000 bits."""
import functools

import flint
import numpy as np

import hard_references as hard
from hard_references import absolute, eye, largest, long, lyapunov, mid, plain, solve, stein

EPS = 2.0 ** -53
SEEDS = 3


def reference(kind, problem):
    """What is exact; see hard_references.reference."""
    kind = problem['kind']
    if kind in ('care', 'dare') and 'S' in problem:
        return with_cross(kind, problem)
    if kind in ('lyap', 'dlyap') and problem.get('direct'):
        return by_kronecker(kind, problem)
    return KINDS[kind](problem) if kind in KINDS else hard.reference(kind, problem)


def error(kind, answer, reference, problem):
    kind = problem['kind']
    if kind not in ERRORS or not reference['exists'] or answer is None:
        return hard.error(kind, answer, reference, problem)
    return ERRORS[kind](answer, reference, problem)


def peers(kind, problem):
    """The peers of an equation with a cross term and of several inputs and outputs; else those of hard_references."""
    import scipy.linalg as sla
    kind = problem['kind']
    if kind in ('care', 'dare') and 'S' in problem:
        get = lambda key: np.atleast_2d(np.array(problem[key], float))
        solver = sla.solve_continuous_are if kind == 'care' else sla.solve_discrete_are
        yield 'scipy', lambda: solver(get('A'), get('B'), get('Q'), get('R'), s=get('S'))
    elif kind not in KINDS:
        yield from hard.peers(kind, problem)


# --- equations -----------------------------------------------------------------------------------------------------------

def with_cross(kind, problem):
    A, B, Q, R, S = hard.data(problem, 'A', 'B', 'Q', 'R', 'S')
    K = solve(R, mid(S.transpose()))
    G = mid(B * solve(R, mid(B.transpose())))
    A1, Q1 = mid(A - B * K), mid(Q - S * K)
    if kind == 'care':
        X = hard.care_reference(A1, G, Q1)
        a = absolute(A) + absolute(B) @ absolute(K)
        q = absolute(Q) + 2 * absolute(S) @ absolute(K) + absolute(K).T @ absolute(R) @ absolute(K)
        return dict(exists=None) if X is None else dict(exists=True, X=plain(X), condition=hard.condition_continuous(A1, G, Q1, X, (a, q)))
    X = hard.dare_reference(A1, B, Q1, R)
    if X is None:
        return dict(exists=None)
    growth = float(np.max((absolute(A) + absolute(B) @ absolute(K)) / np.maximum(absolute(A1), 1e-300)))
    return dict(exists=True, X=plain(X), condition=min(growth, 1e3) * hard.condition_discrete(A1, B, Q1, R, X))


def by_kronecker(kind, problem):
    """AX + XA' + Q = 0 or AXA' - X + Q = 0 as one system of linear equations."""
    A, Q = hard.data(problem, 'A', 'Q')
    n = A.nrows()
    I = eye(n)
    entry = lambda i, j, k, l: (A[i, k] * I[j, l] + I[i, k] * A[j, l]) if kind == 'lyap' else A[i, k] * A[j, l] - I[i, k] * I[j, l]
    pairs = [(i, j) for i in range(n) for j in range(n)]
    M = flint.arb_mat([[entry(i, j, k, l) for k, l in pairs] for i, j in pairs])
    inverse = solve(mid(M), eye(n * n))
    if inverse is None or largest(inverse) > 1e200:
        return dict(exists=False)
    X = plain(mid(inverse * flint.arb_mat([[-Q[i, j]] for i, j in pairs]))).reshape(n, n)
    x, a = np.abs(X), absolute(A)
    change = a @ x + x @ a.T + absolute(Q) if kind == 'lyap' else 2 * a @ x @ a.T + absolute(Q)
    E = (absolute(inverse) @ change.reshape(-1)).reshape(n, n)
    d = np.sqrt(np.maximum(np.abs(np.diag(X)), 1e-25 * x.max() + 1e-300))
    return dict(exists=True, X=X, condition=float(np.max(E / np.outer(d, d))))


# --- zeros of systems with several inputs and outputs -----------------------------------------------------------------------

def fractions(M, random=None):
    """The doubles as fractions; with random numbers, each changed by a share of at most 2^-90."""
    M = np.atleast_2d(np.array(M, float))
    change = lambda: 1 if random is None else 1 + flint.fmpq(int(random.integers(-1000, 1001)), 1000) / 2 ** 90
    return [[flint.fmpq(*float(e).as_integer_ratio()) * change() for e in row] for row in M]


def interpolate(points, values):
    total, x = flint.fmpq_poly([0]), flint.fmpq_poly([0, 1])
    for i, (xi, yi) in enumerate(zip(points, values)):
        if yi == 0:
            continue
        term, below = flint.fmpq_poly([1]), flint.fmpq(1)
        for j, xj in enumerate(points):
            if j != i:
                term, below = term * (x - xj), below * (xi - xj)
        total += term * (yi / below)
    return total


def zero_polynomial(problem):
    """The greatest common divisor of the minors of largest size of [A - sI, B; C, D]."""
    random = problem.get('random')
    A, B, C, D = (fractions(problem[k], random) for k in 'ABCD')
    n, m, p = len(A), len(B[0]), len(C)
    at = lambda s: flint.fmpq_mat([[A[i][j] - (s if i == j else 0) for j in range(n)] + B[i] for i in range(n)] + [C[i] + D[i] for i in range(p)])
    rank = max(at(flint.fmpq(k, 7)).rank() for k in (3, 17, 101))
    draw = np.random.default_rng(1)
    mixed = lambda rows, cols: flint.fmpq_mat([[flint.fmpq(int(draw.integers(-9, 10))) for _ in range(cols)] for _ in range(rows)])
    points, found = [flint.fmpq(k - n // 2) for k in range(n + 1)], None
    for _ in range(1 if rank == n + m == n + p else 4):
        L, R = (flint.fmpq_mat(eye_rows(rank)),) * 2 if rank == n + m == n + p else (mixed(rank, n + p), mixed(n + m, rank))
        minor = interpolate(points, [(L * at(s) * R).det() for s in points])
        found = minor if found is None else found.gcd(minor)
    return found


def eye_rows(n):
    return [[flint.fmpq(int(i == j)) for j in range(n)] for i in range(n)]


def mzeros(problem):
    polynomial = zero_polynomial(problem)
    if polynomial.degree() <= 0:
        return dict(exists=True, values=[], condition=1.0)
    values = hard.roots(polynomial)
    times = max(k for _, k in polynomial.complex_roots())
    square = len(problem['C']) == len(problem['B'][0])
    if times == 1 and square and problem['family'] != 'planted':
        others = [hard.roots(zero_polynomial(dict(problem, random=np.random.default_rng(seed)))) for seed in range(SEEDS)]
        change = max(hard.zeros_error(dict(values=o), dict(values=values)) for o in others)
        return dict(exists=True, values=values, condition=10 * change / hard.SHARE)
    # A multiple root moves with the root of the rounding; planted integers have no close neighbours.
    return dict(exists=True, values=values, condition=1e5 if times == 1 else (EPS ** (1 / times)) / EPS * 100)


def mzeros_error(answer, reference, problem):
    """The largest relative error of a zero; of one at the origin, the distance over the size of A."""
    if 'values' not in answer:
        return float('inf')
    size, ours, worst = float(np.abs(np.array(problem['A'])).max()), [flint.acb(*v) for v in answer['values']], 0.0
    if len(ours) != len(reference['values']):
        return 1e3
    for z in sorted(reference['values'], key=lambda z: float(abs(z).mid())):
        k = min(range(len(ours)), key=lambda k: float(abs(ours[k] - z).mid()))
        of = float(abs(z).mid())
        worst = max(worst, float(abs(z - ours.pop(k)).mid()) / (of if of > 1e-200 else size))
    return worst


# --- loops with a delay --------------------------------------------------------------------------------------------------------

LEAST = 1e-3  # a crossing of the negative axis at a smaller gain is not asked for


def delayed(problem):
    """All crossings of the unit circle and of the negative axis, from the exact roots, on a fine grid and by bisection."""
    from scipy.optimize import brentq
    N, D = hard.polynomials(problem)
    zeros, poles = ([complex(r) for r in hard.roots(P)] if P.degree() > 0 else [] for P in (N, D))
    lead, delay = float(flint.arb(N[N.degree()] / D[D.degree()])), problem['delay']
    def log_gain_and_phase(w):
        s = 1j * np.atleast_1d(np.asarray(w, float))
        gain, phase = np.log(abs(lead)) + 0 * s.real, (np.pi if lead < 0 else 0.0) - s.imag * delay
        for roots, sign in ((zeros, 1), (poles, -1)):
            for root in roots:
                gain = gain + sign * np.log(np.maximum(np.abs(s - root), 1e-300))
                phase = phase + sign * np.angle(s - root)
        return gain, phase
    sizes = [abs(r) for r in zeros + poles if abs(r) > 1e-9] or [1.0]
    top = max(sizes) * 10
    while log_gain_and_phase(top)[0][0] > np.log(LEAST) and top < 1e12:
        top *= 2
    grid = np.unique(np.r_[np.logspace(np.log10(min(sizes)) - 7, np.log10(top), 40000), np.linspace(0, top, min(400000, int(40 * top * delay) + 1000))[1:]]
                     + [0.0])
    grid = np.unique(np.r_[grid, *[np.abs(r.imag) + np.linspace(-30, 30, 2001) * max(abs(r.real), 1e-9 * abs(r)) for r in zeros + poles]])
    grid = grid[(grid > 0) & (grid <= top)]
    gain, phase = log_gain_and_phase(grid)
    turned = (phase + np.pi) / (2 * np.pi)  # whole numbers are crossings of the negative axis
    root = lambda f, k: brentq(f, grid[k], grid[k + 1], xtol=1e-300, rtol=1e-14)
    circle = [root(lambda w: log_gain_and_phase(w)[0][0], k) for k in np.nonzero(np.diff(np.sign(gain)))[0]]
    axis = []
    for k in np.nonzero(np.floor(turned[1:]) != np.floor(turned[:-1]))[0]:
        if abs(turned[k + 1] - turned[k]) > 0.3:
            continue  # a pole on the axis, where the phase jumps
        level = max(np.floor(turned[k]), np.floor(turned[k + 1]))
        w = root(lambda w: (log_gain_and_phase(w)[1][0] + np.pi) / (2 * np.pi) - level, k)
        if log_gain_and_phase(w)[0][0] > np.log(LEAST / 0.99):
            axis.append(w)
    return dict(exists=True, phase=circle, gain=axis, condition=1e5)


def delayed_error(answer, reference, problem):
    """The largest relative error of a crossing; one too many or too few counts as 1."""
    if 'phase' not in answer:
        return float('inf')
    worst = 0.0
    for ours, exact in (([p[1] for p in answer['phase']], reference['phase']), ([g[1] for g in answer['gain'] if g[0] < 0.99 / LEAST], reference['gain'])):
        ours = [w for w in ours if w and w > 0]
        if len(ours) != len(exact):
            return 1.0
        worst = max([worst] + [abs(a / b - 1) for a, b in zip(sorted(ours), sorted(exact))])
    return worst


# --- norms ---------------------------------------------------------------------------------------------------------------

def matrices(problem, random=None):
    """A, B, C, D in long numbers, each entry changed by a tiny share if random numbers are given; sampled ones by the bilinear map."""
    A, B, C, D = (flint.arb_mat([[flint.arb(e) for e in row] for row in fractions(problem[k], random)]) for k in 'ABCD')
    return bilinear(A, B, C, D) if 'period' in problem else (A, B, C, D)


def bilinear(A, B, C, D):
    """The continuous system that takes the same values by z = (1 + s) / (1 - s)."""
    n = A.nrows()
    inverse = solve(mid(A + eye(n)), eye(n))
    root = flint.arb(2).sqrt()
    return mid(inverse * (A - eye(n))), mid(inverse * B * root), mid(C * inverse * root), mid(D - C * inverse * B)


def gain(system, s):
    """The largest singular value at a point."""
    A, B, C, D = (flint.acb_mat(M) for M in system)
    n = A.nrows()
    shifted = flint.acb_mat([[(s if i == j else flint.acb(0)) - A[i, j] for j in range(n)] for i in range(n)])
    G = (C * shifted.solve(B) + D).mid()
    H = flint.acb_mat([[sum((G[k, i].conjugate() * G[k, j] for k in range(G.nrows())), flint.acb(0)) for j in range(G.ncols())] for i in range(G.ncols())])
    return max((e.real.mid() for e in H.mid().eig(algorithm='approx')), key=float).sqrt().mid()


def hamiltonian_rates(system, level):
    """The rates at which a singular value takes a level."""
    A, B, C, D = system
    R = mid(eye(B.ncols()) * (level * level) - D.transpose() * D)
    RD, RB = solve(R, mid(D.transpose() * C)), solve(R, mid(B.transpose()))
    F = mid(A + B * RD)
    upper, lower = mid(B * RB), mid(C.transpose() * C + C.transpose() * D * RD)
    n = A.nrows()
    H = flint.acb_mat([[F[i, j] for j in range(n)] + [upper[i, j] for j in range(n)] for i in range(n)]
                      + [[-lower[i, j] for j in range(n)] + [-F[j, i] for j in range(n)] for i in range(n)])
    values = [v.mid() for v in H.mid().eig(algorithm='approx')]
    return sorted({v.imag.mid() for v in values if abs(float(v.real.mid())) <= 1e-60 * max(float(abs(v).mid()), 1e-200) and v.imag >= 0}, key=float)


def norm(problem, random=None):
    """The norm in 1000 bits, see [`norm_of`]."""
    return norm_of(matrices(problem, random))


def norm_of(system):
    """The norm of a continuous system in long numbers by Bruinsma and Steinbuch's iteration."""
    D = flint.acb_mat(system[3])
    poles = [v.mid() for v in flint.acb_mat(system[0]).eig(algorithm='approx')]
    candidates = [flint.arb(0)] + [abs(v).mid() for v in poles] + [abs(v.imag).mid() for v in poles]
    level = max([gain(system, flint.acb(0, w)) for w in candidates], key=float)
    H = (D.transpose() * D).mid()
    level = max([level] + [e.real.mid().sqrt() for e in H.eig(algorithm='approx') if e.real > 0], key=float).mid()
    if float(level) == 0:
        return level
    for _ in range(40):
        rates = hamiltonian_rates(system, (level * (1 + flint.arb(2) ** -120)).mid())
        if not rates:
            return level
        pairs = list(zip(rates, rates[1:]))
        middles = [((a + b) / 2).mid() for a, b in pairs] + [(a * b).sqrt().mid() for a, b in pairs] + [rates[0], rates[-1], flint.arb(0)]
        better = functools.reduce(lambda a, b: b if b > a else a, [gain(system, flint.acb(0, w)) for w in middles])
        if not better > level * (1 + flint.arb(2) ** -110):
            return level
        level = better
    return level


def bounds(problem):
    value = norm(problem)
    others = [norm(problem, np.random.default_rng(seed)) for seed in range(SEEDS)]
    change = max(float(abs(o / value - 1).mid()) for o in others) if float(value) else 0.0
    return dict(exists=True, value=value, condition=10 * change / hard.SHARE)


def bounds_error(answer, reference, problem):
    """The error of the lower bound, and by how much the upper bound is too low or looser than a millionth."""
    if 'value' not in answer:
        return float('inf')
    exact = reference['value']
    if not float(exact):
        return abs(answer['value'])
    share = lambda v: float((flint.arb(v) / exact - 1).mid()) if v is not None and np.isfinite(v) else 1e3
    upper = share(answer['upper'] if answer['upper'] is not None else float('inf'))
    return max(abs(share(answer['value'])), -upper, 0.0 if upper < 1e-6 else upper)


# --- margins of several loops -----------------------------------------------------------------------------------------------

def multiloop(problem):
    """The disk margin of each channel, the others closed, and of all with any coupling, from the norms of (S - T)/2."""
    def made(random=None):
        A, B, C = (flint.arb_mat([[flint.arb(e) for e in row] for row in fractions(problem[k], random)]) for k in 'ABC')
        m, half = B.ncols(), flint.arb(1) / 2
        channels = [list(range(m))] + [[k] for k in range(m)]
        closed, found = mid(A - B * C), []
        for some in channels:
            b = flint.arb_mat([[B[i, j] for j in some] for i in range(A.nrows())])
            c = flint.arb_mat([[-C[j, i] for i in range(A.nrows())] for j in some])
            system = closed, b, c, eye(len(some)) * half
            found.append(1 / norm_of(bilinear(*system) if 'period' in problem else system))
        return found
    exact = made()
    others = [made(np.random.default_rng(seed)) for seed in range(SEEDS)]
    change = max(float(abs(b / a - 1).mid()) for other in others for a, b in zip(exact, other))
    return dict(exists=True, values=exact, condition=10 * change / hard.SHARE)


def multiloop_error(answer, reference, problem):
    """The error of the margins that have exact values; one with coupling may be a millionth too low but not too high. The others must be in order."""
    if 'each' not in answer:
        return float('inf')
    share = lambda ours, exact: float((flint.arb(ours) / exact - 1).mid())
    full = share(answer['full'], reference['values'][0])
    worst = max([abs(share(a, b)) for a, b in zip(answer['each'], reference['values'][1:])] + [full, 0.0 if full > -1e-6 else -full])
    ordered = [answer['full'], answer['proved'], answer['diagonal'], min(answer['each'])]
    return max([worst] + [a / b - 1 for a, b in zip(ordered, ordered[1:])])


def h2(problem):
    A, B, C, D = matrices({k: v for k, v in problem.items() if k != 'period'})
    if problem.get('infinite'):
        return minimal_h2(problem)
    made = lambda A, B, C, D: sampled_square(A, B, C, D) if 'period' in problem else \
        (lambda P: None if P is None else mid(C * P * C.transpose()))(lyapunov(A.transpose(), mid(B * B.transpose()), max(1e-6, float(np.sqrt(largest(A))))))
    P = made(A, B, C, D)
    if P is None:
        return dict(exists=False)
    trace = lambda M: sum((M[i, i] for i in range(M.nrows())), flint.arb(0)).sqrt().mid()
    value = trace(P)
    others = [made(*matrices({k: v for k, v in problem.items() if k != 'period'}, np.random.default_rng(seed))) for seed in range(SEEDS)]
    change = max(float(abs(trace(o) / value - 1).mid()) for o in others if o is not None)
    return dict(exists=True, value=value, condition=10 * change / hard.SHARE)


def sampled_square(A, B, C, D):
    P = stein(A.transpose(), mid(B * B.transpose()))
    return None if P is None else mid(C * P * C.transpose() + D * D.transpose())


def minimal_h2(problem):
    """From the transfer function without what cancels."""
    N, D = hard.polynomials(problem)
    common = N.gcd(D)
    N, D = N / common, D / common
    N, D = (N[0], D[0]) if isinstance(N, tuple) else (N, D)
    if D.degree() <= 0 or N == 0:
        return dict(exists=True, value=flint.arb(0), condition=1e4)
    if D[0] == 0:
        return dict(exists=True, value='infinite', condition=1.0)
    n, lead = D.degree(), D[D.degree()]
    A = flint.arb_mat([[flint.arb(int(j == i + 1)) if i < n - 1 else flint.arb(-D[j] / lead) for j in range(n)] for i in range(n)])
    B = flint.arb_mat([[flint.arb(int(i == n - 1))] for i in range(n)])
    C = flint.arb_mat([[flint.arb(N[j] / lead) for j in range(n)]])
    P = lyapunov(A.transpose(), mid(B * B.transpose()), 1.0)
    return dict(exists=None) if P is None else dict(exists=True, value=(C * P * C.transpose())[0, 0].sqrt().mid(), condition=1e6)


def h2_error(answer, reference, problem):
    found = answer.get('value')
    if reference['value'] == 'infinite':
        return 0.0 if found is None and answer.get('infinite') else float('inf')
    if found is None:
        return float('inf')
    exact = reference['value']
    return float(abs(flint.arb(found) / exact - 1).mid()) if float(exact) else abs(found)


# --- sampling ---------------------------------------------------------------------------------------------------------------

ANGLES = (0.01, 0.3, 1.0, 2.0, 3.0)


def exponential(blocks):
    """exp of a block matrix of long numbers."""
    rows = []
    for line in blocks:
        for i in range(line[0].nrows()):
            rows.append([M[i, j] for M in line for j in range(M.ncols())])
    return mid(flint.arb_mat(rows).exp())


def block(M, i, j, rows, cols):
    return flint.arb_mat([[M[i + a, j + b] for b in range(cols)] for a in range(rows)])


def zero(rows, cols):
    return flint.arb_mat([[flint.arb(0)] * cols for _ in range(rows)])


def response(A, B, C, D, z):
    """C (z I - A)^-1 B + D for complex long matrices B and D."""
    n = A.nrows()
    A, C = flint.acb_mat(A), flint.acb_mat(C)
    shifted = flint.acb_mat([[(z if i == j else flint.acb(0)) - A[i, j] for j in range(n)] for i in range(n)])
    return (C * shifted.solve(flint.acb_mat(B)) + flint.acb_mat(D)).mid()


def held(A, B, t):
    n, m = A.nrows(), B.ncols()
    E = exponential([[A * t, B * t], [zero(m, n), zero(m, m)]])
    return block(E, 0, 0, n, n), block(E, 0, n, n, m)


def sampled_responses(problem, random=None):
    A, B, C, D = (flint.arb_mat([[flint.arb(e) for e in row] for row in fractions(problem[k], random)]) for k in 'ABCD')
    h, n, m = flint.arb(problem['h']), A.nrows(), B.ncols()
    found = []
    for angle in ANGLES:
        z = flint.acb(0, angle).exp()
        if problem['method'] == 'tustin':
            found.append(response(A, B, C, D, 2 / h * (z - 1) / (z + 1)))
        elif problem['method'] == 'foh':
            E = exponential([[A * h, B * h, zero(n, m)], [zero(m, n), zero(m, m), eye(m)], [zero(m, n), zero(m, m), zero(m, m)]])
            H0, H1 = block(E, 0, n, n, m), block(E, 0, n + m, n, m)
            found.append(response(block(E, 0, 0, n, n), flint.acb_mat(H0) + flint.acb_mat(H1) * (z - 1), C, D, z))
        elif 'delay' in problem:
            whole = int(problem['delay'] // problem['h'])
            share = flint.arb(problem['delay']) - whole * h
            F, late = held(A, B, mid_of(h - share))
            _, early = held(A, B, mid_of(share))
            turn = z ** -whole
            input_matrix = (flint.acb_mat(late) + flint.acb_mat(F * early) * (1 / z)) * turn
            found.append(response(held(A, B, h)[0], input_matrix, C, flint.acb_mat(D) * (turn / z if share > 0 else turn), z))
        else:
            F, H = held(A, B, h)
            found.append(response(F, H, C, D, z))
    return found


def mid_of(number):
    return number.mid() if hasattr(number, 'mid') else number


def size_of(M):
    return max(float(abs(M[i, j]).mid()) for i in range(M.nrows()) for j in range(M.ncols()))


def distance(found, exact):
    return max(size_of((a - b).mid()) / max(size_of(b), 1e-300) for a, b in zip(found, exact))


def c2d(problem):
    exact = sampled_responses(problem)
    change = max(distance(sampled_responses(problem, np.random.default_rng(seed)), exact) for seed in range(SEEDS))
    return dict(exists=True, values=exact, condition=10 * change / hard.SHARE)


def c2d_error(answer, reference, problem):
    if 'A' not in answer:
        return float('inf')
    if not answer['A']:
        return 0.0
    at = lambda M: [response(*M, flint.acb(0, angle).exp()) for angle in ANGLES]
    r, found = np.random.default_rng(7), at([long(answer[k]) for k in 'ABCD'])
    rounded = lambda M: long((np.array(M, float) * (1 + 2.0 ** -52 * r.integers(-1, 2, np.shape(M)))).tolist())
    # What rounding the entries of the sampled system changes cannot be asked of it.
    noise = max(distance(at([rounded(answer[k]) for k in 'ABCD']), found) for _ in range(SEEDS))
    return max(0.0, distance(found, reference['values']) - 10 * noise)


# --- reduction ----------------------------------------------------------------------------------------------------------------

def balred(problem):
    if problem.get('rigid'):
        return dict(exists=True, rigid=True, condition=1.0)
    A, B, C = (long(problem[k]) for k in 'ABC')
    gamma = max(1e-6, float(np.sqrt(largest(A))))
    P, W = lyapunov(A.transpose(), mid(B * B.transpose()), gamma), lyapunov(A, mid(C.transpose() * C), gamma)
    if P is None or W is None:
        return dict(exists=False)
    values = hankel_values(P, W)
    change = 0.0
    for seed in range(SEEDS):
        A1, B1, C1, _ = matrices({k: v for k, v in problem.items() if k != 'period'}, np.random.default_rng(seed))
        P1, W1 = lyapunov(A1.transpose(), mid(B1 * B1.transpose()), gamma), lyapunov(A1, mid(C1.transpose() * C1), gamma)
        if P1 is not None and W1 is not None:
            change = max([change] + [float(abs(a - b).mid()) for a, b in zip(hankel_values(P1, W1), values)])
    return dict(exists=True, hankel=[float(v) for v in values], condition=max(1e3, 10 * change / max(float(values[0]), 1e-300) / hard.SHARE))


def hankel_values(P, W):
    """The square roots of the eigenvalues of a product of Gramians, largest first."""
    return sorted((abs(v).sqrt().mid() for v in flint.acb_mat(mid(P * W)).eig(algorithm='approx')), key=float, reverse=True)


def balred_error(answer, reference, problem):
    """The largest error of a Hankel value over the first; a wrong count of free states, an error measured too low or a bound below it count as 1."""
    if 'hankel' not in answer:
        return float('inf')
    pair = difference(problem, answer)
    if reference.get('rigid'):
        if answer['untouched'] != problem['rigid']:
            return 1.0
        systems = [matrices(M) for M in (pair, problem, rounded_difference(problem))]
        gains = [[float(gain(system, flint.acb(0, w))) for system in systems] for w in np.logspace(-3, 5, 25)]
        return 1.0 if any(g > answer['measured'] * (1 + 1e-6) + 1e-9 * of + 1e3 * noise for g, of, noise in gains) else 0.0
    exact = reference['hankel']
    if len(answer['hankel']) != len(exact):
        return 1.0
    first = max(exact[0], 1e-300)
    real = float(norm(pair)) if answer['kept'] else None
    noise = 1e2 * float(norm(rounded_difference(problem))) + 1e-11 * first
    low = real is not None and answer['measured'] < real * (1 - 1e-6) - noise
    loose = answer['bound'] is not None and answer['bound'] < answer['measured'] * (1 - 1e-6) - noise
    return 1.0 if low or loose else max(abs(a - b) for a, b in zip(answer['hankel'], exact)) / first


def rounded_difference(problem):
    """The system minus itself with every entry changed by one rounding."""
    r = np.random.default_rng(5)
    change = lambda key: (lambda M: M * (1 + 2.0 ** -52 * r.integers(-1, 2, M.shape)))(np.atleast_2d(np.array(problem[key], float)))
    return difference(problem, {key: change(key).tolist() for key in 'ABCD'})


def difference(problem, answer):
    """The system minus the reduced one."""
    get = lambda source, key: np.atleast_2d(np.array(source[key], float))
    A, B, C, D = (get(problem, k) for k in 'ABCD')
    r = len(answer['A'])
    if r == 0:
        return dict(A=A, B=B, C=C, D=D - get(answer, 'D'))
    a, b, c, d = (get(answer, k) for k in 'ABCD')
    n = len(A)
    return dict(A=np.block([[A, np.zeros((n, r))], [np.zeros((r, n)), a]]), B=np.r_[B, b], C=np.c_[C, -c], D=D - d)


def minimal(problem):
    """The rank of the Hankel matrix of Markov parameters, exact."""
    A, B, C = (flint.fmpq_mat(fractions(problem[k])) for k in 'ABC')
    n, parameters, x = A.nrows(), [], B
    for _ in range(2 * n):
        parameters.append((C * x)[0, 0])
        x = A * x
    return dict(exists=True, order=flint.fmpq_mat([[parameters[i + j] for j in range(n)] for i in range(n)]).rank(), condition=1.0)


def minimal_error(answer, reference, problem):
    return 0.0 if 'A' in answer and len(answer['A']) == reference['order'] else 1.0


KINDS = dict(delayed=delayed, mzeros=mzeros, bounds=bounds, mh2=h2, c2d=c2d, c2d_delayed=c2d, balred=balred, minimal=minimal, multiloop=multiloop)
ERRORS = dict(delayed=delayed_error, mzeros=mzeros_error, bounds=bounds_error, mh2=h2_error, c2d=c2d_error,
              c2d_delayed=c2d_error, balred=balred_error, minimal=minimal_error, multiloop=multiloop_error)
