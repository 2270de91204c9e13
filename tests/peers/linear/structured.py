#!/usr/bin/env python3
"""Problems whose structure fast formulas may overlook, with references of 1000 bits or exact fractions: see WIDE.md.

  cargo build --release -p counterpoise-tests --example hard-problems
  python3 tests/peers/linear/structured.py [--kinds c2d,gcare,...] [--families NAME,...] [--count 20] [--first 0] [--show] [--out FILE]

Needs what hard.py needs. The judge is that of wide.py; the families are those of structured_families.py: chains whose largest ways are not the shortest,
delays beside whole periods, equations with E in units over twelve decades, poles over six decades, nearly parallel inputs, copies of one system in
parallel, loops through ill-conditioned gains, and syntheses with a weak control or one fast unstable pole."""
import composed_references  # noqa: F401: adds its kinds to wide_references
import structured_families
import wide

FLOOR = dict(place=1e-9, level=1e-3)

if __name__ == '__main__':
    wide.FLOOR.update(FLOOR)
    wide.main(structured_families.FAMILIES, __doc__)
