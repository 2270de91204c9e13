#!/usr/bin/env python3
"""Zeros and norms of published examples, whose data lie beside the checkout in ../shared/benchmarks, against exact or long references.

  cargo build --release -p counterpoise-tests --example hard-problems
  python3 tests/peers/linear/published.py

Needs numpy, scipy and python-flint. The zeros are those of the aircraft of CAREX 2.9 (55 states, two inputs) with all ten outputs and with pairs of them; the
exact ones are roots of minors in fractions. The norm is that of the error that balanced truncation to four states leaves of the model `pde`; it is
sought on a grid that is refined about its highest point."""
import json, os

import numpy as np
import scipy.io

import hard
import wide_references

SHARED = os.path.join(os.path.dirname(hard.ROOT), 'shared', 'benchmarks')
PAIRS = ((0, 1), (2, 5), (3, 7), (8, 9))


def aircraft():
    """Each choice of outputs: the number of zeros, and the largest relative error."""
    with open(os.path.join(SHARED, 'riccati', 'carex.json')) as file:
        data = json.load(file)['carex_2_9']
    rows = len(data['C'])
    for chosen in (tuple(range(rows)), *PAIRS):
        C = [data['C'][i] for i in chosen]
        problem = dict(kind='mzeros', A=data['A'], B=data['B'], C=C, D=np.zeros((len(C), len(data['B'][0]))).tolist(), family='planted')
        answer, = hard.ours([problem])
        reference = wide_references.mzeros(problem)
        error = wide_references.mzeros_error(answer, reference, problem)
        print(f"CAREX 2.9, outputs {chosen}: {len(answer.get('values', []))} zeros of {len(reference['values'])}, largest relative error {error:.1e}")


def truncated():
    data = scipy.io.loadmat(os.path.join(SHARED, 'reduction', 'pde.mat'))
    A, B, C = (np.array(data[key].todense() if hasattr(data[key], 'todense') else data[key], float) for key in 'ABC')
    problem = dict(kind='balred', A=A.tolist(), B=B.tolist(), C=C.tolist(), D=np.zeros((len(C), B.shape[1])).tolist(), order=4)
    answer, = hard.ours([problem])
    a, b, c, d = (np.array(answer[key], float) for key in 'ABCD')

    def gain(w):
        response = lambda A, B, C: C @ np.linalg.solve(1j * w * np.eye(len(A)) - A, B)
        return np.linalg.norm(response(A, B, C) - response(a, b, c) - d, 2)
    rates = np.logspace(-2, 4, 3000)
    for _ in range(6):
        values = np.array([gain(w) for w in rates])
        k = int(values.argmax())
        rates = np.linspace(rates[max(k - 1, 0)], rates[min(k + 1, len(rates) - 1)], 60)
    print(f"pde by four states: error measured {answer['measured']:.9e}, highest on the grid {values.max():.9e}, ratio {answer['measured'] / values.max():.12f}")


if __name__ == '__main__':
    aircraft()
    truncated()
