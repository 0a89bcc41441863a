"""Work-precision picture of `nearflat trade`."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from explorer.plot.captions import Question, captioned
from explorer.plot.style import DARK, MARKERS, SERIES, SMALL, axes_or_new, dress, legend_below


@captioned(
    Question.HOW_GOOD,
    "Time of one passage against its error, for all methods at many settings. Lower and further right is "
    "better; quadrature is the star, and the band joins the integrators that no other beats.",
)
def work_precision(rows: Sequence[Any], ax: Axes | None = None, **look: Any) -> Axes:
    """Draw time per passage against the 99th percentile of the error, a line per method, the front in grey.

    Parameters
    ----------
    rows : sequence of Row
        From `explorer.trade`.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the lines of the methods.

    Returns
    -------
    Axes
        Error (rad; of times, relative), falling to the right, and nanoseconds, both logarithmic.

    Examples
    --------
    >>> import explorer as ex
    >>> ax = ex.plot.work_precision(ex.trade(ex.Disk.uniform(), 1024))  # doctest: +SKIP
    """
    ax = axes_or_new(ax)
    front = sorted((row.p99, row.nanoseconds) for row in rows if row.on_front)
    ax.plot(*np.array(front).T, color="0.85", lw=9, solid_capstyle="round", zorder=0, label="best integrators")
    for k, method in enumerate(dict.fromkeys(row.method for row in rows)):
        chosen = [row for row in rows if row.method == method]
        style: dict[str, Any] = {"marker": MARKERS[(k - 1) % 8], "ms": 6, "color": SERIES[k % 8], "ls": "-"}
        if method == "quadrature":
            style = {"marker": "*", "ms": 14, "color": DARK, "ls": "none"}
        ax.plot(
            [row.p99 for row in chosen], [row.nanoseconds for row in chosen], **(style | {"label": method} | look)
        )
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.invert_xaxis()
    ax.text(0.98, 0.03, "better ↘", ha="right", va="bottom", fontsize=SMALL, transform=ax.transAxes)
    legend_below(ax, ncols=3)
    return dress(
        ax,
        "error, 99th percentile (rad; of times, relative)",
        "time per passage (ns)",
        "Speed against accuracy",
        grid=True,
    )
