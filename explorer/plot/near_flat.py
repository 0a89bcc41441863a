"""The limit eta -> 0 from both sides: paths, the collapse of the race onto one curve, and the blow-up of flat."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D

from explorer.phase.disk import Disk
from explorer.phase.states import Array
from explorer.plot.captions import Question, captioned
from explorer.plot.style import DARK, SIGN_COLOURS, SMALL, TEXT, axes_or_new, dress, legend, rates_of, styled
from explorer.portrait.both_sides import BothSides
from explorer.portrait.near_flat import NearFlat

_GREY = "#999999"
_STYLES = (":", "-.", "--", "-", (0, (1, 1)))
_SIDES = {1: r"$\eta > 0$", -1: r"$\eta < 0$"}  # said in words, since blue and vermilion are one grey in print
_SEEN = 30.0  # of A t/theta_m, on an axis that is linear to 3


@captioned(
    Question.EACH_SIDE,
    "The path of the contact point on the table, seen from above, from the vertical through two falls, nearer and "
    "nearer to F from both sides. Each circle is a race round the rim of the disk that lies almost flat. From "
    "left to right the paths settle down, to one limit above and to another one below: the limit at F depends on "
    "the side.",
)
def limit_paths(several: Sequence[BothSides]) -> Figure:
    """Draw contact paths at decreasing distances from F, and the limits, one row for each side.

    Parameters
    ----------
    several : sequence of BothSides
        From `explorer.portrait.toward_limits`.

    Returns
    -------
    Figure

    References
    ----------
    Section 7 of the paper; its Figs 8 and 9 are two columns of this.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import toward_limits
    >>> len(plot.limit_paths(toward_limits(Disk.uniform(), [0.1])).axes)
    4
    """
    columns = len(several) + 1
    figure = Figure(figsize=(1.85 * columns, 3.9), layout="constrained")
    grid = figure.subplots(2, columns, sharex=True, sharey=True, squeeze=False)
    for row, sign in enumerate((1, -1)):
        colour = SIGN_COLOURS[sign]
        for ax, both in zip(grid[row], several, strict=False):
            _path(ax, both.motions[sign]["contact"][:, :2] / both.disk.r, colour)
            if row == 0:
                ax.set_title(_size_label(both.eta_hat, both.disk), fontsize=TEXT)
        _path(grid[row, -1], several[-1].limit_path(sign) / several[-1].disk.r, colour)
        grid[row, 0].set_ylabel(rf"$\eta {'>' if sign > 0 else '<'} 0$", fontsize=TEXT + 2, color=colour)
    grid[0, -1].set_title("limit", fontsize=TEXT)
    for ax in grid.ravel():
        ax.set_aspect("equal")
        ax.tick_params(labelsize=SMALL - 2)
    figure.supxlabel("on the table, radii", fontsize=SMALL)
    return figure


def _size_label(eta_hat: float, disk: Disk) -> str:
    """A distance from F, in natural units, as a power of ten where it is one."""
    natural = eta_hat / disk.rate_unit
    exponent = math.log10(natural)
    power = abs(exponent - round(exponent)) < 1e-9
    return rf"$|\hat\eta| = 10^{{{exponent:.0f}}}$" if power else rf"$|\hat\eta| = {natural:g}$"


def _path(ax: Axes, path: Array, colour: str) -> None:
    ax.plot(*path.T, color=colour, lw=1.5)
    ax.plot(*path[0], "o", color=DARK, ms=4)
    # Along the last piece, so that the way is seen.
    back = int(np.searchsorted(-np.linalg.norm(path - path[-1], axis=1), -0.3))
    how = {"arrowstyle": "-|>", "color": colour, "lw": 1.5, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 14}
    ax.annotate("", path[-1], path[min(back, len(path) - 2)], arrowprops=how)


@captioned(
    Question.HOW_FAR,
    "The angle by which the contact point has raced, in units of κ, against the time from the flattest moment, "
    "stretched by the impact speed A over the smallest tilt. Over many decades of the distance from F all races "
    "are one curve, the arctangent, up on one side of F and down on the other.",
)
def race_collapse(several: Sequence[NearFlat], ax: Axes | None = None, **look: Any) -> Axes:
    r"""Draw races at several distances from F on the curve +-arctan, to which they tend.

    Parameters
    ----------
    several : sequence of NearFlat
        From `explorer.portrait.near_flat`.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the races.

    Returns
    -------
    Axes

    References
    ----------
    Lemma 6 of the paper.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import near_flat
    >>> plot.race_collapse(near_flat(Disk.uniform(), [1e-6])).get_ylabel()
    'race from its middle / $\\kappa$ (rad)'
    """
    ax = axes_or_new(ax)
    x = np.sinh(np.linspace(-math.asinh(_SEEN), math.asinh(_SEEN), 401))
    for sign in (1, -1):
        ax.plot(
            x, sign * np.arctan(x), color=_GREY, lw=7.0, alpha=0.45, label=r"$\pm\arctan$" if sign > 0 else None
        )
    sizes = sorted({abs(one.eta_hat) for one in several}, reverse=True)
    for one in several:
        place = sizes.index(abs(one.eta_hat))
        seen = abs(one.stretched) <= _SEEN
        label = _size_label(abs(one.eta_hat), one.disk) if one.eta_hat > 0.0 else None
        colour = SIGN_COLOURS[int(np.sign(one.eta_hat))]
        style = _STYLES[place % len(_STYLES)]
        ax.plot(one.stretched[seen], one.raced[seen], **styled(look, color=colour, ls=style, lw=1.8, label=label))
    ax.set_xscale("asinh", linear_width=1.0)
    for sign, name in _SIDES.items():
        ax.text(2.2, sign * 0.62, name, color=SIGN_COLOURS[sign], fontsize=TEXT, ha="left", va="center")
    ax.set_xlim(-_SEEN, _SEEN)
    ax.minorticks_off()
    ax.set_xticks([-30, -10, -3, -1, 0, 1, 3, 10, 30], ["−30", "−10", "−3", "−1", "0", "1", "3", "10", "30"])
    ax.set_yticks([-math.pi / 2, 0.0, math.pi / 2], ["−π/2", "0", "π/2"])
    dress(ax, r"$A\,t/\theta_{\min}$", r"race from its middle / $\kappa$ (rad)", "Near flat, all races are one")
    legend(ax, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=3)
    return ax


@captioned(
    Question.HOW_FAR,
    "The flat state blown up: the rate of the tilt, the rate ρ of the contact point, and how flat the disk lies, "
    "downwards. At the bottom the flat state is an ellipse, and an orbit on it leads from the impact at −A to the "
    "rise at +A, on one half for each side of F. Motions beside F, nearer and nearer from above, follow it: the "
    "race is this heteroclinic orbit, and the angle along it is ±κπ.",
)
def blow_up(several: Sequence[NearFlat]) -> Figure:
    """Draw passages beside F in (dtheta/dt, rho/kappa, log tilt), above the blown-up flat state.

    Parameters
    ----------
    several : sequence of NearFlat
        From `explorer.portrait.near_flat`.

    Returns
    -------
    Figure

    References
    ----------
    Section 7 of the paper, eq. (7.1): the ellipse is that of the energy at flat.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import near_flat
    >>> len(plot.blow_up(near_flat(Disk.uniform(), [1e-2])).axes)
    1
    """
    figure = Figure(figsize=(7.4, 6.0), layout="constrained")
    ax = figure.add_subplot(projection="3d")
    assert isinstance(ax, Axes3D)
    disk, unit = several[0].disk, several[0].disk.rate_unit
    # One and a half decades below the flattest of them stands for log 0.
    flat = math.log10(min(one.theta_min for one in several)) - 0.7
    A = several[-1].impact_speed / unit
    turned = np.linspace(0.0, math.pi, 90)
    for sign in (1, -1):
        x, y = -A * np.cos(turned), sign * A * np.sin(turned)
        ax.plot(x, y, flat, color=SIGN_COLOURS[sign], lw=4.0)
        ax.text(x[38], 0.66 * y[45], flat, _SIDES[sign], color=SIGN_COLOURS[sign], fontsize=TEXT, ha="center")
        ax.quiver(x[45], y[45], flat, 0.3 * A, 0.0, 0.0, color=SIGN_COLOURS[sign], lw=4.0, arrow_length_ratio=0.9)
    for one in several:
        sign = int(np.sign(one.eta_hat))
        q = np.sin(one.theta)
        seen = q < 0.6
        x, y, z = (values[seen] for values in (one.p / unit, one.rho / (disk.kappa * unit), np.log10(q)))
        ax.plot(x, y, z, color=SIGN_COLOURS[sign], lw=1.6)
    for at, word in ((-A, "impact"), (A, "rise")):
        ax.plot([at, at], [0.0, 0.0], [flat, 0.0], color=DARK, lw=1.0, ls=(0, (4, 3)))
        ax.scatter([at], [0.0], [flat], color=DARK, s=34, depthshade=False)
        ax.text(at, 0.0, flat - 0.5, word, fontsize=SMALL, ha="center")
    ax.set_xlabel(rf"$\dot\theta$ ({rates_of(disk)})", fontsize=TEXT)
    ax.set_ylabel(rf"$\rho/\kappa$ ({rates_of(disk)})", fontsize=TEXT)
    ax.set_zlabel(r"$\cos\varphi$", fontsize=TEXT)
    decades = np.arange(math.ceil(flat), 1)
    ax.set_zticks([flat, *decades], ["flat", *(f"$10^{{{k}}}$" for k in decades)])
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(3))
    ax.tick_params(labelsize=SMALL)
    ax.set_title("The race is a heteroclinic orbit on the blown-up flat state", fontsize=TEXT, y=1.0)
    ax.set_box_aspect((1.0, 1.0, 0.85), zoom=1.05)
    ax.view_init(elev=24.0, azim=-72.0)
    return figure
