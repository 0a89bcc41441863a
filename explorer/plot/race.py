"""Pictures of the race of the contact point."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm

from explorer.measure.log_counts import CELLS_PER_DECADE
from explorer.phase.disk import Disk
from explorer.plot.captions import Question, captioned
from explorer.plot.style import DARK, MINUS, PLUS, axes_or_new, dress, legend, rates_of

_JOINED = 5  # bins of the summary that make one of the picture


@captioned(
    Question.HOW_FAR,
    "The race angles of all passages, one ridge for each decade of |η̂|, around −κπ and around +κπ. The "
    "nearer to F, the narrower the ridge: the race angle collapses onto ±κπ. The strip on top shows both "
    "sides on one axis.",
)
def race_histogram(summary: dict[str, Any], ax: Axes | None = None) -> Axes:
    """Draw the race angles on both sides of F, with +-kappa pi.

    Parameters
    ----------
    summary : dict
        Of a run of scene race-angles.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        Race angle (rad) and passages per bin, logarithmic; eta > 0 in blue, eta < 0 in vermilion.

    Examples
    --------
    >>> import explorer as ex
    >>> run = ex.run("race-angles", out="races", samples=10_000)  # doctest: +SKIP
    >>> ax = ex.plot.race_histogram(run.summary)  # doctest: +SKIP
    """
    ax = axes_or_new(ax)
    edges = np.array(summary["histogram"]["edges"])
    limit = summary["limit"]
    for name, colour, label in (("plus", PLUS, r"$\eta > 0$"), ("minus", MINUS, r"$\eta < 0$")):
        counts = np.array(summary["histogram"][f"counts_{name}"])
        joined = counts.reshape(-1, _JOINED).sum(axis=1)
        ax.stairs(joined, edges[::_JOINED], fill=True, color=colour, label=f"{label}: {counts.sum():,} passages")
    ax.set_yscale("log")
    top = max(sum(summary["histogram"][f"counts_{name}"]) for name in ("plus", "minus"))
    ax.set_ylim(0.7, 5.0 * max(top, 1))
    for sign in (1, -1):
        ax.axvline(sign * limit, color=DARK, lw=1, ls="--", label=r"$\pm\kappa\pi$" if sign > 0 else None)
    ticks = [-limit, -np.pi, 0.0, np.pi, limit]
    ax.set_xticks(ticks, [r"$-\kappa\pi$", r"$-\pi$", "0", r"$\pi$", r"$\kappa\pi$"])
    legend(ax, loc="upper center")
    return dress(
        ax,
        rf"race angle $\Delta\chi$ - fall angle (rad); $\kappa\pi$ = {limit:.4f}",
        "passages per bin",
        f"The contact point races by $\\pm\\kappa\\pi$ (wrong way: {summary['wrong_way']})",
    )


@captioned(
    Question.HOW_FAR,
    "How far race angles are from ±κπ, divided by Kη, against |η̂|. The median follows ln(1/|η̂|) less a "
    "constant, drawn as a line; the band holds nine tenths of the passages.",
)
def race_deviation(
    disk: Disk, cells: Mapping[tuple[int, int], int], impact_speed: float, ax: Axes | None = None
) -> Axes:
    """Draw how far race angles are from their limit against |eta_hat|, with the law eta ln(1/eta).

    Parameters
    ----------
    disk : Disk
    cells : mapping of (int, int) to int
        How many samples lie in each cell (i, j) of `explorer.measure.log_counts.count_cells`.
    impact_speed : float
        For which the law is drawn, units of the disk; best the samples' median.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        |eta_hat| and the distance from +-kappa pi (rad), both logarithmic; passages per cell in colour.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> ax = plot.race_deviation(Disk.uniform(), {(-48, -36): 10, (-24, -12): 20}, 1.8)
    >>> ax.get_yscale()
    'log'
    """
    ax = axes_or_new(ax)
    ax.set_xscale("log")
    ax.set_yscale("log")
    span = np.array([1e-6, 1e-2])
    if cells:
        (left, low), (right, high) = (np.array([f(c) for c in zip(*cells, strict=True)]) for f in (min, max))
        counts = np.full((high - low + 1, right - left + 1), np.nan)
        for (i, j), count in cells.items():
            counts[j - low, i - left] = count
        x, y = (10.0 ** (np.arange(a, b + 2) / CELLS_PER_DECADE) for a, b in ((left, right), (low, high)))
        drawn = ax.pcolormesh(x, y, counts, norm=LogNorm(1.0, max(2.0, np.nanmax(counts))), cmap="cividis_r")
        ax.figure.colorbar(drawn, ax=ax).set_label("passages per cell")
        span = np.geomspace(x[0], x[-1], 100)
    b = disk.body
    eta = disk.eta_hat_to_eta(span / disk.rate_unit)
    law = 2.0 / (b.I1 * b.M * (impact_speed / disk.rate_unit) ** 3) * eta * np.log(1.0 / eta)
    ax.plot(span, law, color=MINUS, lw=1.8, label=r"$\frac{2mgr}{I_1MA^3}\,\eta\,\ln(1/\eta)$, median $A$")
    legend(ax, loc="lower right")
    return dress(
        ax,
        rf"$|\hat\eta|$ ({rates_of(disk)})",
        r"$|\Delta\chi$ - fall angle $\mp\,\kappa\pi|$ (rad)",
        f"Distance of the race angle from its limit, {disk.name} disk",
    )
