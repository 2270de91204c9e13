"""References of 300 digits, errors against them, and the peers: see hard.py."""
import flint
import numpy as np
import scipy.linalg as sla

try:
    import slycot
except ImportError:
    slycot = None

BITS = 1000
flint.ctx.prec = BITS


# --- matrices of long numbers ------------------------------------------------------------------------------------------

def long(M):
    """The doubles as exact long numbers."""
    M = np.atleast_2d(np.array(M, float))
    return flint.arb_mat([[flint.arb(float(e)) for e in row] for row in M])


def plain(M):
    return np.array([[float(M[i, j].mid()) for j in range(M.ncols())] for i in range(M.nrows())])


def eye(n, factor=1):
    return flint.arb_mat([[flint.arb(factor if i == j else 0) for j in range(n)] for i in range(n)])


def mid(M):
    """Without the error bounds, which grow although the numbers are good."""
    return M.mid()


def solve(A, B):
    try:
        return mid(A.solve(B))
    except ZeroDivisionError:
        return None


def largest(M):
    return max([abs(float(e.mid())) for row in M.tolist() for e in row] or [0.0])


def stein(A, Q):
    """The sum of (A')^k Q A^k; None if it does not converge."""
    for _ in range(200):
        Q, A = mid(Q + A.transpose() * Q * A), mid(A * A)
        size = largest(A)
        if size < 1e-150:
            return Q
        if not size < 1e150:
            return None
    return None


def lyapunov(A, Q, gamma=1.0):
    """X with A'X + XA + Q = 0 for a stable A; None for another."""
    n = A.nrows()
    M = solve(mid(A - eye(n, gamma)), eye(n))
    if M is None:
        return None
    return stein(mid(eye(n) + 2 * gamma * M), mid(2 * gamma * M.transpose() * Q * M))


def doubling(A, G, Q):
    n = A.nrows()
    for _ in range(200):
        W = solve(mid(eye(n) + G * Q), eye(n))
        if W is None:
            return None
        WA, WG = mid(W * A), mid(W * G)
        step = mid(A.transpose() * Q * WA)
        Q, G, A = mid(Q + step), mid(G + A * WG * A.transpose()), mid(A * WA)
        change, size = largest(step), largest(Q)
        if not change < 1e290:
            return None
        if change <= 1e-120 * size:
            return Q
    return None


def newton(A, G, Q, X, steps=8):
    """Newton's method; None if the closed loop is not stable."""
    for _ in range(steps):
        closed = mid(A - G * X)
        residual = mid(A.transpose() * X + X * A - X * G * X + Q)
        gamma = max(1e-3, float(np.sqrt(largest(closed))))
        E = lyapunov(closed, residual, gamma)
        if E is None:
            return None
        X = mid(X + E)
        if largest(E) <= 1e-60 * largest(X):
            return mid((X + X.transpose()) / 2)
    return None


def care_reference(A, G, Q):
    size = max(largest(A), np.sqrt(largest(G) * largest(Q)), 1e-12)
    n = A.nrows()
    for gamma in (size, 0.1 * size, 1e-3 * size, 1e-6 * size):
        shifted = mid(A - eye(n, gamma))
        inverse = solve(shifted, eye(n))
        if inverse is None:
            continue
        AG = mid(inverse * G)
        W = solve(mid(shifted.transpose() + Q * AG), eye(n))
        if W is None:
            continue
        X = doubling(mid(eye(n) + 2 * gamma * W.transpose()), mid(2 * gamma * AG * W), mid(2 * gamma * W * Q * inverse))
        if X is not None:
            X = newton(A, G, Q, mid((X + X.transpose()) / 2))
        if X is not None:
            return X
    return from_bass(A, G, Q)


