"""The limit eta -> 0 from both sides: paths, the collapse of the race onto one curve, and the orbit at flat."""

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.errors import InputError
from explorer.motion.both_sides import both_sides
from explorer.motion.passages import passages
from explorer.motion.trajectories import finer, simulate
from explorer.phase.coordinates import constants_to_states
from explorer.phase.disk import Disk
from explorer.phase.states import Array
from explorer.pictures.register import Question, picture
from explorer.pictures.style import (
    DARK,
    SIDES,
    SIGN_COLOURS,
    SIZE,
    TEXT,
    arrow,
    dress,
    legend_below,
    legend_of_all,
    power,
)

_GREY = "#999999"
_STYLES: tuple[Any, ...] = (":", "-.", "--", "-", (0, (1, 1)))
_NEARER = (":", "--", "-")
_SEEN = 30.0  # of A t/theta_m, on an axis that is linear to 3
_LOW = 0.6  # of cos phi: from here down a motion is near flat
_PARTS = 2  # of a step of the record, for 0.1 rad of chi between two points of a curve
_SMALLEST = 1e-10  # of |eta_hat|, natural units: smaller tilts are lost in the rounding of phi, which is near pi/2


class Curve(NamedTuple):
    """One passage from the vertical to nearly flat and back, on face +1, in natural units; arrays (nt).

    theta, chi: rad. p, rho: dtheta/dt and sigma3/sin(theta), which is bounded where dchi/dt is not.
    theta_min: the smallest tilt (rad). impact_speed: A of eq. (7.1).
    """

    eta_hat: float
    kappa: float
    theta: Array
    chi: Array
    p: Array
    rho: Array
    theta_min: float
    impact_speed: float

    @property
    def stretched(self) -> Array:
        """A t / theta_min, t from the flattest moment, as theta^2 = theta_min^2 + A^2 t^2 has it."""
        size = np.sqrt(np.maximum((self.theta / self.theta_min) ** 2 - 1.0, 0.0))
        return np.asarray(np.copysign(size, self.p))

    @property
    def raced(self) -> Array:
        """chi from the middle of the race, in units of kappa (rad)."""
        return np.asarray((self.chi - 0.5 * (self.chi[0] + self.chi[-1])) / self.kappa)


def followed(disk: Disk, eta_hat: Sequence[float]) -> Iterator[Curve]:
    """Passages at distances eta_hat (natural units, with their signs) from the same start at the vertical.

    Raises InputError where one is too near to F to be followed in phi.
    """
    unit, names = disk.rate_unit, ("phi", "phidot", "sigma3", "chi")
    if not all(abs(size) >= _SMALLEST for size in eta_hat):
        raise InputError(f"eta_hat = {eta_hat!r}: give numbers of size {_SMALLEST:g} and above")
    whole = passages(disk, unit, np.multiply(eta_hat, unit), unit)
    for row, size in enumerate(eta_hat):
        start = constants_to_states(disk, unit, size * unit, unit)
        motion = simulate(start, float(whole.duration[row]), observables=names, accuracy=1e-9)
        at = motion(finer(motion.t, _PARTS))
        phi, phidot, sigma3, chi = (getattr(at, name) for name in names)
        theta = 0.5 * np.pi - phi
        least, speed = float(whole.theta_min[row]), float(whole.impact_speed[row]) / unit
        yield Curve(size, disk.kappa, theta, chi, -phidot / unit, sigma3 / np.sin(theta) / unit, least, speed)


def _on_both_sides(sizes: Sequence[float]) -> list[float]:
    return [sign * size for size in sizes for sign in (1, -1)]


@picture(
    Question.EACH_SIDE,
    "The path of the contact point on the table, seen from above, on both sides of F: it starts where the disk "
    "is upright, and goes on through two falls. Each circle is a race round the rim of the disk that lies almost "
    "flat. The nearer to F, the nearer the path is to the limit of its side, the broad line; the limits of the "
    "sides lead apart.",
    (SIZE[0], 4.2),
    "limit",
)
def limit_paths(figure: Figure, disk: Disk, eta_hat: Sequence[float] = (0.1, 0.03, 0.01)) -> None:
    """Draw contact paths at decreasing distances from F, section 7, and the limits, a panel for each side.

    eta_hat: in natural units, in which sigma3_bar = phidot = 1.
    """
    start = constants_to_states(disk, disk.rate_unit, 0.0, disk.rate_unit)
    several = [both_sides(start, size * disk.rate_unit) for size in eta_hat]
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for ax, (sign, colour) in zip(panels, SIGN_COLOURS.items(), strict=True):
        limit = several[-1].limit_path(sign) / disk.r
        ax.plot(*limit.T, color=colour, lw=7.0, alpha=0.25)
        for place, (both, size) in enumerate(zip(several, eta_hat, strict=True)):
            style = _NEARER[place % len(_NEARER)]
            _path(ax, both.motions[sign]["contact"][:, :2] / disk.r, colour, style)
            ax.plot([], [], color=_GREY, ls=style, label=rf"$|\hat\eta|$ = {size:g}")
        ax.set_aspect("equal")
        dress(ax, "$x$ ($r$)", "$y$ ($r$)" if sign > 0 else "", SIDES[sign])
        ax.title.set_color(colour)
    panels[0].plot([], [], color=_GREY, lw=7.0, alpha=0.4, label="limit")
    panels[0].plot([], [], "o", color=DARK, ms=5, label="start")
    figure.suptitle("Nearer to $F$ the paths settle, on each side to another limit", fontsize=TEXT)
    legend_of_all(figure, panels, ncols=3)


