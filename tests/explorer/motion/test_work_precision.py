"""The measurement of speed against accuracy: what is asked is met, and the front is the best."""

import numpy as np

from explorer.motion import work_precision


def row(method, p99, nanoseconds):
    return work_precision.Measurement(method, 1e-3, p99, p99, p99, nanoseconds, 0.0, 0.0, 0)


def test_what_is_asked_is_met_by_all_methods_on_the_right_side(traded):
    assert len(traded.rows) == 5 * len(work_precision.ASKED)
    for row in traded.rows:
        assert row.p99 <= row.accuracy
        assert row.unresolved + row.refused < 0.01
        assert row.wrong_way == 0


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