def from_bass(A, G, Q):
    """Newton's method from Bass's start, whose closed loop is stable if G >= 0 reaches every mode."""
    n = A.nrows()
    shift = 2 * max(largest(A), 1e-12) * n
    Z = lyapunov(mid(-(A + eye(n, shift)).transpose()), mid(2 * G), np.sqrt(largest(A) + shift))
    X = solve(Z, eye(n)) if Z is not None else None
    return newton(A, G, Q, mid((X + X.transpose()) / 2), 300) if X is not None else None


def dare_residual(A, B, Q, R, X):
    K = solve(mid(R + B.transpose() * X * B), mid(B.transpose() * X * A))
    if K is None:
        return None, None
    closed = mid(A - B * K)
    return mid(closed.transpose() * X * closed - X + Q + K.transpose() * R * K), closed


def dare_reference(A, B, Q, R):
    n = A.nrows()
    for shift in (0, 1.37 * largest(Q), -0.83 * largest(Q), 97.0 * largest(Q), 1e-3 * largest(Q)):
        Rs, Qs = mid(R + shift * B.transpose() * B), mid(Q + shift * (A.transpose() * A - eye(n)))
        S = mid(shift * A.transpose() * B)
        BS = solve(Rs, mid(B.transpose()))
        if BS is None or not largest(BS) < 1e280:
            continue
        SR = solve(Rs, mid(S.transpose()))
        X = doubling(mid(A - B * SR), mid(B * BS), mid(Qs - S * SR))
        if X is None:
            continue
        X = mid(X + eye(n, shift))
        for _ in range(8):
            residual, closed = dare_residual(A, B, Q, R, X)
            E = stein(closed, residual) if closed is not None else None
            if E is None:
                break
            X = mid(X + E)
            if largest(E) <= 1e-60 * largest(X):
                return mid((X + X.transpose()) / 2)
    return None


# --- references by kind --------------------------------------------------------------------------------------------------

def data(problem, *keys):
    return [long(problem[key]) for key in keys]


def condition_continuous(A, G, Q, X, moduli=None):
    """Kenney and Hewer's estimate, in doubles of long solutions; scaled by the diagonal of X. `moduli` are those of A and Q as they are
    summed from the data."""
    closed, n = mid(A - G * X), A.nrows()
    gamma = max(1e-3, float(np.sqrt(largest(closed))))
    d = [max(abs(float(X[i, i].mid())), 1e-300) ** 0.5 for i in range(n)]
    # In units where each state of X has size one.
    a, q = moduli if moduli else (absolute(A), absolute(Q))
    change = a.T @ absolute(X) + absolute(X) @ a + q + absolute(X) @ absolute(G) @ absolute(X)
    E = lyapunov(closed, long(change), gamma)
    return 1.0 if E is None else float(np.max(np.abs(plain(E)) / np.outer(d, d)))


def absolute(M):
    return np.abs(plain(M))


def abs_product(A, X):
    return absolute(A).T @ absolute(X)


def reference(kind, problem):
    """What is exact: `exists`, `X` or another value, and `condition`, how much rounding the data changes it."""
    kind = problem['kind']
    if problem.get('exists') is False:
        return dict(exists=False)
    if kind in ('care', 'care_g'):
        A, Q = data(problem, 'A', 'Q')
        if kind == 'care':
            B, R = data(problem, 'B', 'R')
            G = mid(B * solve(R, mid(B.transpose())))
        else:
            G, = data(problem, 'G')
        X = care_reference(A, G, Q)
        return dict(exists=None) if X is None else dict(exists=True, X=plain(X), condition=condition_continuous(A, G, Q, X))
    if kind == 'dare':
        A, B, Q, R = data(problem, 'A', 'B', 'Q', 'R')
        X = dare_reference(A, B, Q, R)
        return dict(exists=None) if X is None else dict(exists=True, X=plain(X), condition=condition_discrete(A, B, Q, R, X))
    if kind in ('gcare', 'gdare', 'glyap'):
        return with_mass(kind, problem)
    if kind in ('lyap', 'dlyap'):
        A, Q = data(problem, 'A', 'Q')
        gamma = max(1e-6, float(np.sqrt(largest(A))))
        X = lyapunov(A.transpose(), Q, gamma) if kind == 'lyap' else stein(A.transpose(), Q)
        if X is None:
            return dict(exists=False)
        x, a = absolute(X), absolute(A)
        change = a @ x + x @ a.T if kind == 'lyap' else 2 * a @ x @ a.T
        change = long(change + absolute(Q))
        E = plain(lyapunov(A.transpose(), change, gamma) if kind == 'lyap' else stein(A.transpose(), change))
        d = np.sqrt(np.maximum(np.abs(np.diag(plain(X))), 1e-300))
        return dict(exists=True, X=plain(X), condition=float(np.max(np.abs(E) / np.outer(d, d))))
    return SYSTEMS[kind](problem)


