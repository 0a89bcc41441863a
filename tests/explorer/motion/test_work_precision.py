"""The measurement of speed against accuracy: what is asked is met, at more work, and the front is the best."""

import numpy as np
import pytest

from explorer.motion import work_precision


def row(method, p99, nanoseconds):
    return work_precision.Row("passages", method, 1e-3, p99, p99, p99, 1.0, nanoseconds, 0.0, 0.0, 0)


@pytest.fixture(params=["passages", "motions"])
def part(traded, request):
    return next(part for part in traded.parts if part.kind == request.param)


def test_what_is_asked_is_met_by_all_methods_on_the_right_side(part):
    for row in part.rows:
        assert row.p99 <= row.accuracy
        assert row.unresolved + row.refused < 0.01
        assert row.wrong_way == 0


def test_more_digits_cost_more_evaluations(part):
    for method in work_precision.STAGES:
        chosen = [row for row in part.rows if row.method == method]
        assert [row.accuracy for row in chosen] == list(work_precision.ASKED)
        evaluations = [row.evaluations for row in chosen]
        assert evaluations == sorted(evaluations)
        assert evaluations[-1] > 2.0 * evaluations[0]


def test_quadrature_is_measured_at_its_best_and_only_where_it_gives_the_answer(traded):
    passages, motions = traded.parts
    asked = [row.accuracy for row in passages.rows if row.method == "quadrature"]
    assert asked == [*work_precision.ASKED, work_precision.FINEST]
    assert not any(row.method == "quadrature" for row in motions.rows)


def test_the_front_holds_what_nothing_beats():
    rows = [
        row("rk4", 1e-3, 100.0),
        row("rk8", 1e-6, 200.0),
        row("rk8", 1e-4, 250.0),
        row("dop853", 0.9e-6, 220.0),  # as accurate, but for the luck of the samples
        row("dopri5", np.nan, 1.0),
        row("rk8", 1e-15, 300.0),
        row("dop853", 1e-16, 400.0),  # more accurate than rounding lets it be
        row("quadrature", 1e-9, 1.0),
    ]
    assert [found.on_front for found in work_precision.mark_front(rows)] == [
        True,
        True,
        False,
        False,
        False,
        True,
        False,
        False,
    ]


def test_a_line_is_drawn_through_settings_that_gain():
    rows = [row("rk8", error, 1.0) for error in (1e-2, 1e-2, 1e-4, np.nan, 0.9e-4, 1e-8, 0.0, 0.0)]
    assert [found.p99 for found in work_precision.best_of(rows)] == [1e-2, 1e-4, 1e-8, 0.0]
