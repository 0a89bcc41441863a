"""Operations of a step, and roots and divisions of a passage, counted by numbers that count.

Run as a program, `NUMBA_DISABLE_JIT=1 python -m peers.counting`, it prints them as JSON: the kernels are then
plain Python and take such numbers.
"""

import json
import math
import os
import subprocess
import sys
from collections import Counter
from functools import cache
from pathlib import Path
from typing import ClassVar

import numpy as np

ACCURACIES = (1e-3, 1e-6, 1e-11)


@cache
def counted():
    """{"steps": {method: additions and multiplications}, "quadrature": {accuracy: {"passage": ..., "fall": ...}}}.

    A step is one with time and angles. Of a passage by quadrature and of the fall beside it, which `passages`
    computes as well: [roots, divisions].
    """
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    command, tests = [sys.executable, "-m", "peers.counting"], Path(__file__).parents[1]
    done = subprocess.run(command, cwd=tests, env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


class Number(float):
    """Counts what is done with it."""

    made: ClassVar = Counter()


class Silent(float):
    """The path, which the compiler drops where nobody asks for it."""


def _counting(name, kind):
    plain = getattr(float, name)

    def operation(x, *others):
        if any(isinstance(y, Silent) for y in others):
            return Silent(0.0)
        Number.made[kind] += 1
        return Number(plain(float(x), *map(float, others)))

    return operation


def _root(x):
    Number.made["root"] += isinstance(x, Number)
    return Number(_PLAIN_ROOT(x))


_PLAIN_ROOT = math.sqrt
_OPERATIONS = {
    "flop": ("__add__", "__radd__", "__sub__", "__rsub__", "__mul__", "__rmul__"),
    "division": ("__truediv__", "__rtruediv__"),
    "sign": ("__neg__", "__abs__"),
}


def _teach():
    for kind, names in _OPERATIONS.items():
        for name in names:
            setattr(Number, name, _counting(name, kind))
            setattr(Silent, name, lambda *_: Silent(0.0))
    math.sqrt = _root


def steps():
    """Additions and multiplications in a step of each method, with time and angles; of rk8 without its errors."""
    from kernels.disk import field
    from kernels.steps import eighth
    from kernels.steps.adaptive import dopri5_step
    from kernels.steps.eighth import eighth_order_step
    from kernels.steps.fixed import rk4_step

    path, field.path = field.path, lambda _x: (Silent(0.0), Silent(0.0))
    outcome = eighth._outcome
    # Nobody asks a fixed step for its errors, and the compiler drops them.
    eighth._outcome = lambda x, h, w, stages: outcome(x, h, w, stages) if w is eighth._B else x
    *constants, anchor = _disk().body
    body = type(_disk().body)(*map(Number, constants), anchor)
    counts = {}
    for name, step in (("rk4", rk4_step), ("dopri5", dopri5_step), ("rk8", eighth_order_step)):
        Number.made.clear()
        start = (*map(Number, (0.8, 0.6, -0.5, 0.4, 0.3, 0, 0, 0)), Silent(0.0), Silent(0.0))
        step(field.State(*start), Number(0.1), body)
        counts[name] = Number.made["flop"]
    field.path, eighth._outcome = path, outcome
    return counts


def roots_and_divisions(accuracy):
    """[roots, divisions] of one passage by quadrature, on the average, and of the fall beside it."""
    from kernels.integrals import sums, tables, tabulated

    disk, eta = _disk(), _eta_hat() * _disk().body.I3 * _disk().body.r0
    X, Y = 1.0 / disk.body.r0, eta / disk.body.I1
    goal = sums.Goal(accuracy, 1e-13)
    everywhere = np.ones(eta.size)
    of = disk.tables
    low = of.short if accuracy >= tables.TARGETS[tables.ROUGH - 1] else of.low

    def passages(W, grade):
        tabulated.passages(W, goal, grade, of.vertical, low, disk.body)

    def falls(W, grade):
        tabulated.falls(W, goal, grade, of.vertical, disk.body)

    passage, level = _through_grades(passages, accuracy, {"X": X * everywhere, "Y": Y, "SPEED": everywhere})
    # Beside F a fall leaves the vertical as fast as the passage.
    moving = 0.5 * disk.body.M * everywhere
    rows = {"X": X * everywhere, "LEVEL": level, "MOVING": moving, "START": 0.0 * everywhere}
    fall, _level = _through_grades(falls, accuracy, rows)
    return {"passage": passage, "fall": fall}


def _through_grades(kernel, accuracy, rows):
    """Samples through the rules of rising accuracy until each has settled, as the kernels do.

    [roots, divisions] of one of them, and LEVEL of all.
    """
    from kernels.integrals import grades, sums

    disk, lanes = _disk(), sums.LANES
    n = len(next(iter(rows.values())))
    waiting, level = np.arange(n), np.zeros(n)
    Number.made.clear()
    for grade in range(grades.first_grade(accuracy), grades.GRADES):
        left = []
        for first in range(0, waiting.size, lanes):
            group = waiting[first : first + lanes]
            places = np.resize(group, lanes)  # the last group is rarely full; its other lanes repeat it
            W = np.array([Number(1.0)] * (sums.ROWS * lanes), object)
            for name, values in rows.items():
                at = getattr(sums, name) * lanes
                W[at : at + lanes] = [Number(value) for value in values[places]]
            before = Counter(Number.made)
            kernel(W, grades.grade_at(disk.tables, grade))
            for kind in Number.made:  # a group of few takes as long as a full one, but there is one of it only
                Number.made[kind] = before[kind] + (Number.made[kind] - before[kind]) * group.size / lanes
            at = sums.LEVEL * lanes
            level[group] = np.array(W[at : at + group.size], float)
            check = np.array(W[sums.CHECK * lanes :][: group.size], float)
            left.append(group[check != 0.0])
        waiting = np.concatenate(left) if left else waiting
    if waiting.size:
        raise RuntimeError(f"tables left {waiting.size} passages to adaptive rules, which are not counted")
    return [Number.made["root"] / n, Number.made["division"] / n], level


def _eta_hat():
    """As in the work of all solvers, fewer of them."""
    return np.logspace(-6, -1, 64) * np.resize([1.0, -1.0], 64)


@cache
def _disk():
    import explorer as ex

    return ex.Disk.uniform()


def main():
    found = _disk()
    assert found.tables  # made by plain numbers
    _teach()
    quadrature = {f"{accuracy:g}": roots_and_divisions(accuracy) for accuracy in ACCURACIES}
    print(json.dumps({"steps": steps(), "quadrature": quadrature}))


if __name__ == "__main__":
    main()
