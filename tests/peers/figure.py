"""The picture of the peers: error and rate, ours above, peers in grey, each with its name beside it."""

import numpy as np
from matplotlib.figure import Figure
from peers.measuring import ASKED, KERNEL
from peers.tables import INTEGRATED, QUADRATURE, best_asked

from explorer.pictures.register import Caption, Question, add_caption
from explorer.pictures.style import DARK, MARKERS, SERIES, TEXT, dress

GREY = SERIES[4]
# Of each family the fastest; all others are in the tables.
DRAWN = {
    "heyoka batch": "o",
    "heyoka": "s",
    "numbalsoda dop853": "^",
    "CyRK DOP853": "D",
    "diffrax Dopri8": "v",
    "SciPy DOP853": "P",
    "C++ rk8 strict": "X",
}
LEAST_GAP = 0.36  # decades between two names


CAPTION = Caption(
    Question.HOW_GOOD,
    "Trajectories per second of one core against their error, what a user calls here in black and other solvers "
    "in grey: above on the plain equations, as a user would write them, below on our regularised ones. Higher and "
    "further right is better. Settings at which a contact point races the wrong way round are left out.",
)


def draw(rows: list) -> Figure:
    """Two panels above each other: peers on the plain and on the regularised equations, ours in both."""
    figure = Figure(figsize=(6.4, 8.4), layout="constrained")
    panels = figure.subplots(2, 1, sharex=True, sharey=True)
    for ax, kind in zip(panels, ("plain", "regularised"), strict=True):
        lines = [_line(ax, points, look) for points, look in _series(rows, kind)]
        dress(ax, "", "trajectories per second and core", f"Peers on the {kind} equations")
        ax.set(xscale="log", yscale="log")
        ax.grid(alpha=0.25)
        _name(ax, [line for line in lines if line])
    panels[0].invert_xaxis()
    panels[1].set_xlabel("error of χ, 99th percentile (rad)", fontsize=TEXT)
    add_caption(figure, CAPTION)
    return figure


def _series(rows, kind):
    """((p99, rate) of each point, name and look) of all that is drawn in a panel."""
    for peer, marker in DRAWN.items():
        yield _right(row for row in rows if row.name == f"{peer}, {kind}"), {"label": peer, "marker": marker}
    own = {"color": DARK, "lw": 2.4, "ms": 8, "zorder": 5}
    front = [best_asked(rows, INTEGRATED, accuracy) for accuracy in ASKED]
    yield _right(row for row in front if row), {**own, "label": "passages,\nintegrated", "marker": MARKERS[0]}
    simulated = _right(row for row in rows if row.name == "simulate")
    yield simulated, {**own, "label": "simulate", "marker": MARKERS[1]}
    exact = _right(row for row in rows if row.name == QUADRATURE and row.kind != KERNEL)
    yield exact, {**own, "label": "passages,\nquadrature", "marker": "*", "ms": 14}


def _right(rows):
    """(p99, rate) where every trajectory is right, from coarse to fine; none is slower and less accurate."""
    points = sorted((row.p99, row.rate) for row in rows if row.wrong == row.unresolved == 0 and row.p99 > 0.0)
    front, best = [], 0.0
    for p99, rate in points:  # from the most accurate on
        if rate > best:
            front.append((p99, rate))
            best = rate
    return front[::-1]


def _line(ax, points, look):
    if not points:
        return None
    usual = {"color": GREY, "lw": 1.2, "ms": 5, "zorder": 3}
    return ax.plot(*np.transpose(points), **{**usual, **look})[0]


def _name(ax, lines):
    """The name of each line at the right of the axes, at the height of its end as far as others leave room."""
    ends = sorted(((line.get_ydata()[-1], line) for line in lines), key=lambda end: end[0])
    heights = np.log10([height for height, _ in ends])
    gaps = np.array([LEAST_GAP * (1.0 + 0.5 * line.get_label().count("\n")) for _, line in ends])
    for _ in range(200):  # push neighbours apart, evenly, until none is too near another
        for i in range(len(heights) - 1):
            close = 0.5 * (gaps[i] + gaps[i + 1]) - (heights[i + 1] - heights[i])
            if close > 0.0:
                heights[i] -= 0.5 * close
                heights[i + 1] += 0.5 * close
    heights -= max(0.0, heights[-1] + 0.5 * gaps[-1] - np.log10(ax.get_ylim()[1]))
    for height, (_, line) in zip(heights, ends, strict=True):
        own = line.get_color() == DARK
        ax.annotate(
            line.get_label(), (line.get_xdata()[-1], line.get_ydata()[-1]), (1.03, 10.0**height),
            xycoords="data", textcoords=ax.get_yaxis_transform(), va="center", fontsize=0.875 * TEXT, color=DARK,
            fontweight="bold" if own else "normal", annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": line.get_color(), "lw": 0.7, "shrinkB": 4, "relpos": (0, 0.5)},
        )  # fmt: skip
