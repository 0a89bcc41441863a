"""Picture of speed against accuracy."""

from types import SimpleNamespace

from explorer import plot

ROWS = [
    SimpleNamespace(method="quadrature", p99=1e-12, nanoseconds=2000.0, on_front=False),
    SimpleNamespace(method="rk4", p99=1e-3, nanoseconds=1000.0, on_front=False),
    SimpleNamespace(method="dopri5", p99=1e-3, nanoseconds=800.0, on_front=True),
    SimpleNamespace(method="dopri5", p99=1e-6, nanoseconds=3000.0, on_front=True),
]


def test_each_method_is_a_line_and_the_front_lies_behind_in_order():
    ax = plot.work_precision(ROWS)
    front, *lines = ax.lines
    assert list(front.get_xdata()) == [1e-6, 1e-3]
    assert list(front.get_ydata()) == [3000.0, 800.0]
    assert {line.get_label(): list(line.get_ydata()) for line in lines} == {
        "quadrature": [2000.0],
        "rk4": [1000.0],
        "dopri5": [800.0, 3000.0],
    }
    assert ax.xaxis_inverted()
