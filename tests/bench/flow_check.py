#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
"""Solves the instances of flow_check.cpp again as plain linear programs with scipy's HiGHS.

Fails unless both agree on which instances are feasible and on every optimum to 1e-9 relative.
Needs python3-scipy.
"""
import json
import sys
from collections import defaultdict

from scipy.optimize import linprog
from scipy.sparse import coo_matrix

BAR = 1e-9


class Program:
    """min c x, rows = b or rows <= b, 0 <= x."""

    def __init__(self):
        self.costs, self.entries, self.rhs = [], {"eq": [], "ub": []}, {"eq": [], "ub": []}

    def row(self, kind, rhs):
        self.rhs[kind].append(rhs)
        return kind, len(self.rhs[kind]) - 1

    def column(self, cost, entries):
        for (kind, row), value in entries:
            self.entries[kind].append((row, len(self.costs), value))
        self.costs.append(cost)

    def minimum(self):
        def matrix(kind):
            if not self.rhs[kind]:
                return None
            rows, columns, values = zip(*self.entries[kind]) if self.entries[kind] else ((), (), ())
            return coo_matrix((values, (rows, columns)),
                              shape=(len(self.rhs[kind]), len(self.costs))).tocsr()

        if not self.costs:
            return None
        found = linprog(self.costs, A_ub=matrix("ub"), b_ub=self.rhs["ub"] or None,
                        A_eq=matrix("eq"), b_eq=self.rhs["eq"], method="highs-ds",
                        options={"primal_feasibility_tolerance": 1e-10,
                                 "dual_feasibility_tolerance": 1e-10})
        if found.status == 0:
            return found.fun
        assert found.status == 2, found.message
        return None


def transport(case):
    program = Program()
    rows = [program.row("eq", mass) for mass in case["supplies"]]
    columns = [program.row("eq", mass) for mass in case["demands"]]
    for cell, cost in enumerate(case["costs"]):
        if cost is not None:
            i, j = divmod(cell, len(columns))
            program.column(cost, [(rows[i], 1.0), (columns[j], 1.0)])
    return program


def capped(case):
    program = Program()
    starts, goals = len(case["supplies"]), len(case["demands"])
    conserved, entering = [], []
    for v, capacity in enumerate(case["capacities"]):
        begins = case["supplies"][v] if v < starts else 0.0
        ends = case["demands"][v - starts] if starts <= v < starts + goals else 0.0
        conserved.append(program.row("eq", begins - ends))
        entering.append(program.row("ub", capacity - begins))
    for v, w, length, _ in case["arcs"]:
        program.column(length, [(conserved[v], 1.0), (conserved[w], -1.0), (entering[w], 1.0)])
    return program


def timed(case):
    program = Program()
    starts, goals, horizon = len(case["supplies"]), len(case["demands"]), case["horizon"]
    conserved, present = {}, {}
    for v, capacity in enumerate(case["capacities"]):
        for t in range(horizon + 1):
            begins = case["supplies"][v] if v < starts and t == 0 else 0.0
            is_end = starts <= v < starts + goals and t == horizon
            conserved[v, t] = program.row("eq", begins - (case["demands"][v - starts] if is_end else 0.0))
            present[v, t] = program.row("ub", capacity - begins)

    def move(v, t, w, then, cost):
        if then <= horizon:
            program.column(cost, [(conserved[v, t], 1.0), (conserved[w, then], -1.0),
                                  (present[w, then], 1.0)])

    price = case["step_price"]
    for t in range(horizon):
        for v in range(len(case["capacities"])):
            move(v, t, v, t + 1, 0.0 if starts <= v < starts + goals else price)
        for v, w, length, steps in case["arcs"]:
            move(v, t, w, t + steps, length + price * steps)
    return program


def main():
    programs = {"transport": transport, "capped": capped, "timed": timed}
    feasible, infeasible, worst, differing = (defaultdict(int), defaultdict(int),
                                              defaultdict(float), 0)
    for line in sys.stdin:
        case = json.loads(line)
        kind, ours = case["kind"], case["best"]
        theirs = programs[kind](case).minimum()
        if (ours is None) != (theirs is None):
            print(f"{kind}: {ours} here, {theirs} by HiGHS")
            differing += 1
        elif ours is None:
            infeasible[kind] += 1
        else:
            feasible[kind] += 1
            worst[kind] = max(worst[kind], abs(ours - theirs) / theirs)
    for kind in programs:
        print(f"{kind}: {feasible[kind]} feasible, {infeasible[kind]} infeasible, "
              f"largest relative difference {worst[kind]:.1e}")
    return 0 if differing == 0 and max(worst.values()) <= BAR else 1


if __name__ == "__main__":
    sys.exit(main())