def with_mass(kind, problem):
    """The reference of an equation with a matrix E, which is eliminated exactly."""
    A, E, Q = data(problem, 'A', 'E', 'Q')
    inverse = solve(E, eye(E.nrows()))
    e, i, a = absolute(E), absolute(inverse), absolute(A)
    if kind == 'glyap':
        A1, Q1 = mid(inverse * A), mid(inverse * Q * inverse.transpose())
        X = lyapunov(A1.transpose(), Q1, max(1e-6, float(np.sqrt(largest(A1)))))
        if X is None:
            return dict(exists=False)
        moduli = (i @ (a + e @ absolute(A1)), i @ absolute(Q) @ i.T)
        change = moduli[0] @ absolute(X) + absolute(X) @ moduli[0].T + moduli[1]
        error = plain(lyapunov(A1.transpose(), long(change), max(1e-6, float(np.sqrt(largest(A1))))))
        d = np.sqrt(np.maximum(np.abs(np.diag(plain(X))), 1e-300))
        return dict(exists=True, X=plain(X), condition=float(np.max(np.abs(error) / np.outer(d, d))))
    B, R = data(problem, 'B', 'R')
    A1, Q1 = mid(A * inverse), mid(inverse.transpose() * Q * inverse)
    moduli = ((a + absolute(A1) @ e) @ i, i.T @ absolute(Q) @ i)
    if kind == 'gcare':
        G = mid(B * solve(R, mid(B.transpose())))
        X = care_reference(A1, G, Q1)
        return dict(exists=None) if X is None else dict(exists=True, X=plain(X), condition=condition_continuous(A1, G, Q1, X, moduli))
    X = dare_reference(A1, B, Q1, R)
    if X is None:
        return dict(exists=None)
    growth = float(np.max(moduli[0] / np.maximum(absolute(A1), 1e-300)))
    return dict(exists=True, X=plain(X), condition=growth * condition_discrete(A1, B, Q1, R, X))


def condition_discrete(A, B, Q, R, X):
    _, closed = dare_residual(A, B, Q, R, X)
    c, x = absolute(closed), absolute(X)
    K = np.abs(plain(solve(mid(R + B.transpose() * X * B), mid(B.transpose() * X * A))))
    a, b = absolute(A), absolute(B)
    inner = a + b @ K
    change = c.T @ x @ inner + inner.T @ x @ c + absolute(Q) + K.T @ absolute(R) @ K
    E = stein(closed, long(change))
    d = np.sqrt(np.maximum(np.abs(np.diag(plain(X))), 1e-300))
    return 1.0 if E is None else float(np.max(np.abs(plain(E)) / np.outer(d, d)))


# --- systems with one input and one output, by exact polynomials -------------------------------------------------------------

SHARE = 2.0 ** -90


def exact(M, random=None, share=SHARE):
    """The doubles as fractions, each changed by at most a share, a power of two, if random numbers are given."""
    change = lambda: flint.fmpq(1) if random is None else 1 + flint.fmpq(int(random.integers(-1000, 1001)), 1000) / int(1 / share)
    return [[flint.fmpq(*float(e).as_integer_ratio()) * change() for e in row] for row in np.atleast_2d(np.array(M, float))]


