"""The measurement of speed against accuracy: errors fall with the setting, work rises, the front is the best."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import BODIES

from explorer.motion import calibration, work_precision
from explorer.motion.reference_samples import ReferencePassages
from explorer.motion.vertical import starts_at_vertical


def row(method, p99, nanoseconds):
    return work_precision.Row("passages", method, 1.0, 1e-3, p99, p99, p99, 1.0, nanoseconds, 0.0, 0.0, 0)


@pytest.fixture(params=["passages", "motions"])
def part(traded, request):
    return next(part for part in traded.parts if part.kind == request.param)


def test_every_method_is_measured_over_many_decades(part):
    for method in calibration.SETTINGS:
        errors = [row.p99 for row in part.rows if row.method == method]
        assert min(errors) < 1e-10
        # Motions that are recorded at given times never take very long steps.
        assert max(errors) > {"passages": 1e-5, "motions": 1e-6}[part.kind]


def test_finer_settings_cost_more_evaluations_and_err_less(part):
    for method in calibration.SETTINGS:
        chosen = [row for row in part.rows if row.method == method]
        evaluations = [row.evaluations for row in chosen]
        assert evaluations == sorted(evaluations)
        if part.kind == "passages":  # of motions there are too few
            errors = np.array([row.p99 for row in chosen])
            coarse = errors > 1e-11
            assert (np.diff(np.log(errors[coarse])) < 0.05).all()


def test_none_goes_the_wrong_way_and_hardly_any_is_refused_at_its_accuracy(part):
    assert all(row.wrong_way == 0 for row in part.rows)
    assert np.mean([row.unresolved + row.refused for row in part.rows]) < 0.01


def test_what_is_asked_is_met_by_all_methods(part):
    for row in part.asked:
        assert row.p99 <= row.setting
        assert row.unresolved + row.refused < 0.01


def test_quadrature_stands_at_its_grades_and_only_where_it_gives_the_answer(traded):
    passages, motions = traded.parts
    found = [row for row in passages.rows if row.method == "quadrature"]
    assert [row.setting for row in found] == list(work_precision.OF_QUADRATURE)
    assert all(row.p99 <= row.setting for row in found)
    assert not any(row.method == "quadrature" for row in motions.rows)


def test_errors_do_not_depend_on_when_they_are_measured():
    rng = np.random.default_rng(0)
    one = np.ones(32)
    start = starts_at_vertical(BODIES["uniform"], rng.uniform(-2, 2, 32), 10.0 ** rng.uniform(-8, 0, 32), one, one)
    one, other = (work_precision.only_errors(ReferencePassages(BODIES["uniform"], start)) for _ in range(2))
    assert one == other
    assert set(one) == {(method, float(step)) for method, steps in calibration.SETTINGS.items() for step in steps}


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


def test_settings_that_gain_nothing_calibrate_nothing(part):
    rows = [replace(row, p99=max(row.p99, 1e-9)) for row in part.rows]
    table = work_precision.curves(replace(part, rows=rows), work_precision.largest_errors([rows], []))
    for method, curve in calibration.parse({"methods": table, "quadrature": 1.0}, "").curves.items():
        rounded = [row.setting for row in rows if row.method == method and row.p99 <= 1.5e-9]
        assert curve.setting[-1] >= rounded[0]


def test_errors_of_several_measurements_make_one_table(part):
    doubled = [replace(row, p99=2.0 * row.p99) for row in part.rows]
    errors = work_precision.largest_errors([part.rows, doubled], [{("rk4", 0.25): 10.0}])
    assert errors["rk4", 0.25] == 10.0
    assert errors["rk8", 0.8] == 2.0 * next(r.p99 for r in part.rows if (r.method, r.setting) == ("rk8", 0.8))
    table = work_precision.curves(part, errors)
    read = calibration.parse({"methods": table, "quadrature": 1.0}, "")
    assert read.curves["rk4"].error[0] == 10.0
