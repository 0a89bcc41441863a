"""The paper's nine figures, made anew: angle of contact, axis, centre of mass and contact point beside F.

`figure(number)` gives one; `FIGURES` says what each shows, with a caption that a page can print. All start
upright with sigma2 = sigma3 = 1 and eta_hat_+ = +-0.01 (section 7.2 of the paper), in units m = r = g = 1. Each
panel carries, as a thin dotted line, the one-sided limit of the same start: the motion with eta_+ = 0, continued
through its impacts by the rule of section 7.3.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from explorer.errors import InputError
from explorer.motion.dense_times import dense_times
from explorer.motion.limit_motions import limit_motion
from explorer.motion.passages import passages
from explorer.motion.periods import periods
from explorer.paper.checks import followed
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States, constants_to_states
from explorer.plot.style import DARK, SIGN_COLOURS, axes_or_new, dress, legend

ETA_HAT = 0.01
SIGMA3 = PHIDOT = 1.0
CHI0 = 0.5  # rad; not in the paper, see `INFERRED`
ZOOM = (-0.15, 0.2)  # both axes, the ticks of Fig. 3
_ACCURACY = 1e-9
_WIDTH, _HEIGHT = 8.4, 4.5
_RACE_POINTS = 200
_STEP = 0.05  # rad of chi between two points: the contact point's circles look round at the size of a page
_BODY_WORDS = {"uniform": "the uniform disk", "hoop": "the hoop"}

CHI0_FITS = (0.41, 0.57)  # rad: what the ticks of Fig. 7 leave, to the last digit

INFERRED = (
    f"Not given in the paper: chi(0), here {CHI0:g} rad; the ticks of its Fig. 7 leave {CHI0_FITS[0]:g} to "
    f"{CHI0_FITS[1]:g}."
)
_INFERRED_TOO = {
    1: "The paper says somewhat more than three periods.",
    **dict.fromkeys((2, 4, 5), "The window on the right is that of Fig. 3, whose ticks are known."),
    7: "The length is inferred: 3.4 periods no longer fit the ticks.",
    **dict.fromkeys((6, 8, 9), "The length is inferred: as in Fig. 7."),
}


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
    times = dense_times(state, np.union1d(np.linspace(0.0, turns * tau, 1201), flat), _STEP)
    run = followed(disk, state, times, _ACCURACY, CHI0)
    return Curve(times, run.phi, run.chi, run.path[:, :2], run.contact[:, :2], flat)


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
    return dress(ax, x, y, rf"{_BODY_WORDS[disk.name].removeprefix('the ')}, $\hat\eta_+$ = {eta_hat:+g}")


def _lines(ax: Axes, xy: Array, limit_xy: Array, eta_hat: float) -> None:
    ax.plot(*xy.T, color=SIGN_COLOURS[int(np.sign(eta_hat))], lw=1.5, label="motion")
    ax.plot(*limit_xy.T, color=DARK, lw=0.9, ls=":", label="limit")


def chi_panel(disk: Disk, eta_hat: float, turns: float, ax: Axes | None = None) -> Axes:
    """chi(t), the panels of Fig. 1."""
    ax = axes_or_new(ax)
    here = motion(disk, eta_hat, turns)
    there = limit(disk, int(np.sign(eta_hat)), here.t[-1])
    _lines(ax, np.stack([here.t, here.chi], 1), np.stack([there.t, there.chi], 1), eta_hat)
    for number in range(1, int(turns) + 1):
        ax.axvline(number * period_of(disk, eta_hat), color=DARK, lw=0.5, alpha=0.5)
    legend(ax, loc="upper left" if eta_hat > 0.0 else "lower left")
    return _dressed(ax, disk, eta_hat, r"t ($\sqrt{r/g}$); lines at whole periods", r"$\chi$ (rad)")


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
    if zoom:
        _arrow(ax, here, colour)
        ticks = np.arange(-0.1, 0.21, 0.1)
        ax.set(xticks=ticks, yticks=ticks)
        for both in (ax.xaxis, ax.yaxis):
            both.set_ticks(ticks - 0.05, minor=True)
        ax.set(xlim=ZOOM, ylim=ZOOM)
    else:
        turn = np.linspace(0.0, 2.0 * np.pi, 400)
        ax.plot(np.cos(turn), np.sin(turn), color=DARK, lw=0.8)
        ax.plot(*here.axis[0], marker="o", color=DARK, ms=6, label="start", ls="")
        ax.set(xlim=(-1.08, 1.08), ylim=(-1.08, 1.08))
        legend(ax, loc="lower right")
    ax.set_aspect("equal")
    return _dressed(ax, disk, eta_hat, r"$\cos\varphi\,\cos\chi$", r"$\cos\varphi\,\sin\chi$")


def _arrow(ax: Axes, here: Curve, colour: str) -> None:
    """Which way the axis runs, on its way out of the first flat moment."""
    leaving = here.t > here.flat[0]
    out = np.flatnonzero(leaving & (np.cos(here.phi) > 0.06))[0]
    ahead = np.flatnonzero(leaving & (np.cos(here.phi) > 0.09))[0]
    style = {"arrowstyle": "-|>", "color": colour, "lw": 1.5, "mutation_scale": 18}
    ax.annotate("", tuple(here.axis[ahead]), xytext=tuple(here.axis[out]), arrowprops=style)


def path_panel(disk: Disk, eta_hat: float, turns: float, ax: Axes | None = None, what: str = "centre") -> Axes:
    """Path on the floor of the centre's shadow (Figs. 6, 7) or of the 'contact' point (8, 9)."""
    ax = axes_or_new(ax)
    here = motion(disk, eta_hat, turns)
    there = limit(disk, int(np.sign(eta_hat)), here.t[-1])
    _lines(ax, getattr(here, what), getattr(there, what), eta_hat)
    ax.plot(*getattr(here, what)[0], marker="o", color=DARK, ms=6, ls="", label="start")
    ax.set_aspect("equal", adjustable="box")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MultipleLocator(0.5 if what == "centre" else 1.0))
    legend(ax, loc="best")
    return _dressed(ax, disk, eta_hat, "x (r)", "y (r)")


