"""Race angles by general solvers beside ours: which way round?"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.plot.captions import Question, captioned
from explorer.plot.style import DARK, SIGN_COLOURS, SMALL, TEXT, open_frame, rates_of
from explorer.portrait.general_solvers import OURS, GeneralSolvers

_MOST = 1.7  # kappa pi, beyond which a race is only marked at the edge
_COLUMN = 2.35  # inches


@captioned(
    Question.HOW_GOOD,
    "Race angles of the same passages, nearer and nearer to F, by SciPy's solve_ivp at its default tolerances and "
    "by nearflat. Each dot should lie on the line of its colour, the side of F. Near F general solvers miss the "
    "race: their disk goes through the table (hollow dots), and nothing is said.",
)
def missed_races(solved: GeneralSolvers) -> Figure:
    """Draw race angles against the distance from F, one panel for each solver.

    Parameters
    ----------
    solved : GeneralSolvers
        From `explorer.portrait.general_solvers`.

    Returns
    -------
    Figure

    References
    ----------
    Eq. (7.16) of the paper: the limits.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import general_solvers
    >>> len(plot.missed_races(general_solvers(Disk.uniform(), [1e-2])).axes)
    4
    """
    names = list(solved.race_angle)
    figure = Figure(figsize=(_COLUMN * len(names), 4.0))
    panels = figure.subplots(1, len(names), sharex=True, sharey=True, squeeze=False)[0]
    figure.subplots_adjust(left=0.095, right=0.985, top=0.86, bottom=0.17, wspace=0.12)
    for ax, name in zip(panels, names, strict=True):
        _panel(ax, solved, name)
    panels[0].invert_xaxis()
    panels[0].set_ylim(-_MOST, _MOST)
    panels[0].set_yticks([-1, 0, 1], ["−κπ", "0", "κπ"])
    panels[0].set_ylabel("race angle", fontsize=TEXT)
    figure.supxlabel(rf"distance from F, $|\hat\eta|$ ({rates_of(solved.disk)})", fontsize=TEXT)
    return figure


def _panel(ax: Axes, solved: GeneralSolvers, name: str) -> None:
    """The races by one solver."""
    size = abs(solved.eta_hat) / solved.disk.rate_unit
    share, through = solved.race_angle[name] / solved.disk.race_limit, solved.beyond[name]
    for sign, colour in SIGN_COLOURS.items():
        ax.axhline(sign, color=colour, lw=8.0, alpha=0.25)
        mine = np.sign(solved.eta_hat) == sign
        shown, lost = mine & (abs(share) <= _MOST), mine & np.isnan(share)
        for part, face in ((shown & ~through, colour), (shown & through, "white")):
            ax.plot(size[part], share[part], "o", color=colour, mfc=face, ms=5)
        ax.plot(size[lost], np.zeros(lost.sum()), "x", color=colour, ms=7, mew=1.6)
        for edge, marker in ((1.0, "^"), (-1.0, "v")):
            out = mine & (edge * share > _MOST)
            ax.plot(size[out], np.full(out.sum(), edge * _MOST), marker, color=colour, ms=7, clip_on=False)
    if through.any():
        middle = float(np.median(size[through]))
        ax.text(middle, 0.14, "through the table", fontsize=SMALL, ha="center", va="bottom")
    weight = "bold" if name == OURS else "normal"
    words = f"{name}\n{int(solved.wrong(name).sum())} of {size.size} wrong"
    ax.set_title(words, fontsize=TEXT, color=DARK, weight=weight)
    ax.set_xscale("log")
    ax.tick_params(labelsize=SMALL)
    open_frame(ax)
