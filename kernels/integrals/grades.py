"""Samples that wait in line for rules of rising accuracy, so that each grade has full groups to compute.

A sample begins with the grade that its accuracy asks for. Those that a group has not settled wait for the next
grade until a group of them has come together; those that no grade settles leave the lines.
"""

from typing import NamedTuple

import numpy as np

from kernels._jit import subroutine
from kernels.integrals.tables import COARSE, MIDDLE, Grade, Tables
from kernels.integrals.tabulated import LANES
from kernels.types import Longs

GRADES = 3
# Samples in a line: fewer than a group, and those that a group of the grade before leaves.
_ROOM = 2 * LANES


class Lines(NamedTuple):
    """Samples that wait: those of grade g from g * _ROOM on, and how many they are."""

    waiting: Longs
    counts: Longs


@subroutine
def empty_lines() -> Lines:
    """Lines in which nobody waits."""
    return Lines(np.zeros(GRADES * _ROOM, np.int64), np.zeros(GRADES, np.int64))


@subroutine
def first_grade(target: float) -> int:
    """The grade to begin with."""
    return 0 if target >= COARSE else 1 if target >= MIDDLE else 2


@subroutine
def grade_at(of_body: Tables, number: int) -> Grade:
    """Grades from few nodes to many."""
    return of_body.coarse if number == 0 else of_body.middle if number == 1 else of_body.fine


@subroutine
def line_up(lines: Lines, grade: int, sample: int) -> None:
    """Let a sample wait for a grade, if there is one."""
    if grade < GRADES:
        lines.waiting[grade * _ROOM + lines.counts[grade]] = sample
        lines.counts[grade] += 1


@subroutine
def next_grade(lines: Lines, first: int, last: bool) -> int:
    """The finest grade, `first` or finer, for which a full group waits; after the last sample any for which one
    waits; -1 if there is none."""
    for grade in range(GRADES - 1, first - 1, -1):
        if lines.counts[grade] >= LANES:
            return grade
    for grade in range(first, GRADES):
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