@dataclass(frozen=True)
class PaperFigure:
    """What a figure of the paper shows: panels as (eta_hat, options of `draw`), length in periods, caption."""

    number: int
    disk: Disk
    turns: float
    draw: Callable[..., Axes]
    panels: tuple[tuple[float, dict[str, Any]], ...]
    caption: str


def _sides(**options: Any) -> tuple[tuple[float, dict[str, Any]], ...]:
    return tuple((eta_hat, options) for eta_hat in (ETA_HAT, -ETA_HAT))


def _caption(number: int, shows: str, disk: Disk, turns: float, panels: str) -> str:
    return (
        f"Fig. {number}. {shows} for {_BODY_WORDS[disk.name]}, over {turns:g} periods; {panels}. "
        f"Dotted: the one-sided limit, same start with eta_+ = 0. {INFERRED} {_INFERRED_TOO.get(number, '')}"
    ).rstrip()


def _make() -> dict[int, PaperFigure]:
    uniform, hoop = Disk.uniform(), Disk.hoop()
    both = f"eta_hat_+ = {ETA_HAT:g} (left), {-ETA_HAT:g} (right)"
    of_v = "The horizontal projection of v = A e3"
    centre, contact = "The path of the centre of mass seen from above", "The path of the point of contact"
    rows: list[tuple[str, Disk, float, Callable[..., Axes], Any, str]] = [
        ("The angle chi(t)", uniform, 3.2, chi_panel, _sides(), both),
        *(
            (
                of_v,
                disk,
                1.4,
                axis_panel,
                ((eta, {}), (eta, {"zoom": True})),
                f"eta_hat_+ = {eta:g}; left all of it, right the middle; dashed where v3 < 0",
            )
            for disk in (uniform, hoop)
            for eta in (ETA_HAT, -ETA_HAT)
        ),
        (centre, uniform, 3.0, path_panel, _sides(what="centre"), both),
        (centre, hoop, 3.0, path_panel, _sides(what="centre"), both),
        (contact, uniform, 3.0, path_panel, _sides(what="contact"), both),
        (contact, hoop, 3.0, path_panel, _sides(what="contact"), both),
    ]
    return {
        number: PaperFigure(number, disk, turns, draw, panels, _caption(number, shows, disk, turns, words))
        for number, (shows, disk, turns, draw, panels, words) in enumerate(rows, 1)
    }


FIGURES = _make()


def figure(number: int) -> Figure:
    """A figure of the paper by its number, 1 to 9. Raises InputError."""
    if number not in FIGURES:
        raise InputError(f"figure = {number!r} is not one of the paper's; give a number from 1 to {len(FIGURES)}")
    plan = FIGURES[number]
    made = Figure(figsize=(_WIDTH, _HEIGHT), layout="constrained")
    for (eta_hat, options), ax in zip(plan.panels, made.subplots(1, len(plan.panels)), strict=True):
        plan.draw(plan.disk, eta_hat, plan.turns, ax=ax, **options)
    return made