def with_condition(reference_of, error_of, as_answer):
    """A reference with the condition found by changing every entry of the data by a tiny share."""
    def made(problem):
        found = reference_of(problem)
        others = [reference_of(dict(problem, random=np.random.default_rng(seed))) for seed in range(3)]
        change = max(error_of(as_answer(other), found) for other in others)
        return dict(found, condition=10 * change / SHARE if np.isfinite(change) else 1e16)
    return made


def polynomials(problem):
    """Numerator and denominator of the transfer function as exact polynomials, coefficients from the lowest."""
    A, B, C, D = (exact(problem[k], problem.get('random'), problem.get('share', SHARE)) for k in 'ABCD')
    n = len(A)
    denominator = flint.fmpq_mat(A).charpoly()
    closed = flint.fmpq_mat([[A[i][j] - B[i][0] * C[0][j] for j in range(n)] for i in range(n)]).charpoly()
    return closed + (D[0][0] - 1) * denominator, denominator


def roots(polynomial):
    """All roots with multiplicity, as complex doubles of exact balls."""
    found = []
    for root, times in polynomial.complex_roots():
        found += [root.mid()] * times
    return found


def positive(polynomial):
    """The positive real roots of odd multiplicity and others alike."""
    found = []
    for root, _ in polynomial.complex_roots():
        if root.imag.contains(0) and root.real > 0:
            found.append(root.real.mid())
    return sorted(found, key=float)


