"""The paper's nine figures, made anew: angle of contact, axis, centre of mass and contact point beside F.

`figure(number)` gives one; `FIGURES` says what each shows, with a caption that a page can print. All start
upright with sigma2 = sigma3 = 1 and eta_hat_+ = +-0.01 (section 7.2 of the paper), in units m = r = g = 1. Each
panel carries, as a thin dotted line, the one-sided limit of the same start: the motion with eta_+ = 0, continued
through its impacts by the rule of section 7.3.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from explorer.errors import InputError, positive
from explorer.motion.limit_motions import limit_motion
from explorer.motion.passages import passages
from explorer.motion.periods import periods
from explorer.motion.trajectories import finer, trajectories
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.states import Array, States, constants_to_states
from explorer.pictures.register import Caption, Question, add_caption
from explorer.pictures.style import (
    DARK,
    SIGN_COLOURS,
    SMALL,
    arrow,
    axes_or_new,
    dress,
    number,
    times_of,
)

ETA_HAT = 0.01
SIGMA3 = PHIDOT = 1.0
CHI0 = 0.5  # rad; not in the paper, see `INFERRED`
ZOOM = (-0.15, 0.2)  # both axes, the ticks of Fig. 3
_ACCURACY = 1e-9
_WIDTH, _HEIGHT = 8.4, 5.0
_RACE_POINTS = 200
# Of a step of the record, for less than 0.05 rad of chi between two points, though parts of a step are uneven:
# circles look round at the size of a page.
_PARTS = 5
_BODY_WORDS = {"uniform": "the uniform disk", "hoop": "the hoop"}

CHI0_FITS = (0.41, 0.57)  # rad: what the ticks of Fig. 7 leave, to the last digit

INFERRED = (
    f"Not given in the paper: χ(0), here {CHI0:g} rad; the ticks of its Fig. 7 leave {CHI0_FITS[0]:g} to "
    f"{CHI0_FITS[1]:g}."
)
INFERRED_TOO = (
    "Fig. 1: the paper says somewhat more than three periods.",
    "Figs. 2, 4, 5: the window on the right is that of Fig. 3, whose ticks are known.",
    "Figs. 6 to 9: the length is inferred from Fig. 7, where 3.4 periods no longer fit the ticks.",
)


@dataclass(frozen=True)
class Curve:
    """A motion as the figures need it; arrays over times t, units m = r = g = 1.

    phi, chi: rad, chi starts at `CHI0`. axis: horizontal part of v = A e3, eq. (2.30); centre, contact: horizontal
    parts of a and p, eqs (2.33), (2.35); (nt, 2). flat: times of the flattest moments (of impact, for a limit).
    """

    t: Array
    phi: Array
    chi: Array
    centre: Array
    contact: Array
    flat: Array

    @property
    def axis(self) -> Array:
        axis: Array = np.cos(self.phi)[:, None] * np.stack([np.cos(self.chi), np.sin(self.chi)], axis=1)
        return axis


def start(disk: Disk, eta_hat: float) -> States:
    """The paper's initial state: upright, sigma2 = sigma3 = 1, sigma4 = (I1 r'(0)/(I3 r(0))) - eta_hat."""
    return constants_to_states(disk, SIGMA3, eta_hat, PHIDOT)


def period_of(disk: Disk, eta_hat: float) -> float:
    """tau, eq. (3.13), by quadrature."""
    return float(periods(start(disk, eta_hat), _ACCURACY).period[0])


def motion(disk: Disk, eta_hat: float, turns: float) -> Curve:
    """The motion over `turns` periods, with the flattest moments among its times."""
    state, tau = start(disk, eta_hat), period_of(disk, eta_hat)
    first = 0.5 * float(passages(disk, SIGMA3, eta_hat, PHIDOT, accuracy=_ACCURACY).duration[0])
    flat = np.arange(first, turns * tau, tau)
    # Steps of a fixed method do not follow an estimated error, so the points are the same in all units.
    run = trajectories(state, turns * tau, method="rk8", accuracy=_ACCURACY, chi0=CHI0)
    t = np.union1d(finer(run.t[0], _PARTS), flat)
    at = run(t)
    phi, chi, path, contact = (getattr(at, name)[0] for name in ("phi", "chi", "path", "contact"))
    return Curve(t, phi, chi, path[:, :2], contact[:, :2], flat)


def limit(disk: Disk, sign: int, t_end: float) -> Curve:
    """The limit of `motion` as eta_hat -> 0 with this sign, up to t_end; the race takes no time in it."""
    state = start(disk, 0.0)
    going = limit_motion(state, sign)
    flat = going.impacts(t_end)
    t = np.setdiff1d(np.linspace(0.0, t_end, 1201), flat)
    # At the impact itself rounding decides whether the jump has been made: look just after it.
    between, hits = going(t), going(flat + 1e-12 * going.period)
    jump = sign * disk.race_limit
    chi_race = hits.chi[:, None] + jump * np.linspace(-1.0, 0.0, _RACE_POINTS)
    rim = np.stack([np.cos(chi_race + CHI0), np.sin(chi_race + CHI0)], axis=2)
    centre_race = np.repeat(_turned(hits.path)[:, None], _RACE_POINTS, axis=1)
    races = {
        "t": np.repeat(flat, _RACE_POINTS),
        "phi": np.repeat(hits.phi, _RACE_POINTS),
        "chi": chi_race.ravel() + CHI0,
        "centre": centre_race.reshape(-1, 2),
        "contact": (centre_race + disk.r * np.sign(hits.phi)[:, None, None] * rim).reshape(-1, 2),
    }
    swings = {
        "t": t,
        "phi": between.phi,
        "chi": between.chi + CHI0,
        "centre": _turned(between.path),
        "contact": _turned(between.contact),
    }
    order = np.argsort(np.concatenate([t, races["t"]]), kind="stable")
    columns: dict[str, Array] = {key: np.concatenate([swings[key], races[key]])[order] for key in swings}
    return Curve(**columns, flat=flat)


def _turned(path: Array) -> Array:
    """Horizontal part, turned so that chi starts at CHI0."""
    plane = (path[..., 0] + 1j * path[..., 1]) * np.exp(1j * CHI0)
    return np.stack([plane.real, plane.imag], axis=-1)


def _dressed(ax: Axes, disk: Disk, eta_hat: float, x: str, y: str) -> Axes:
    return dress(ax, x, y, rf"{_in_words(disk).removeprefix('the ')}, $\hat\eta_+$ = {number(eta_hat, '+g')}")


def _in_words(disk: Disk) -> str:
    return _BODY_WORDS.get(disk.name, f"the disk {disk.name}")


def _lines(ax: Axes, xy: Array, limit_xy: Array, eta_hat: float) -> None:
    colour = SIGN_COLOURS[int(np.sign(eta_hat))]
    ax.plot(*xy.T, color=colour, lw=1.5, label=rf"$\hat\eta_+$ = {number(eta_hat, '+g')}")
    ax.plot(*limit_xy.T, color=DARK, lw=0.9, ls=":", label="limit")


def chi_panel(disk: Disk, eta_hat: float, turns: float, ax: Axes | None = None) -> Axes:
    """chi(t), the panels of Fig. 1."""
    ax = axes_or_new(ax)
    here = motion(disk, eta_hat, turns)
    sign = int(np.sign(eta_hat))
    there = limit(disk, sign, here.t[-1])
    _lines(ax, np.stack([here.t, here.chi], 1), np.stack([there.t, there.chi], 1), eta_hat)
    for period in range(1, int(turns) + 1):
        label = "whole periods" if period == 1 else None
        ax.axvline(period * period_of(disk, eta_hat), color=DARK, lw=0.5, alpha=0.5, label=label)
    race = there.chi[there.t == there.flat[0]]
    x = there.flat[0] + 0.04 * here.t[-1]
    ends: dict[str, Any] = {"arrowstyle": "<->", "color": DARK, "lw": 1.0, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (x, race[0]), xytext=(x, race[-1]), arrowprops=ends)
    text = f"{'+' if sign > 0 else '−'}κπ = {number(sign * disk.race_limit, '+.2f')}"
    # Clear of the curve, which comes back through the middle of a race to the other side
    ax.text(
        x + 0.02 * here.t[-1],
        race[0] + (0.5 if sign > 0 else 0.05) * (race[-1] - race[0]),
        text,
        va="center",
        fontsize=SMALL,
    )
    return _dressed(ax, disk, eta_hat, f"t ({times_of(disk)})", r"$\chi$ (rad)")


def axis_panel(disk: Disk, eta_hat: float, turns: float, ax: Axes | None = None, zoom: bool = False) -> Axes:
    """Horizontal projection of v = A e3, the panels of Figs. 2 to 5; `zoom`: near the origin."""
    ax = axes_or_new(ax)
    here = motion(disk, eta_hat, turns)
    there = limit(disk, int(np.sign(eta_hat)), here.t[-1])
    upper = here.phi >= 0.0
    colour = SIGN_COLOURS[int(np.sign(eta_hat))]
    for seen, style, label in ((upper, "-", r"$v_3 \geq 0$"), (~upper, "--", r"$v_3 < 0$")):
        ax.plot(*np.where(seen[:, None], here.axis, np.nan).T, color=colour, lw=1.5, ls=style, label=label)
    ax.plot(*there.axis.T, color=DARK, lw=0.9, ls=":", label="limit")
    leaving = here.t > here.flat[0]
    for tilt in (0.09,) if zoom else (0.4, 0.8):
        arrow(ax, here.axis, int(np.flatnonzero(leaving & (np.cos(here.phi) > tilt))[0]), colour)
    if zoom:
        ticks = np.arange(-0.1, 0.21, 0.1)
        ax.set(xticks=ticks, yticks=ticks)
        for both in (ax.xaxis, ax.yaxis):
            both.set_ticks(ticks - 0.05, minor=True)
        ax.set(xlim=ZOOM, ylim=ZOOM)
    else:
        turn = np.linspace(0.0, 2.0 * np.pi, 400)
        ax.plot(np.cos(turn), np.sin(turn), color=DARK, lw=0.8, label="equator: upright")
        ax.plot(*here.axis[0], marker="o", color=DARK, ms=6, label="start", ls="")
        again = int(np.searchsorted(here.t, period_of(disk, eta_hat)))
        after: dict[str, Any] = {"marker": "s", "mfc": "white", "color": DARK, "ms": 6, "ls": "", "zorder": 5}
        ax.plot(*here.axis[min(again, len(here.t) - 1)], label="after one period", **after)
        ax.set(xlim=(-1.08, 1.08), ylim=(-1.08, 1.08))
    ax.set_aspect("equal")
    return _dressed(ax, disk, eta_hat, r"$\cos\varphi\,\cos\chi$", r"$\cos\varphi\,\sin\chi$")


def path_panel(disk: Disk, eta_hat: float, turns: float, ax: Axes | None = None, what: str = "centre") -> Axes:
    """Path on the floor of the centre's shadow (Figs. 6, 7) or of the 'contact' point (8, 9)."""
    ax = axes_or_new(ax)
    here = motion(disk, eta_hat, turns)
    there = limit(disk, int(np.sign(eta_hat)), here.t[-1])
    path = getattr(here, what)
    _lines(ax, path, getattr(there, what), eta_hat)
    colour = SIGN_COLOURS[int(np.sign(eta_hat))]
    for time in here.flat + 0.33 * period_of(disk, eta_hat):
        arrow(ax, path, min(int(np.searchsorted(here.t, time)), len(path) - 1), colour)
    flattest = path[np.searchsorted(here.t, here.flat)]
    rings: dict[str, Any] = {"marker": "o", "mfc": "white", "color": DARK, "ms": 5, "ls": "", "zorder": 5}
    ax.plot(*flattest.T, label="flattest moments", **rings)
    ax.plot(*path[0], marker="o", color=DARK, ms=6, ls="", label="start")
    ax.set_aspect("equal", adjustable="box")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MultipleLocator(1.0))
        axis.set_minor_locator(MultipleLocator(0.5))
    return _dressed(ax, disk, eta_hat, "x (r)", "y (r)")


