"""The picture of the peers: rate against error, ours in black, each peer in a colour of its own."""

import numpy as np
from matplotlib.figure import Figure
from tools.peers.measuring import ASKED, PEER
from tools.peers.tables import INTEGRATED, QUADRATURE, best_asked, names_of, reaching, times

from explorer.pictures.register import Caption, Question, add_caption
from explorer.pictures.style import DARK, MARKERS, SERIES, SIZE, TEXT, dress, legend_of_all

AT = 1e-6  # the error at which titles compare
# Of each family the fastest; all others are in the tables.
DRAWN = {
    "heyoka batch": "o",
    "heyoka": "s",
    "numbalsoda dop853": "^",
    "CyRK DOP853": "D",
    "diffrax Dopri8": "v",
    "SciPy DOP853": "P",
    "C++ rk8 contracted": "X",
}

CAPTION = Caption(
    Question.HOW_GOOD,
    "Trajectories per second on one core against their error: the calls of nearflat in black, other solvers in "
    "colours. Above, the other solvers solve the plain equations, as a user would write them; below, our "
    "regularised ones. Higher and further left is better. Each title compares two speeds at errors of at most "
    "1e-6: that of the fastest integrator of the call `passages`, and that of the fastest other solver. The "
    "program in C++ detects no events: it is told where each motion ends. Settings at which a contact point "
    "races the wrong way round are left out.",
)


def draw(rows: list) -> Figure:
    """Two panels above each other: peers on the plain and on the regularised equations, ours in both."""
    figure = Figure(figsize=(SIZE[0], 9.2), layout="constrained")
    panels = figure.subplots(2, 1, sharex=True, sharey=True)
    for ax, kind in zip(panels, ("plain", "regularised"), strict=True):
        for points, look in _series(rows, kind):
            if points:
                ax.plot(*np.transpose(points), **look)
        dress(ax, "", "trajectories per second and core", _title(rows, kind), grid=True)
        ax.set(xscale="log", yscale="log")
        ax.text(0.02, 0.03, "better ↖", fontsize=TEXT, transform=ax.transAxes)
    panels[1].set_xlabel("error of χ, 99th percentile (rad)", fontsize=TEXT)
    legend_of_all(figure, panels)
    add_caption(figure, CAPTION)
    return figure


def _title(rows, kind):
    """How many times as fast as any peer of a kind integrated passages are, each at its best setting."""
    peer = reaching(rows, [name for name in names_of(rows, PEER) if name.endswith(f", {kind}")], AT)
    ratio = times(best_asked(rows, INTEGRATED, AT), peer)
    apart = (
        f": of settings with errors up to $10^{{-6}}$\nintegrated passages are {ratio} times as fast as any peer"
    )
    return f"{kind.capitalize()} equations{'' if ratio == '-' else apart}"


def _series(rows, kind):
    """((p99, rate) of each point, name and look) of all that is drawn in a panel."""
    own = {"color": DARK, "lw": 2.4, "ms": 8, "zorder": 5}
    exact = _right(row for row in rows if row.name == QUADRATURE)
    yield exact, {**own, "label": "passages, quadrature", "marker": "*", "ms": 14}
    front = [best_asked(rows, INTEGRATED, accuracy) for accuracy in ASKED]
    yield _right(row for row in front if row), {**own, "label": "passages, integrated", "marker": MARKERS[0]}
    simulated = _right(row for row in rows if row.name == "simulate")
    yield simulated, {**own, "label": "simulate", "marker": MARKERS[1]}
    for colour, (peer, marker) in zip(SERIES[1:], DRAWN.items(), strict=True):
        look = {"color": colour, "marker": marker, "lw": 1.4, "ms": 6, "zorder": 3}
        yield _right(row for row in rows if row.name == f"{peer}, {kind}"), {**look, "label": peer}


def _right(rows):
    """(p99, rate) where every trajectory is right, from coarse to fine; none is slower and less accurate."""
    points = sorted((row.p99, row.rate) for row in rows if row.wrong == row.unresolved == 0 and row.p99 > 0.0)
    front, best = [], 0.0
    for p99, rate in points:  # from the most accurate on
        if rate > best:
            front.append((p99, rate))
            best = rate
    return front[::-1]
