"""Sections 7.1 and 7.2 of the paper hold, and every row fails once something it rests on is damaged."""

import numpy as np
import pytest
from paper_rows import Statements, field, first, scaled, without_one

from explorer.paper import closed_forms, section_7_1
from explorer.paper.checks import UNIFORM
from explorer.phase.disk import Disk

NUMBERS = range(40, 48)


def slow_clock(original):
    return lambda disk, start, times, *names: original(disk, start, 1.0001 * times, *names)


DAMAGES = [
    (40, closed_forms, "at_vertical", first(1.001)),
    (41, section_7_1, "potential", scaled(1.001)),
    (42, section_7_1, "observed", slow_clock),
    (43, closed_forms, "at_vertical", first(1.001)),
    (44, section_7_1, "passages", field("race_angle", 1.0 + 1e-8)),
    (45, Disk, "kappa", without_one),
    (46, Disk, "kappa", without_one),
    (47, section_7_1, "passages", field("race_angle", 1.0 + 1e-6)),
]


class TestStatements(Statements):
    """Those of NUMBERS, each with its damage."""


def test_the_times_of_a_level_are_where_the_rate_says():
    run = section_7_1.passage(UNIFORM, 1e-4)
    times = np.array(section_7_1.level(run, 0.25))
    assert times[0] < run.middle < times[1]
    assert run.at(times)[1] == pytest.approx(run.A * np.sqrt(0.75) * np.array([-1.0, 1.0]), rel=1e-10)
