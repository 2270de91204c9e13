#!/usr/bin/env python3
"""Systems composed of parts, and equations near what they cannot solve, with references of 1000 bits or exact fractions: see WIDE.md.

  cargo build --release -p counterpoise-tests --example hard-problems
  python3 tests/peers/linear/composed.py [--kinds care,zeros,...] [--families NAME,...] [--count 20] [--first 0] [--show] [--out FILE]

Needs what hard.py needs. The judge is that of wide.py; the families are those of composed_families.py: servos, lags, compensators and delays in series, side by
side and in loops; sums of Kronecker products and companion forms with clusters of eigenvalues; blocks ten decades apart; matrices E of condition 1e2 to 1e11;
Lyapunov equations beside singular ones; sampling of stiff plants with a share of a period as delay, its inverse and its cost; placement with inputs that repeat
each other; and H-infinity synthesis, whose least level is computed from its Riccati equations in 400 bits."""
import composed_families
import composed_references  # noqa: F401: adds its kinds to wide_references
import wide

FLOOR = dict(d2c=1e-10, cost=1e-11, place=1e-9, level=1e-3)

if __name__ == '__main__':
    wide.FLOOR.update(FLOOR)
    wide.main(composed_families.FAMILIES, __doc__)
