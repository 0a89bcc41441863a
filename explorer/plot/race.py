"""Pictures of the race of the contact point."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from explorer.disk import Disk
from explorer.plot.style import DARK, MINUS, PLUS, axes_or_new, dress, legend
from explorer.states import Array

_JOINED = 5  # bins of the summary that make one of the picture


def race_histogram(summary: dict[str, Any], ax: Axes | None = None) -> Axes:
    """Race angles of both signs of eta on a logarithmic count, with +-kappa pi drawn in."""
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
        rf"race angle $\Delta\chi$ - drift (rad); $\kappa\pi$ = {limit:.4f}",
        "passages per bin",
        f"The contact point races by $\\pm\\kappa\\pi$ (wrong way: {summary['wrong_way']})",
    )


def race_deviation(disk: Disk, eta_hat: Array, race: Array, impact_speed: float, ax: Axes | None = None) -> Axes:
    """How far each race angle is from its limit against |eta_hat|, with the law eta ln(1/eta).

    The law is drawn for one impact speed (units of the disk), best the samples' median.
    """
    ax = axes_or_new(ax)
    deviation = abs(race - np.sign(eta_hat) * disk.race_limit)
    good = np.isfinite(deviation) & (deviation > 0.0)
    size = abs(eta_hat[good])
    drawn = ax.hexbin(
        size, deviation[good], xscale="log", yscale="log", gridsize=70, bins="log", mincnt=1, cmap="cividis_r"
    )
    bar = ax.figure.colorbar(drawn, ax=ax)
    bar.set_label("passages per cell")
    span = np.geomspace(size.min(), size.max(), 100) if size.size else np.array([1e-6, 1e-2])
    b = disk.body
    natural = span / disk.rate_unit * b.I3 * b.r0
    law = 2.0 / (b.I1 * b.M * (impact_speed / disk.rate_unit) ** 3) * natural * np.log(1.0 / natural)
    ax.plot(span, law, color=MINUS, lw=1.8, label=r"$\frac{2mgr}{I_1MA^3}\,\eta\,\ln(1/\eta)$, median $A$")
    legend(ax, loc="lower right")
    return dress(
        ax,
        r"$|\hat\eta|$ (rad per unit of time)",
        r"$|\Delta\chi$ - drift $\mp\,\kappa\pi|$ (rad)",
        f"Distance of the race angle from its limit, {disk.name} disk",
    )
