"""Samples that wait in line for rules of rising accuracy, so that each grade has full groups to compute.

A sample begins with the grade that its accuracy asks for. Those that a group has not settled wait for a finer
grade until a group of them has come together; those that no grade settles leave the lines.
"""

from typing import NamedTuple

import numpy as np

from kernels._jit import maker, subroutine
from kernels.integrals.sums import LANES
from kernels.integrals.tables import GRADES, TARGETS, Grade, Limits, Tables
from kernels.types import Longs

_TWO_DECADES = 2  # what one grade has not settled needs more than a few nodes more
# Samples in a line: fewer than a group, and those that a group of the grade before leaves.
_ROOM = 2 * LANES


class Lines(NamedTuple):
    """Samples that wait: those of grade g from g * _ROOM on, and how many they are."""

    waiting: Longs
    counts: Longs


@maker
def empty_lines() -> Lines:
    """Lines in which nobody waits."""
    return Lines(np.zeros(GRADES * _ROOM, np.int64), np.zeros(GRADES, np.int64))


@subroutine
def first_grade(target: float) -> int:
    """The grade to begin with."""
    for grade in range(GRADES - 1):
        if target >= TARGETS[grade]:
            return grade
    return GRADES - 1


@subroutine
def grade_at(of_body: Tables, number: int) -> Grade:
    """The rules of a grade, from few nodes to many."""
    first, last, row = 3 * number, 3 * number + 3, of_body.limits[number]
    ends = of_body.ends
    return Grade(
        outer=of_body.outer[:, ends[first] : ends[last]],
        fall=of_body.fall[:, ends[first + 1] : ends[last + 1]],
        inner=of_body.inner[:, ends[first + 2] : ends[last + 2]],
        limits=Limits(row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7]),
    )


@subroutine
def line_up(lines: Lines, grade: int, sample: int) -> None:
    """Let a sample wait for a grade."""
    lines.waiting[grade * _ROOM + lines.counts[grade]] = sample
    lines.counts[grade] += 1


@subroutine
def finer(grade: int, end: int) -> int:
    """The grade before `end` for which samples wait that a coarser one has not settled."""
    return min(grade + _TWO_DECADES, end - 1)


@subroutine
def next_grade(lines: Lines, last: bool) -> int:
    """The finest grade for which a full group waits; after the last sample the first for which one waits; -1 if
    there is none."""
    for grade in range(GRADES - 1, -1, -1):
        if lines.counts[grade] >= LANES:
            return grade
    for grade in range(GRADES):
        if last and lines.counts[grade] > 0:
            return grade
    return -1


@subroutine
def take(lines: Lines, grade: int, group: Longs) -> int:
    """Move those who have waited longest for a grade into a group; returns how many."""
    first, n = grade * _ROOM, lines.counts[grade]
    taken = min(n, LANES)
    for i in range(taken):
        group[i] = lines.waiting[first + i]
    for i in range(taken, n):
        lines.waiting[first + i - taken] = lines.waiting[first + i]
    lines.counts[grade] = n - taken
    return taken
