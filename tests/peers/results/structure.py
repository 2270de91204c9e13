"""Modes of a structure from the matrices of its finite elements, and frequencies of a bare beam from its sections by elements that are
written here anew, from the JSON result of `counterpoise model` alone.
"""

import math

import numpy as np
import scipy.linalg

# Two solvers of the same eigenvalue problem; a light mode beside a stiff one loses digits.
EIGENVALUES = 1e-6
# What is orthogonal to the rigid motion is rounding of this share of the whole mass.
ORTHOGONAL = 1e-8
# Cubic elements on the same nodes.
ELEMENTS = 1e-6
GAUSS = np.polynomial.legendre.leggauss(8)


def symmetric(entries, size):
    out = np.zeros((size, size))
    out[entries["rows"], entries["columns"]] = entries["values"]
    return np.triu(out) + np.triu(out, 1).T


def modes_of(M, K, rigid, held):
    """Flexible frequencies and shapes with the held unknowns at rest, and the rigid motion taken out of the shapes."""
    free = [k for k in range(len(M)) if k not in held]
    M_, K_ = M[np.ix_(free, free)], K[np.ix_(free, free)]
    if np.min(np.diag(M_)) > 0.0:
        values, vectors = scipy.linalg.eigh(K_, M_)
    else:
        # unknowns without mass: 1 / (value + shift) are those of the inverse problem
        shift = np.max(np.diag(K_)[np.diag(M_) > 0.0] / np.diag(M_)[np.diag(M_) > 0.0]) * (2.0 / len(M)) ** 4
        inverse, vectors = scipy.linalg.eigh(M_, K_ + shift * M_)
        kept = np.argsort(-inverse)[: int(np.sum(np.diag(M_) > 0.0))]
        values, vectors = 1.0 / inverse[kept] - shift, vectors[:, kept]
    shapes = np.zeros((len(M), len(values)))
    shapes[free] = vectors
    basis = []
    for motion in rigid:
        for before in basis:
            motion = motion - before * (before @ M @ motion)
        basis.append(motion / math.sqrt(motion @ M @ motion))
    for k in range(len(basis), len(values)):
        for motion in basis:
            shapes[:, k] -= motion * (motion @ M @ shapes[:, k])
        shapes[:, k] /= math.sqrt(shapes[:, k] @ M @ shapes[:, k])
    return np.sqrt(np.maximum(values[len(basis) :], 0.0)), shapes[:, len(basis) :]


def modes(structure):
    elements = structure["elements"]
    heave, pitch = np.array(elements["heave"]), np.array(elements["pitch"])
    M, K = symmetric(elements["M"], len(heave)), symmetric(elements["K"], len(heave))
    for found in structure["modes"]:
        support = found["support"]
        rigid = {"free": [heave, pitch], "pinned": [pitch], "clamped": []}[support]
        held = elements["hub"][: {"free": 0, "pinned": 1, "clamped": 2}[support]]
        rates, shapes = modes_of(M, K, rigid, held)
        for k, mode in enumerate(found["modes"]):
            name = f"{support} mode {k + 1}"
            yield f"frequency of {name}, Hz", mode["frequency_hz"], rates[k] / (2.0 * math.pi), EIGENVALUES
            for key, motion in (("effective_mass_kg", heave), ("effective_inertia_kg_m2", pitch)):
                whole = motion @ M @ motion
                mine = (shapes[:, k] @ M @ motion) ** 2
                yield f"{key} of {name}, over the whole", 1.0, 1.0 + (mine - mode[key]) / whole, ORTHOGONAL


def dimensions(section, x):
    t = (x - section["from_m"]) / (section["to_m"] - section["from_m"])
    return [near + (far - near) * t for near, far in section["dimensions"]]


def cross_section(shape, values):
    a, b = values
    if shape == "tube":
        return math.pi / 4.0 * (a * a - b * b), math.pi / 64.0 * (a**4 - b**4)
    return (a * b, b * a**3 / 12.0) if shape == "rectangle" else (a, b)


def nodes(beam, count):
    """Nodes at the ends of sections, further ones where elements are longest; equal elements if there are fewer than sections."""
    ends = [section["from_m"] for section in beam["sections"]] + [beam["sections"][-1]["to_m"]]
    stations = ends if count >= len(ends) - 1 else [ends[0], ends[-1]]
    lengths, parts = np.diff(stations), np.ones(len(stations) - 1, dtype=int)
    for _ in range(len(parts), count):
        # the first of the longest, as rounding leaves it
        parts[int(np.argmax(lengths / parts))] += 1
    inside = [a + (b - a) / n * np.arange(n) for a, b, n in zip(stations, stations[1:], parts)]
    return np.concatenate(inside + [[stations[-1]]])


def mean_cross_section(beam, start, end):
    """Mean dimensions of the pieces of one element; sections of different shapes add up."""
    area = {}
    for section in beam["sections"]:
        a, b = max(section["from_m"], start), min(section["to_m"], end)
        if b - a > 1e-9 * (end - start):
            weighed = np.array(dimensions(section, 0.5 * (a + b))) * (b - a) / (end - start)
            area[section["shape"]] = area.get(section["shape"], 0.0) + weighed
    return np.sum([cross_section(shape, values) for shape, values in area.items()], axis=0)


def bare(beam, kind, count):
    """Flexible frequencies of the beam, free at both ends, in Hz."""
    x = nodes(beam, count)
    M, K = np.zeros((2 * len(x), 2 * len(x))), np.zeros((2 * len(x), 2 * len(x)))
    for k, (start, end) in enumerate(zip(x, x[1:])):
        length, rows = end - start, slice(2 * k, 2 * k + 4)
        mean = mean_cross_section(beam, start, end)
        for section in beam["sections"]:
            a, b = max(section["from_m"], start), min(section["to_m"], end)
            if b - a <= 1e-9 * length:
                continue
            for point, weight in zip(*GAUSS):
                place = 0.5 * (a + b) + 0.5 * (b - a) * point
                s, weight = (place - start) / length, 0.5 * (b - a) * weight
                area, second = mean if kind == "uniform" else cross_section(section["shape"], dimensions(section, place))
                w = np.array([1 - 3 * s**2 + 2 * s**3, length * s * (1 - s) ** 2, 3 * s**2 - 2 * s**3, length * s**2 * (s - 1)])
                bent = np.array([12 * s - 6, length * (6 * s - 4), 6 - 12 * s, length * (6 * s - 2)]) / length**2
                M[rows, rows] += weight * beam["density_kg_m3"] * area * np.outer(w, w)
                K[rows, rows] += weight * beam["youngs_modulus_pa"] * second * np.outer(bent, bent)
    heave, pitch = np.tile([1.0, 0.0], len(x)), np.ravel(np.column_stack([x, np.ones(len(x))]))
    return modes_of(M, K, [heave, pitch], [])[0] / (2.0 * math.pi)


def meshes(structure):
    table, beam = structure["meshes"], structure["beam"]
    reference = bare(beam, "tapered", table["reference"])
    for k, told in enumerate(table["reference_hz"]):
        yield f"bare beam of {table['reference']} elements, mode {k + 1}, Hz", told, reference[k], ELEMENTS
    for column in table["columns"] + table["finer"]:
        found = bare(beam, column["kind"], column["elements"])
        for k, told in enumerate(column["ratios"]):
            yield f"{column['elements']} {column['kind']} elements, mode {k + 1}, ratio", told, found[k] / reference[k], ELEMENTS


def rows(result):
    structure = result.get("structure")
    if structure and structure["modes"]:
        yield from modes(structure)
    if structure and structure.get("meshes"):
        yield from meshes(structure)
