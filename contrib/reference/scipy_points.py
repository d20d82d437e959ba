#!/usr/bin/env python3
"""Writes coordinates of SciPy's unscrambled Sobol' and Halton sequences, as the tests read them.

A row is sampler, dimension (from 0), index, coordinate. SciPy enumerates Sobol' points in Gray
code: its point k is number k XOR k/2 of the sequence. Written with SciPy 1.17.1 by

    python3 contrib/reference/scipy_points.py > tests/shelf/scipy_points.csv
"""

from scipy.stats import qmc

SOBOL_DIMS = [0, 1, 2, 3, 7, 31, 100, 511, 1023]
HALTON_DIMS = [0, 1, 2, 5, 30, 99]
STARTS = [0, 1000, 65_530, 1_000_003]
RUN = 6


def rows(name, make, dims, index_of):
    for start in STARTS:
        engine = make(max(dims) + 1)
        if start:
            engine.fast_forward(start)
        for k, point in enumerate(engine.random(RUN), start):
            for dim in dims:
                print(f"{name},{dim},{index_of(k)},{float(point[dim])!r}")


print("sampler,dim,index,coordinate")
rows("sobol", lambda d: qmc.Sobol(d, scramble=False), SOBOL_DIMS, lambda k: k ^ (k >> 1))
rows("halton", lambda d: qmc.Halton(d, scramble=False), HALTON_DIMS, lambda k: k)