def on_axis(problem):
    """|N|^2, |D|^2 and Im(N conj(D))/w on the axis (or on the unit circle by z = (1+s)/(1-s)), polynomials in w^2."""
    N, D = polynomials(problem)
    if 'period' in problem:
        degree = len(problem['A'])
        up, down = flint.fmpq_poly([1, 1]), flint.fmpq_poly([1, -1])
        turn = lambda P: sum((P[k] * up ** k * down ** (degree - k) for k in range(degree + 1)), flint.fmpq_poly([0]))
        N, D = turn(N), turn(D)
    split = lambda P: (flint.fmpq_poly([P[k] * (-1) ** (k // 2) for k in range(0, P.degree() + 1, 2)] or [0]),
                       flint.fmpq_poly([P[k] * (-1) ** (k // 2) for k in range(1, P.degree() + 1, 2)] or [0]))
    (Ne, No), (De, Do), x = split(N), split(D), flint.fmpq_poly([0, 1])
    return Ne * Ne + x * No * No, De * De + x * Do * Do, No * De - Ne * Do, Ne * De + x * No * Do


def rate(x, problem):
    w = x.sqrt().mid()
    return (2 * w.atan() / flint.arb(problem['period'])).mid() if 'period' in problem else w


def normwise(problem, w):
    """The sum of the products of norms that make the response at a rate, of balanced matrices. In long numbers: far below rigid-body poles that
    rounding the data has moved, solutions in doubles are too small by many decades."""
    A, B, C, D = (np.atleast_2d(np.array(problem[k], float)) for k in 'ABCD')
    A, T = sla.matrix_balance(A, permute=False)
    d, n = np.diag(T), len(A)
    B, C = B / d[:, None], C * d
    w = flint.arb(w)
    s = flint.acb(0, w * flint.arb(problem['period'])).exp() if 'period' in problem else flint.acb(0, w)
    M = flint.acb_mat([[(s if i == j else flint.acb(0)) - A[i, j] for j in range(n)] for i in range(n)])
    size = lambda X: float(sum((abs(X[i, 0]) ** 2 for i in range(n)), flint.arb(0)).sqrt().mid())
    try:
        x, y = (size(N.solve(flint.acb_mat(b.tolist())).mid()) for N, b in ((M, B), (M.transpose(), C.T)))
    except ZeroDivisionError:
        return np.inf
    return y * (np.linalg.norm(A) + float(abs(s).mid())) * x + np.linalg.norm(C) * x + y * np.linalg.norm(B) + abs(D[0, 0])


def zeros_reference(problem):
    N, D = polynomials(problem)
    return dict(exists=True, values=roots(N) if N.degree() > 0 else [])


def distance(z, y):
    """|z - y| / |z| of long complex numbers."""
    size = float(abs(z).mid())
    return float(abs(z - y).mid()) / max(size, 1e-12)


def zeros_error(answer, reference):
    if 'values' not in answer:
        return float('inf')
    ours, worst = [flint.acb(*v) if isinstance(v, list) else v for v in answer['values']], 0.0
    if len(ours) != len(reference['values']):
        return 1e3
    for z in sorted(reference['values'], key=lambda z: float(abs(z).mid())):
        k = min(range(len(ours)), key=lambda k: float(abs(ours[k] - z).mid()))
        worst = max(worst, distance(z, ours.pop(k)))
    return worst


def margins_reference(problem):
    NN, DD, odd, even = on_axis(problem)
    if NN.degree() < 0 or NN == 0:
        return dict(exists=True, phase=[], gain=[])
    phase = sorted((rate(x, problem) for x in positive(NN - DD)), key=float) if NN != DD else None
    gain = [rate(x, problem) for x in positive(odd) if even(flint.fmpq(*float(x).as_integer_ratio())) < 0] if odd.degree() > 0 else []
    end = np.pi / problem['period'] if 'period' in problem else float('inf')
    found = dict(exists=True, phase=resolved(phase), gain=sorted(gain, key=float), end=end, phases=len(phase or []))
    if 'random' in problem:
        return found
    axis = [float(rate(x, problem)) for x in positive(odd)] if odd.degree() > 0 else []
    return dict(found, certain=certain_gains(problem, found['gain'], axis, end))


def resolved(rates):
    """Rates without pairs closer than 1e-9 of themselves, between which a pole and a zero cancel to nine digits."""
    kept = []
    for w in rates or []:
        if kept and float((w - kept[-1]) / w) < 1e-9:
            kept.pop()
        else:
            kept.append(w)
    return kept if rates is not None else None


def certain_gains(problem, rates, axis, end):
    """The gain crossings that the data determine, each with its uncertainty relative to its rate.

    `axis` are all rates at which the response is real. A backward stable evaluation changes the balanced matrices by some rounding errors of
    their norms. A crossing is determined if a hundred of them leave the sign of the imaginary part known somewhere on either side of it,
    before the response is real again."""
    N, D = polynomials(problem)
    noise = lambda w: 100 * 2.0 ** -53 * normwise(problem, w)
    imaginary = lambda w: abs(float(response((N, D), w, problem).imag.mid()))
    size = lambda w: float(abs(response((N, D), w, problem)).mid())
    certain = []
    for w in rates:
        if not 0.1 < size(w) / max(size(flint.arb(w) * (1 + 1e-9)), 1e-300) < 10:
            continue  # a pole or a zero on the axis, through which the response jumps to the other side
        low = max((x for x in axis if x < 0.999999999999 * w), default=1e-6 * float(w))
        high = min((x for x in axis if x > 1.000000000001 * w), default=min(end, 1e6 * float(w)))
        sides = [np.geomspace(low, float(w), 60)[1:-1], high - np.geomspace(high - float(w), 1e-6 * (high - float(w)), 60)[1:-1]]
        if all(any(imaginary(x) > noise(x) for x in side) for side in sides):
            step = 1e-9 * min(high - float(w), float(w) - low)
            slope = imaginary(flint.arb(w) + step) / step
            certain.append((w, noise(float(w)) / max(slope * float(w), 1e-300)))
    return certain


def response(loop, w, problem):
    """The response at a rate, from numerator and denominator, in long numbers."""
    s = flint.acb(0, flint.arb(w) * flint.arb(problem['period'])).exp() if 'period' in problem else flint.acb(0, flint.arb(w))
    top, bottom = (horner(P, s) for P in loop)
    return top / bottom


def horner(polynomial, s):
    total = flint.acb(0)
    for k in range(polynomial.degree(), -1, -1):
        total = total * s + flint.acb(polynomial[k])
    return total



def margins_error(answer, reference):
    """The largest relative distance of crossings; a crossing that is missing counts as 1, one that does not exist as 100."""
    if 'phase' not in answer:
        return float('inf')
    if reference['phase'] is None:
        return 0.0
    inside = lambda w: w is not None and 0 < w < reference.get('end', float('inf'))
    ours_of = dict(phase=[p[1] for p in answer['phase']], gain=[g[1] for g in answer['gain'] if inside(g[1])])
    worst = 0.0
    for name, ours in ours_of.items():
        demanded = reference['certain'] if name == 'gain' and 'certain' in reference else [(w, 0.0) for w in reference[name]]
        for w, slack in demanded:
            near = min((float((abs(flint.arb(o) - w) / w).mid()) for o in ours), default=1.0)
            worst = max(worst, min(near, 1.0) - min(slack, 0.5))
        if len(ours) > (reference.get('phases', 0) if name == 'phase' else len(reference[name])):
            worst = max(worst, 1e2)
    return worst


def linfnorm_reference(problem):
    NN, DD, _, _ = on_axis(problem)
    if NN == 0:
        return dict(exists=True, value=flint.arb(0))
    candidates = [value(NN, flint.arb(0)) / value(DD, flint.arb(0))]
    candidates += [value(NN, x) / value(DD, x) for x in positive(NN.derivative() * DD - NN * DD.derivative())]
    if NN.degree() == DD.degree():
        candidates.append(flint.arb(NN[NN.degree()] / DD[DD.degree()]))
    best = max(candidates, key=lambda v: float(v.mid()) if v.is_finite() else -1.0)
    return dict(exists=True, value=best.sqrt().mid())


def value(polynomial, x):
    total = flint.arb(0)
    for k in range(polynomial.degree(), -1, -1):
        total = total * x + flint.arb(polynomial[k])
    return total.mid()


def h2norm_reference(problem):
    A, B, C = data(problem, 'A', 'B', 'C')
    P = lyapunov(A.transpose(), mid(B * B.transpose()), max(1e-6, float(np.sqrt(largest(A)))))
    if P is None:
        return dict(exists=False)
    return dict(exists=True, value=float((C * P * C.transpose())[0, 0].sqrt().mid()), condition=1e5)


def value_error(answer, reference):
    found = answer.get('value')
    if found is None:
        return float('inf')
    exact_value = flint.arb(reference['value'])
    return float(abs(flint.arb(found) / exact_value - 1).mid()) if float(exact_value) else abs(found)


def descriptor_reference(problem):
    """The transfer function at three points, from the data before they were rotated."""
    keys = problem.get('plain') or [problem[k] for k in 'EABCD']
    values = []
    for s in ((0.3, 0.0), (0.0, 1.0), (2.0, 3.0)):
        s = flint.acb(*s)
        E, A, B, C, D = (flint.acb_mat([[flint.acb(float(e)) for e in row] for row in M]) for M in keys)
        values.append(complex((C * (E * s - A).solve(B) + D)[0, 0]))
    return dict(exists=True, values=values, condition=1e6 if problem.get('rotated') else 1e4)


def descriptor_error(answer, reference):
    if 'A' not in answer:
        return float('inf')
    A, B, C, D = (np.atleast_2d(np.array(answer[k], float)) for k in 'ABCD')
    n, worst = answer['A'] and len(answer['A']) or 0, 0.0
    for s, exact_value in zip((0.3, 1j, 2 + 3j), reference['values']):
        total = D[0, 0] + sum(np.array(M)[0, 0] * s ** (k + 1) for k, M in enumerate(answer['derivatives']))
        if n:
            total = total + (C.reshape(1, n) @ np.linalg.solve(s * np.eye(n) - A, B.reshape(n, 1)))[0, 0]
        worst = max(worst, abs(total - exact_value) / abs(exact_value))
    return worst


SYSTEM_ERRORS = dict(zeros=zeros_error, margins=margins_error, linfnorm=value_error, h2norm=value_error, descriptor=descriptor_error)
as_margins = lambda r: dict(phase=[(0, w, 0) for w in r['phase'] or []], gain=[(0, w) for w in r['gain']])
SYSTEMS = dict(zeros=with_condition(zeros_reference, zeros_error, lambda r: r),
               margins=with_condition(margins_reference, margins_error, as_margins),
               linfnorm=with_condition(linfnorm_reference, value_error, lambda r: r),
               h2norm=h2norm_reference, descriptor=descriptor_reference)


# --- errors --------------------------------------------------------------------------------------------------------------

def error(kind, answer, reference, problem):
    """The largest relative error of an answer (a dictionary of ours, or a peer's matrix)."""
    if not reference['exists'] or answer is None:
        return float('inf')
    if kind in SYSTEMS:
        return SYSTEM_ERRORS[kind](answer, reference)
    X = answer.get('X') if isinstance(answer, dict) else answer
    if X is None:
        return float('inf')
    X, exact = np.atleast_2d(np.array(X, float)), reference['X']
    if X.shape != exact.shape or not np.isfinite(X).all():
        return float('inf')
    d = np.sqrt(np.maximum(np.abs(np.diag(exact)), 1e-25 * np.abs(exact).max() + 1e-300))
    return float(np.max(np.abs((X + X.T) / 2 - exact) / np.outer(d, d)))


# --- peers ---------------------------------------------------------------------------------------------------------------

def peers(kind, problem):
    kind = problem['kind']
    if kind in SYSTEMS:
        return
    get = lambda key: np.atleast_2d(np.array(problem[key], float))
    A = get('A')
    n = len(A)
    if kind == 'care_g':
        if slycot:
            yield 'sb02md', lambda: slycot.sb02md(n, A, get('G'), get('Q'), 'C')[0]
        return
    if kind in ('care', 'dare'):
        B, Q, R = get('B'), get('Q'), get('R')
        letter = 'C' if kind == 'care' else 'D'
        yield 'scipy', lambda: (sla.solve_continuous_are if kind == 'care' else sla.solve_discrete_are)(A, B, Q, R)
        if slycot:
            yield 'sb02od', lambda: slycot.sb02od(n, B.shape[1], A, B, Q, R, letter)[0]
            if np.linalg.matrix_rank(R) == len(R):
                G = B @ np.linalg.solve(R, B.T)
                yield 'sb02md', lambda: slycot.sb02md(n, A, (G + G.T) / 2, Q, letter, sort='S' if kind == 'care' else 'U')[0]
        return
    if kind in ('gcare', 'gdare'):
        E = get('E')
        solver = sla.solve_continuous_are if kind == 'gcare' else sla.solve_discrete_are
        yield 'scipy', lambda: solver(A, get('B'), get('Q'), get('R'), e=E)
        return
    Q = get('Q')
    if kind == 'glyap':
        i = np.linalg.inv(get('E'))
        yield 'scipy', lambda: sla.solve_continuous_lyapunov(i @ A, -i @ Q @ i.T)
    elif kind == 'lyap':
        yield 'scipy', lambda: sla.solve_continuous_lyapunov(A, -Q)
    elif kind == 'dlyap':
        yield 'scipy', lambda: sla.solve_discrete_lyapunov(A, Q, method='bilinear')