@dataclass(frozen=True)
class PaperFigure:
    """What a figure of the paper shows: panels as (side of F, options of `draw`), length in periods, words.

    shows: the caption of the paper's own body and eta_hat, without what is said of all figures.
    """

    number: int
    disk: Disk
    turns: float
    draw: Callable[..., Axes]
    panels: tuple[tuple[int, dict[str, Any]], ...]
    shows: str

    @property
    def one_scale(self) -> bool:
        """Whether the panels compare both sides of F."""
        return len({side for side, _ in self.panels}) == 2

    def caption(self, disk: Disk, eta_hat: float) -> str:
        """What is seen and what to look at, for a body and a size of eta_hat."""
        text = self.shows.format(
            body=_in_words(disk),
            kappa=f"{disk.kappa:.4g}",
            turns=f"{self.turns:g}",
            eta=number(eta_hat),
            signed=number(self.panels[0][0] * eta_hat),
        )
        own = _same_body(disk, self.disk) and eta_hat == ETA_HAT
        name = f"Fig. {self.number}." if own else f"As Fig. {self.number}."
        printed = _PRINTED.get(self.number, "") if own else ""
        return f"{name} {text} {printed} Dotted: the one-sided limit of the same start.".replace("  ", " ")


_PRINTED = dict.fromkeys((8, 9), "The paper prints 0.01 for both panels; the right one is −0.01.")
_OF_SIDES = "with η̂₊ = {eta} on the left and −{eta} on the right, on one scale"
_CHI = (
    "The angle χ(t) of {body} over {turns} periods, " + _OF_SIDES + ". In each near-fall it jumps by κπ, with "
    "κ = {kappa}: up on one side of F, down on the other."
)
_AXIS = (
    "The horizontal projection of the axis v = A e₃ of {body} over {turns} periods, with η̂₊ = {signed}: all of it "
    "on the left, the middle on the right. It starts on the equator, comes in to the origin, where the disk is "
    "nearly flat, turns round it by κπ, with κ = {kappa}, and leaves; it is broken where v₃ < 0."
)
_CENTRE = (
    "The path of the centre of mass of {body} seen from above, over {turns} periods, " + _OF_SIDES + ". At the "
    "rings the disk is flattest and the centre nearly stands still; the sides of F leave in different directions."
)
_CONTACT = (
    "The path of the point of contact of {body} seen from above, over {turns} periods, " + _OF_SIDES + ". Around "
    "each ring, where the disk is flattest, it runs round a circle of the rim, one way or the other by side of F."
)


