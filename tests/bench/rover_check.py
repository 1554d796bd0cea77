#!/usr/bin/python3
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
"""Solves ROVER's exported linear programs with HiGHS (python3-scipy) and compares the optima.

  mkdir lp && build/bench/bin/bench_rover --repeat 1 --export lp deploy/missions/rover_*.yaml
  tests/bench/rover_check.py lp
"""
import json
import pathlib
import sys

import numpy
from scipy.optimize import linprog
from scipy.sparse import csc_matrix

TOLERANCE = 1e-6  # relative to 1 + optimum

worst = 0.0
files = sorted(pathlib.Path(sys.argv[1]).glob("*.json"))
for file in files:
    lp = json.loads(file.read_text())
    right_side = numpy.array(lp["row_upper"])
    matrix = csc_matrix(
        (lp["value"], lp["row_index"], lp["column_start"]),
        shape=(len(right_side), len(lp["cost"])),
    ).tocsr()
    equality = numpy.array(lp["is_equality"], dtype=bool)
    answer = linprog(
        lp["cost"],
        A_eq=matrix[equality],
        b_eq=right_side[equality],
        A_ub=matrix[~equality] if not equality.all() else None,
        b_ub=right_side[~equality] if not equality.all() else None,
        method="highs",
    )
    assert answer.status == 0, f"{file}: HiGHS: {answer.message}"
    off = abs(answer.fun - lp["optimum"]) / (1.0 + abs(answer.fun))
    worst = max(worst, off)
    if off > TOLERANCE:
        print(f"{file}: HiGHS {answer.fun:.12g}, ours {lp['optimum']:.12g}")
print(f"{len(files)} programs, largest relative difference {worst:.2e}")
sys.exit(0 if files and worst <= TOLERANCE else 1)
