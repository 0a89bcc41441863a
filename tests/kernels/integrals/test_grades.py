"""Lines of samples that wait for finer rules: nobody is lost, and groups are full while there are enough."""

import math

import numpy as np
import pytest
from conftest import BODIES

from explorer.motion import passages_by_quadrature
from kernels.integrals import grades
from kernels.integrals.grades import empty_lines, finer, first_grade, grade_at, line_up, next_grade, take
from kernels.integrals.sums import LANES
from kernels.integrals.tables import GRADES, ROUGH, TARGETS


def served(n, settled, first):
    """What each grade was given, in groups, where `settled(sample, grade)` says whether that was enough."""
    lines, group, groups = empty_lines(), np.zeros(LANES, np.int64), []
    for i in range(n + 1):
        if i < n:
            line_up(lines, first, i)
        while (grade := next_grade(lines, i == n)) >= 0:
            taken = take(lines, grade, group)
            groups.append((grade, group[:taken].tolist()))
            for sample in group[:taken].tolist():
                if not settled(sample, grade) and grade < GRADES - 1:
                    line_up(lines, finer(grade, GRADES), sample)
    return groups


@pytest.mark.parametrize("share", [0.0, 0.1, 0.9, 1.0])
def test_every_sample_goes_through_the_grades_until_one_settles_it(share):
    rng = np.random.default_rng(1)
    needs = np.where(rng.random(1000) < share, rng.integers(1, GRADES + 1, 1000), 0)
    groups = served(1000, lambda sample, grade: grade >= needs[sample], 0)
    before = -1
    for grade in (0, 2, 4, 6, 8, GRADES - 1):
        came = [sample for g, members in groups for sample in members if g == grade]
        assert sorted(came) == np.flatnonzero(needs > before).tolist()
        # All groups but those of the end are full.
        assert sum(len(members) < LANES for g, members in groups if g == grade) <= 3
        before = grade
    assert {grade for grade, _members in groups} <= {0, 2, 4, 6, 8, GRADES - 1}


def test_lines_have_room_for_samples_that_no_grade_settles():
    """The longest line is that of a grade whose groups all fail just before the next is served."""
    longest = 0
    lines, group = empty_lines(), np.zeros(LANES, np.int64)
    for i in range(10 * LANES + 1):
        if i < 10 * LANES:
            line_up(lines, 0, i)
        while (grade := next_grade(lines, i == 10 * LANES)) >= 0:
            for sample in group[: take(lines, grade, group)].tolist():
                if grade < GRADES - 1:
                    line_up(lines, finer(grade, GRADES), sample)
            longest = max(longest, *lines.counts.tolist())
    assert LANES <= longest < grades._ROOM


def test_the_accuracy_asked_chooses_the_first_grade():
    assert [first_grade(target) for target in TARGETS] == list(range(GRADES))
    assert [first_grade(0.9 * target) for target in TARGETS[:-1]] == list(range(1, GRADES))
    assert first_grade(1.0) == 0


def test_a_grade_has_the_nodes_between_its_ends():
    of_body = BODIES["uniform"].tables
    for place, name in enumerate(("outer", "fall", "inner")):
        nodes = [grade_at(of_body, number)[place] for number in range(GRADES)]
        assert np.array_equal(np.concatenate(nodes, axis=1), getattr(of_body, name))


def test_who_calls_the_kernels_knows_where_the_short_series_end():
    assert TARGETS[ROUGH - 1] == passages_by_quadrature.ROUGH


@pytest.mark.parametrize("exponent", range(2, 11))
def test_a_power_of_ten_that_was_rounded_down_begins_with_its_own_grade(exponent):
    below = math.nextafter(math.nextafter(10.0**-exponent, 0.0), 0.0)
    assert first_grade(below) == exponent - 2
