"""What accuracy costs: the picture of `nearflat trade`."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter

from explorer.motion.work_precision import ROUNDING, Measurement, Trade, best_of
from explorer.pictures.register import Question, picture
from explorer.pictures.style import METHODS, SMALL, dress

_LIMITS = (3e-17, 1e-1)  # of the error; the names of the methods stand in the first decades
_APART = 1.35  # ratio of the heights of two names


@picture(
    Question.HOW_GOOD,
    "What accuracy costs, for each method at several accuracies: the time of a passage on one core against the "
    "99th percentile of its error. Lower and further left is better. The band joins the integrators that no other "
    "beats; the stars are quadrature.",
)
def work_precision(ax: Axes, measured: Trade) -> None:
    """Draw the time of a passage against the 99th percentile of the error: a line per method, the best in a band.

    measured: what `explorer.trade` returns. Settings that are no better than a coarser
    one of the same method are left out.
    """
    front = sorted(_place(row) for row in measured.rows if row.on_front)
    if front:
        ax.plot(*np.array(front).T, color="0.85", lw=9, solid_capstyle="round", zorder=0, label="best integrators")
    names: list[tuple[float, float, str, str]] = []
    for k, method in enumerate(dict.fromkeys(row.method for row in measured.rows)):
        chosen = best_of([row for row in measured.rows if row.method == method])
        if not chosen:
            continue
        colour, marker = METHODS[method]
        style: dict[str, Any] = {"marker": marker, "ms": 6, "color": colour, "ls": "-", "zorder": 2 + k}
        if method == "quadrature":
            style |= {"ms": 13, "lw": 1.0}
        ax.plot(*np.array([_place(row) for row in chosen]).T, **style, label=method)
        beyond = f" ≤ {ROUNDING:g}" if chosen[-1].p99 < ROUNDING else ""
        names.append((*_place(chosen[-1]), method + beyond, colour))
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlim(*_LIMITS)
    ax.set_xticks([10.0**-k for k in range(2, 15, 2)])
    ax.yaxis.set_minor_formatter(NullFormatter())
    _write(ax, names)
    # No method is both slow and far off, so this corner is free.
    key = ax.get_legend_handles_labels()[0][:1] if front else []
    look = {"fontsize": SMALL, "title_fontsize": SMALL, "frameon": False}
    ax.legend(handles=key, title="better ↙", loc="upper right", **look)
    x = "error, 99th percentile (rad; times and tilts relative)"
    dress(ax, x, "time per passage, one core (ns)", "Passages: time against error", grid=True)


def _place(row: Measurement) -> tuple[float, float]:
    return max(row.p99, ROUNDING), row.nanoseconds


def _write(ax: Axes, names: list[tuple[float, float, str, str]]) -> None:
    """The names of the methods beside the fine ends of their lines, apart from each other."""
    lowest = 0.0
    for error, nanoseconds, name, colour in sorted(names, key=lambda each: each[1]):
        height = max(nanoseconds, lowest * _APART)
        lowest = height
        ax.annotate(
            name,
            (error, height),
            (-9, 0),
            textcoords="offset points",
            ha="right",
            va="center",
            color=colour,
            fontsize=SMALL,
        )
