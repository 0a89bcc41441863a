"""Picture of speed against accuracy."""

import pytest

from explorer import plot
from explorer.motion.trade import Measured, Row


def row(method, p99, nanoseconds, on_front=False):
    return Row("passages", method, 1.0, 1e-3, p99, p99, p99, 1.0, nanoseconds, 0.0, 0.0, 0, on_front)


ROWS = [
    row("quadrature", 1e-4, 500.0),
    row("quadrature", 1e-12, 600.0),
    row("rk4", 1e-3, 1000.0),
    row("rk4", 1e-3, 1100.0),  # finer, and no better
    row("dopri5", 1e-3, 800.0, True),
    row("dopri5", 1e-6, 3000.0, True),
]


def measured(rows):
    return Measured("passages", "passage", "of angles", 100, 100, rows, [])


def test_each_method_is_a_line_with_its_name_and_the_front_lies_behind_in_order():
    ax = plot.work_precision(measured(ROWS))
    front, *lines = ax.lines
    assert list(front.get_xdata()) == [1e-6, 1e-3]
    assert list(front.get_ydata()) == [3000.0, 800.0]
    assert {line.get_label(): list(line.get_ydata()) for line in lines} == {
        "quadrature": [500.0, 600.0],
        "rk4": [1000.0],
        "dopri5": [800.0, 3000.0],
    }
    assert ax.xaxis_inverted()
    assert {text.get_text() for text in ax.texts} == {"quadrature", "rk4", "dopri5", "better ↘"}
    assert ax.get_ylabel() == "time per passage, one core (ns)"


def test_names_of_lines_that_end_close_to_each_other_do_not_touch():
    ax = plot.work_precision(measured([row("rk8", 1e-10, 1000.0), row("dop853", 1e-10, 1010.0)]))
    low, high = sorted(text.xy[1] for text in ax.texts if text.get_text() != "better ↘")
    assert high >= 1.3 * low


def test_quadrature_need_not_be_there_and_a_method_without_errors_is_left_out():
    ax = plot.work_precision(measured([row("rk8", float("nan"), 1.0), row("rk4", 1e-3, 5.0)]))
    assert [line.get_label() for line in ax.lines] == ["rk4"]


def test_two_kinds_stand_above_each_other_on_one_axis_of_errors(traded):
    figure = plot.stacked(*(lambda ax, part=part: plot.work_precision(part, ax) for part in traded.parts))
    above, below = figure.axes
    assert above.get_xlim() == pytest.approx(below.get_xlim())
    assert above.xaxis_inverted()
    assert "quadrature" in {text.get_text() for text in above.texts}
    assert "quadrature" not in {text.get_text() for text in below.texts}
