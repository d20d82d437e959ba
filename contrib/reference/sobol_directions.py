#!/usr/bin/env python3
"""Writes the first 1,024 rows of Joe and Kuo's new-joe-kuo-6 direction numbers.

SciPy carries the whole set as scipy/stats/_sobol_direction_numbers.npz. Written with SciPy
1.17.1 by

    python3 contrib/reference/sobol_directions.py > crates/stratcore/src/sampler/data/new-joe-kuo-6.1024.txt
"""

import os

import numpy as np
import scipy

N_DIMS = 1024

NOTICE = """\
Direction numbers of S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better
two-dimensional projections", SIAM J. Sci. Comput. 30 (2008), 2635-2654: the first
1,024 rows of new-joe-kuo-6.21201, https://web.maths.unsw.edu.au/~fkuo/sobol/

Copyright (c) 2008, Frances Y. Kuo and Stephen Joe
All rights reserved.

Redistribution and use in source and binary forms, with or without
modification, are permitted provided that the following conditions are met:

    * Redistributions of source code must retain the above copyright
      notice, this list of conditions and the following disclaimer.

    * Redistributions in binary form must reproduce the above copyright
      notice, this list of conditions and the following disclaimer in the
      documentation and/or other materials provided with the distribution.

    * Neither the names of the copyright holders nor the names of the
      University of New South Wales and the University of Waikato
      and its contributors may be used to endorse or promote products derived
      from this software without specific prior written permission.

THIS SOFTWARE IS PROVIDED BY THE COPYRIGHT HOLDERS ``AS IS'' AND ANY
EXPRESS OR IMPLIED WARRANTIES, INCLUDING, BUT NOT LIMITED TO, THE IMPLIED
WARRANTIES OF MERCHANTABILITY AND FITNESS FOR A PARTICULAR PURPOSE ARE
DISCLAIMED. IN NO EVENT SHALL THE COPYRIGHT HOLDERS BE LIABLE FOR ANY
DIRECT, INDIRECT, INCIDENTAL, SPECIAL, EXEMPLARY, OR CONSEQUENTIAL DAMAGES
(INCLUDING, BUT NOT LIMITED TO, PROCUREMENT OF SUBSTITUTE GOODS OR SERVICES;
LOSS OF USE, DATA, OR PROFITS; OR BUSINESS INTERRUPTION) HOWEVER CAUSED AND
ON ANY THEORY OF LIABILITY, WHETHER IN CONTRACT, STRICT LIABILITY, OR TORT
(INCLUDING NEGLIGENCE OR OTHERWISE) ARISING IN ANY WAY OUT OF THE USE OF THIS
SOFTWARE, EVEN IF ADVISED OF THE POSSIBILITY OF SUCH DAMAGE.

d s a m_1 ... m_s  (degree s, interior coefficients a of the primitive polynomial, initial m)"""


def main():
    path = os.path.join(os.path.dirname(scipy.__file__), "stats", "_sobol_direction_numbers.npz")
    with np.load(path) as numbers:
        polynomials, initial = numbers["poly"], numbers["vinit"]
    for line in NOTICE.split("\n"):
        print(f"# {line}".rstrip())
    # Row 1 is the van der Corput sequence: it has no polynomial.
    for d in range(2, N_DIMS + 1):
        polynomial = int(polynomials[d - 1])
        degree = polynomial.bit_length() - 1
        interior = (polynomial >> 1) & ((1 << (degree - 1)) - 1)
        m = " ".join(str(int(v)) for v in initial[d - 1][:degree])
        print(d, degree, interior, m)


main()
