#!/usr/bin/env python3
"""Inputs on which answers in doubles are likely to be wrong, with references of 1000 bits or exact fractions: see WIDE.md.

  cargo build --release -p counterpoise-tests --example hard-problems
  python3 tests/peers/linear/frontier.py [--kinds c2d,norms,...] [--families NAME,...] [--count 20] [--first 0] [--show] [--out FILE]

Needs what hard.py needs. The judge is that of wide.py; the families are those of frontier_families.py: chains of up to forty states, rods in physical units, peaks
that differ by 1e-3 to 1e-13 of their height, nearly all-pass systems, lags and modes over twelve decades in units over twelve more, poles at and
beside plus and minus one, free bodies with springs over twelve decades, and nearly singular matrices E."""
import composed_references  # noqa: F401: adds its kinds to wide_references
import frontier_families
import wide

if __name__ == '__main__':
    wide.main(frontier_families.FAMILIES, __doc__)