def _size(eta_hat: float) -> str:
    return rf"$|\hat\eta| = {power(abs(eta_hat))}$"


def _path(ax: Axes, path: Array, colour: str, style: Any) -> None:
    ax.plot(*path.T, color=colour, lw=1.5, ls=style)
    ax.plot(*path[0], "o", color=DARK, ms=5)
    arrow(ax, path, len(path) - 1, colour)


@picture(
    Question.HOW_FAR,
    "The angle by which the contact point has raced, in units of κ, against At/θ_min, where t is the time from "
    "the flattest moment, A the speed of impact and θ_min the smallest tilt. Over many decades of the distance "
    "from F all races are one curve, the arctangent, up on one side of F and down on the other.",
    group="limit",
)
def race_collapse(ax: Axes, disk: Disk, eta_hat: Sequence[float] = (0.1, 1e-2, 1e-4, 1e-8)) -> None:
    """Draw races at distances eta_hat from F (natural units), and the +-arctan to which they tend, Lemma 6."""
    x = np.sinh(np.linspace(-math.asinh(_SEEN), math.asinh(_SEEN), 401))
    for sign, name in SIDES.items():
        ax.plot(x, sign * np.arctan(x), color=_GREY, lw=7.0, alpha=0.45, label=r"$\pm\arctan$")
        ax.text(2.2, sign * 0.62, name, color=SIGN_COLOURS[sign], fontsize=TEXT, ha="left", va="center")
    for place, one in enumerate(followed(disk, _on_both_sides(eta_hat))):
        seen, side = abs(one.stretched) <= _SEEN, 1 if one.eta_hat > 0.0 else -1
        look: dict[str, Any] = {"color": SIGN_COLOURS[side], "ls": _STYLES[place // 2 % len(_STYLES)], "lw": 1.8}
        ax.plot(one.stretched[seen], one.raced[seen], **look, label=_size(one.eta_hat))
    ax.set_xscale("asinh", linear_width=1.0)
    ax.set_xlim(-_SEEN, _SEEN)
    ax.minorticks_off()
    ax.set_xticks([-30, -10, -3, -1, 0, 1, 3, 10, 30], ["−30", "−10", "−3", "−1", "0", "1", "3", "10", "30"])
    ax.set_yticks([-math.pi / 2, 0.0, math.pi / 2], ["−π/2", "0", "π/2"])
    stretched = r"$A\,t/\theta_{\min}$ (logarithmic beyond ±1)"
    dress(ax, stretched, r"race from its middle / $\kappa$ (rad)", "Near flat, all races are one")
    legend_below(ax, ncols=3)


@picture(
    Question.HOW_FAR,
    "Motions near F, drawn by two rates that stay bounded at flat: the rate of the tilt, and ρ/κ, where ρ is the "
    "speed of the contact point along the rim. The nearer to F, the closer they keep to half of a circle, from "
    "the impact at −A to the rise at +A (A is the speed at impact), with one half for each side of F. Each half "
    "is a solution of the equations for a disk that lies exactly flat, and this solution is the race: along it "
    "the contact point turns by ±κπ.",
    group="limit",
)
def blow_up(ax: Axes, disk: Disk, eta_hat: Sequence[float] = (0.1, 0.01, 0.001)) -> None:
    """Draw passages near F in the plane of dtheta/dt and rho/kappa, and the orbits to which they tend, eq. (7.1).

    rho: speed of the contact point along the rim. eta_hat: in natural units, the nearest last.
    """
    several = list(followed(disk, _on_both_sides(eta_hat)))
    A, turned = several[-1].impact_speed, np.linspace(0.0, math.pi, 181)
    for side, colour in SIGN_COLOURS.items():
        at_flat = f"at flat, {SIDES[side]}"
        ax.plot(-A * np.cos(turned), side * A * np.sin(turned), color=colour, lw=8.0, alpha=0.25, label=at_flat)
    for place, one in enumerate(several):
        low, side = np.sin(one.theta) < _LOW, 1 if one.eta_hat > 0.0 else -1
        style = _NEARER[place // 2 % len(_NEARER)]
        look: dict[str, Any] = {"color": SIGN_COLOURS[side], "ls": style, "lw": 1.6}
        path = np.stack([one.p, one.rho / one.kappa], axis=1)[low]
        ax.plot(*path.T, **look)
        if side > 0:
            ax.plot([], [], **look | {"color": _GREY}, label=_size(one.eta_hat))
        if place >= len(several) - 2:
            arrow(ax, path, int(np.argmax(path[:, 0] > 0.0)), SIGN_COLOURS[side])
    for at, word, where in ((-A, "impact", "right"), (A, "rise", "left")):
        ax.plot(at, 0.0, "o", color=DARK, ms=7, zorder=6)
        ax.text(1.08 * at, 0.0, word, fontsize=TEXT, ha=where, va="center")
    ax.set(xlim=(-1.6 * A, 1.6 * A), ylim=(-1.25 * A, 1.25 * A), aspect="equal")
    ax.set_xticks([-A, 0.0, A], ["$-A$", "0", "$A$"])
    ax.set_yticks([-A, 0.0, A], ["$-A$", "0", "$A$"])
    title = "The nearer to $F$, the closer the race keeps to one orbit"
    dress(ax, r"rate of the tilt $\dot\theta$ ($\sqrt{g/r}$)", r"$\rho/\kappa$ ($\sqrt{g/r}$)", title)
    legend_below(ax, ncols=3)
