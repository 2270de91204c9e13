#!/usr/bin/env python3
"""Problems at the edges of what doubles can tell, with references of 1000 bits or exact fractions: see WIDE.md.

  cargo build --release -p counterpoise-tests --example hard-problems
  python3 tests/peers/linear/stress.py [--kinds care,zeros,...] [--families NAME,...] [--count 20] [--first 0] [--show] [--out FILE]

Needs what hard.py needs. The judge is that of wide.py; the families are those of stress_families.py: modes that the input hardly reaches, Jordan blocks of six
states or more, stiff structures with damping from 1e-9 to 1, chains of delays, weights over 32 decades, states out of reach or out of sight, twelve poles over
twelve decades, and several loops at once."""
import stress_families
import wide

if __name__ == '__main__':
    wide.main(stress_families.FAMILIES, __doc__)
