"""Lines of samples that wait for finer rules: nobody is lost, and groups are full while there are enough."""

import numpy as np
import pytest
from conftest import BODIES

from kernels.integrals import grades
from kernels.integrals.grades import GRADES, empty_lines, first_grade, grade_at, line_up, next_grade, take
from kernels.integrals.tables import COARSE, MIDDLE
from kernels.integrals.tabulated import LANES


def served(n, settled, first):
    """What each grade was given, in groups, where `settled(sample, grade)` says whether that was enough."""
    lines, group, groups = empty_lines(), np.zeros(LANES, np.int64), []
    for i in range(n + 1):
        if i < n:
            line_up(lines, first, i)
        while (grade := next_grade(lines, first, i == n)) >= 0:
            taken = take(lines, grade, group)
            groups.append((grade, group[:taken].tolist()))
            for sample in group[:taken].tolist():
                if not settled(sample, grade):
                    line_up(lines, grade + 1, sample)
    return groups


@pytest.mark.parametrize("share", [0.0, 0.1, 0.9, 1.0])
def test_every_sample_goes_through_the_grades_until_one_settles_it(share):
    rng = np.random.default_rng(1)
    needs = np.where(rng.random(1000) < share, rng.integers(1, GRADES + 1, 1000), 0)
    groups = served(1000, lambda sample, grade: grade >= needs[sample], 0)
    for grade in range(GRADES):
        came = [sample for g, members in groups for sample in members if g == grade]
        assert sorted(came) == np.flatnonzero(needs >= grade).tolist()
        # All groups but those of the end are full.
        assert sum(len(members) < LANES for g, members in groups if g == grade) <= 3


def test_lines_have_room_for_samples_that_no_grade_settles():
    """The longest line is that of a grade whose groups all fail just before the next is served."""
    longest = 0
    lines, group = empty_lines(), np.zeros(LANES, np.int64)
    for i in range(10 * LANES + 1):
        if i < 10 * LANES:
            line_up(lines, 0, i)
        while (grade := next_grade(lines, 0, i == 10 * LANES)) >= 0:
            for sample in group[: take(lines, grade, group)].tolist():
                line_up(lines, grade + 1, sample)
            longest = max(longest, *lines.counts.tolist())
    assert LANES <= longest < grades._ROOM


def test_the_accuracy_asked_chooses_the_first_grade():
    of_body = BODIES["uniform"].tables
    chosen = [grade_at(of_body, first_grade(target)).inner.shape[1] for target in (COARSE, MIDDLE, 0.9 * MIDDLE)]
    assert chosen == [5, 8, 28]
