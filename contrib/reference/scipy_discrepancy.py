#!/usr/bin/env python3
"""Writes SciPy's discrepancies of point sets that the tests make for themselves.

A row is N, dimension, then SciPy's values of its methods CD, WD and MD, which are squares, and
L2-star, which is not. Coordinate a of point i is a multiple of 2^-16:
((i + 1)(a + 1) 40503 + 7919 i²) mod 2^16. Written with SciPy 1.17.1 by

    python3 contrib/reference/scipy_discrepancy.py > tests/reference/scipy_discrepancy.csv
"""

import numpy as np
from scipy.stats import qmc

SETS = [(1, 1), (1, 3), (7, 2), (64, 2), (33, 3), (128, 5), (16, 8), (300, 4)]
METHODS = ["CD", "WD", "MD", "L2-star"]


def points(n, dim):
    i, a = np.arange(n)[:, None], np.arange(dim)[None, :]
    return ((i + 1) * (a + 1) * 40503 + 7919 * i * i) % 2**16 / 2**16


print("n,dim,centred_sq,wrap_around_sq,mixture_sq,l2_star")
for n, dim in SETS:
    values = [float(qmc.discrepancy(points(n, dim), method=method)) for method in METHODS]
    print(n, dim, *map(repr, values), sep=",")