def _make() -> dict[int, PaperFigure]:
    uniform, hoop = Disk.uniform(), Disk.hoop()

    def sides(**options: Any) -> tuple[tuple[int, dict[str, Any]], ...]:
        return tuple((side, options) for side in (1, -1))

    rows: list[tuple[Disk, float, Callable[..., Axes], Any, str]] = [
        (uniform, 3.2, chi_panel, sides(), _CHI),
        *(
            (disk, 1.4, axis_panel, ((side, {}), (side, {"zoom": True})), _AXIS)
            for disk in (uniform, hoop)
            for side in (1, -1)
        ),
        *((disk, 3.0, path_panel, sides(what="centre"), _CENTRE) for disk in (uniform, hoop)),
        *((disk, 3.0, path_panel, sides(what="contact"), _CONTACT) for disk in (uniform, hoop)),
    ]
    return {count: PaperFigure(count, *row) for count, row in enumerate(rows, 1)}


FIGURES = _make()


def _same_body(one: Disk, other: Disk) -> bool:
    return math.isclose(one.body.I1, other.body.I1) and math.isclose(one.body.I3, other.body.I3)


def _natural(disk: Disk) -> Disk:
    """The same body in units m = r = g = 1, in which the figures are."""
    unit = disk.m * disk.r**2
    return Disk(I1=disk.I1 / unit, I3=disk.I3 / unit, name=disk.name)


def figure(number: int, disk: Disk | None = None, eta_hat: float = ETA_HAT) -> Figure:
    """A figure of the paper by its number, 1 to 9, also of another body or at another distance from F.

    eta_hat: its size, in sqrt(g/r); which sides are shown is the figure's. Raises InputError.
    """
    if number not in FIGURES:
        raise InputError(f"figure = {number!r} is not one of the paper's; give a number from 1 to {len(FIGURES)}")
    plan = FIGURES[number]
    if disk is not None:
        require_axial_inertia(disk)
    body = plan.disk if disk is None else _natural(disk)
    size = positive("eta_hat", eta_hat)
    made = Figure(figsize=(_WIDTH, _HEIGHT), layout="constrained")
    panels = made.subplots(1, len(plan.panels), sharex=plan.one_scale, sharey=plan.one_scale)
    for (side, options), ax in zip(plan.panels, panels, strict=True):
        plan.draw(body, side * size, plan.turns, ax=ax, **options)
    entries = {
        label: handle for ax in panels for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)
    }
    made.legend(
        [*entries.values()], [*entries], loc="outside lower center", ncols=4, fontsize=SMALL, frameon=False
    )
    add_caption(made, Caption(Question.PAPER, plan.caption(body, size)))
    return made
