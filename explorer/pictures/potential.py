"""Phase portraits of the tilt, alone and on both sides of F, and the amended potential that makes them."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from explorer.errors import InputError
from explorer.phase.potential import CENTRE, SADDLE, Component, Potential
from explorer.phase.states import Array
from explorer.pictures.register import Question, picture
from explorer.pictures.style import (
    BOUNCES,
    DARK,
    FALLS,
    FLAT_TICKS,
    HALF_PI,
    SERIES,
    SIDES,
    SIGN_COLOURS,
    SIZE,
    SMALL,
    TEXT,
    arrow,
    coordinate_label,
    dress,
    legend_below,
    legend_of_all,
    number,
    open_frame,
    rates_of,
)

STEADY = SERIES[1]  # steady motions and their separatrices
WALL = "#A0A0A0"
_MARKS = {CENTRE: "o", SADDLE: "X"}
# Beside the line, by its side.
_BESIDE: dict[int, dict[str, Any]] = {
    1: {"color": SIGN_COLOURS[1], "ls": "-"},
    -1: {"color": SIGN_COLOURS[-1], "ls": (0, (4, 4))},
}
_WIDTHS = (1.1, 1.9, 2.8)  # of curves beside the line: the wider the further from it
_LEVELS_OF_SIDES = 4
_NEAR = (0.001, 0.01, 0.1)  # |eta_hat| of curves of the potential, natural units
Curve = tuple[Array, Array]


@picture(
    Question.WHICH_MOTIONS,
    "The motions of the tilt at given constants of motion, as levels of the energy. On the line l₊ a motion runs "
    "into the flat state; just beside the line a wall throws it back, and one curve, the separatrix, separates "
    "the motions that stay in the valley of the potential from all others.",
    group="phase",
    portraits=lambda asked: [
        (f"portrait-{name}", (each, asked.energy))
        for name, each in asked.places.items()
        if name not in ("plus", "minus")
    ],
)
def phase_portrait(ax: Axes, potential: Potential, energies: tuple[float, float] | None = None) -> None:
    """Draw levels of the energy over (phi, phidot), separatrices and equilibria, section 6.2.

    potential: from `explorer.potential`. energies: range of the levels; by default from the bottom of V to
    above all saddles. A flat state behind a wall is a thick line, one that motions reach is dotted.
    """
    curves = _levels(potential, potential.levels(energies))
    fastest = 1.08 * max(speed.max() for _, speed in curves)
    _shade(ax, potential, 1.3 * fastest)
    _mirrored(ax, curves, color=DARK, lw=0.8, label="level")
    _mirrored(ax, _separatrices(potential), color=STEADY, lw=2.4, label="separatrix")
    _arrows(ax, curves, 0.2 * fastest)
    _flat_states(ax, potential)
    _mark(ax, potential)
    ax.set_ylim(-fastest, fastest)
    legend_below(ax, handles=[*grounds([potential]), *ax.get_legend_handles_labels()[0]], ncols=4)
    eta_hat = rf"$\hat\eta$ = {number(potential.eta_hat, '.4g')} beside"
    title = f"{_name(potential)}, {'on' if potential.hat == 0.0 else eta_hat} ${_line(potential)}$"
    phi_axis(ax)
    dress(ax, r"$\varphi$ (rad); flat at ±π/2", coordinate_label("phidot", potential.disk), title)


def grounds(several: Iterable[Potential]) -> list[Patch]:
    """What the grounds of portraits mean: whether motions fall."""
    fall = any(np.isfinite(each.falling_edge(np.zeros(1))[0]) for each in several)
    falls = [Patch(fc=FALLS, ec=DARK, label="falls")] if fall else []
    return [*falls, Patch(fc=BOUNCES, ec=DARK, label="bounces")]


def small_portrait(ax: Axes, potential: Potential, energy: float) -> float:
    """Draw a phase portrait without a legend, the motions of one energy thick; returns the fastest."""
    chosen = _levels(potential, [energy])
    fastest = 1.25 * max(speed.max() for _, speed in chosen)
    _shade(ax, potential, 2.0 * fastest)
    others = potential.levels((potential.bottom, energy + 0.3 * potential.disk.energy_unit), 7)
    _mirrored(ax, chosen, color=DARK, lw=2.4, label="this energy")
    _mirrored(ax, _levels(potential, others), color=DARK, lw=0.6, alpha=0.7, label="others")
    _mirrored(ax, _separatrices(potential), color=STEADY, lw=1.6, label="separatrix")
    _arrows(ax, chosen, 0.0, size=16.0)
    _flat_states(ax, potential)
    _mark(ax, potential)
    ax.set_xlim(-1.9, 1.9)
    ax.set_xticks([-HALF_PI, 0.0, HALF_PI], ["−π/2", "0", "π/2"])
    ax.tick_params(labelsize=SMALL)
    open_frame(ax)
    return float(fastest)


def phi_axis(ax: Axes) -> None:
    """The horizontal axis, from one flat state to the other."""
    ax.set_xlim(-1.68, 1.68)
    ax.set_xticks(*FLAT_TICKS)


def _levels(potential: Potential, energies: Iterable[float]) -> list[Curve]:
    return [potential.curve(piece) for energy in energies for piece in potential.components(float(energy))]


def _separatrices(potential: Potential) -> list[Curve]:
    return [potential.curve(piece) for each in potential.separatrices() for piece in each.branches]


def _mirrored(ax: Axes, curves: Sequence[Curve], **look: Any) -> None:
    """Draw both halves of levels, phidot >= 0 and <= 0."""
    for phi, speed in curves:
        ax.plot(phi, np.stack([speed, -speed], axis=1), **look)


def _flat_states(ax: Axes, potential: Potential) -> None:
    """Flat states behind a wall, and those that motions reach."""
    for face in (-1, 1):
        wall = bool(np.isinf(potential.at_flat(face)))
        name, dashes, width = ("wall at flat", "-", 4.0) if wall else ("flat, reached", ":", 2.5)
        ax.axvline(face * HALF_PI, color=WALL, ls=dashes, lw=width, label=name)


def _arrows(ax: Axes, curves: Sequence[Curve], least: float, size: float = 11.0) -> None:
    """The way of the motion on each level that is faster than `least` in its middle."""
    for phi, speed in curves:
        row = int(np.argmin(abs(phi - 0.5 * (phi[0] + phi[-1]))))
        if 0 < row < len(phi) - 1 and speed[row] > least:
            for sign in (1, -1):
                here = np.stack([phi, sign * speed], axis=1)[::sign]
                arrow(ax, here, row if sign > 0 else len(phi) - 1 - row, DARK, size=size)


def _shade(ax: Axes, potential: Potential, fastest: float) -> None:
    y = np.linspace(-9.0, 9.0, 1201)
    phi, edge = np.arctan(np.sinh(y)), np.minimum(potential.falling_edge(y), fastest)
    ax.axvspan(-HALF_PI, HALF_PI, color=BOUNCES, lw=0, zorder=0)
    for sign in (1, -1):
        ax.fill_between(phi, sign * edge, sign * fastest, color=FALLS, lw=0, zorder=0)


def _mark(ax: Axes, potential: Potential, at_energy: bool = False) -> None:
    """Mark the equilibria, at phidot = 0 or at their energy."""
    for kind, marker in _MARKS.items():
        there = [(at.phi, at.energy if at_energy else 0.0) for at in potential.equilibria if at.kind == kind]
        if there:
            style: dict[str, Any] = {"color": STEADY, "mec": "white", "ms": 9, "ls": "", "zorder": 5}
            ax.plot(*np.transpose(there), marker=marker, label=kind, **style)


def _line(potential: Potential) -> str:
    return "l_+" if potential.face > 0 else "l_-"


def _name(potential: Potential) -> str:
    return rf"{potential.disk.name}: $\bar\sigma_3$ = {potential.sigma3_bar:.4g}"


# Both sides of F


@picture(
    Question.WHICH_MOTIONS,
    "Corresponding motions on the two sides of F, blue and vermilion, in two planes. Left, the angle φ to the "
    "vertical and its rate: the sides are alike, and both turn back just before flat. Right, the speed of the "
    "contact point along the rim, ρ = σ₃/cos φ, against the rate of the tilt: near flat each motion runs along "
    "half of an ellipse, and the two halves are the races, in opposite directions. The loops inside, alike on "
    "both sides, are where the disk turns back at the other end of its swing.",
    (SIZE[0], 4.2),
    "phase",
    lambda asked: [
        ("portrait-sides", (each, asked.energy)) for name, each in asked.places.items() if name == "plus"
    ],
)
def portrait_of_sides(figure: Figure, potential: Potential, energies: tuple[float, float] | None = None) -> None:
    """Draw levels of the energy on both sides of F, in the plane of the tilt and in that of the race, eq. (7.6).

    potential: from `explorer.potential`, for constants on one side of a line l_+ or l_-. The other side is its
    mirror image, with -eta_hat.
    """
    if potential.hat == 0.0:
        raise InputError(
            "picture portrait-of-sides: the potential is on F itself; give one with an eta_hat beside it"
        )
    tilt, race = figure.subplots(1, 2, sharey=True)
    for side in (1, -1):
        each = replace(potential, hat=side * abs(potential.hat))
        _one_side(tilt, race, each, each.levels(energies, _LEVELS_OF_SIDES))
        tilt.lines[-1].set_label(rf"$\hat\eta$ = {number(each.eta_hat, '.4g')}")
    for face in (-1, 1):
        tilt.axvline(face * HALF_PI, color=WALL, lw=3.0)
    race.axvline(0.0, color=DARK, lw=0.6)
    phi_axis(tilt)
    tilt.set_xticks([-HALF_PI, 0.0, HALF_PI], ["−π/2", "0", "π/2"])
    rate, unit = coordinate_label("phidot", potential.disk), rates_of(potential.disk)
    dress(tilt, r"$\varphi$ (rad); flat at ±π/2", rate, "The tilt: both sides alike")
    dress(race, rf"along the rim, $\rho$ ({unit})", "", "The race: opposite ways")
    legend_of_all(figure, [tilt])
    figure.suptitle(f"{_name(potential)}, beside ${_line(potential)}$", fontsize=TEXT)


def _one_side(tilt: Axes, race: Axes, potential: Potential, energies: Iterable[float]) -> None:
    """The levels of one side that come near its flat state, in both planes."""
    side = 1 if potential.hat > 0.0 else -1
    end, way = (1 if potential.face > 0 else 0), 1.0
    for energy in energies:
        for piece in potential.components(float(energy)):
            if potential.face * piece.y[end] > 1.0:
                way = _on_both_planes(tilt, race, potential, piece, side)
    place: dict[str, Any] = {"ha": "right" if way > 0.0 else "left", "va": "top", "transform": race.transAxes}
    race.text(0.5 + 0.46 * way, 0.97, SIDES[side], color=SIGN_COLOURS[side], fontsize=TEXT, **place)


def _on_both_planes(tilt: Axes, race: Axes, potential: Potential, piece: Component, side: int) -> float:
    """One level: phidot against phi and against rho, with the way of the motion; returns the sign of the race."""
    phi, speed = potential.curve(piece)
    # There and back: phi grows while phidot > 0
    phi, rate = np.concatenate([phi, phi[::-1]]), np.concatenate([speed, -speed[::-1]])
    rho = potential.rho(phi)
    tilt.plot(phi, rate, lw=1.5, **_BESIDE[side])
    race.plot(rho, rate, lw=1.5, **_BESIDE[side])
    flattest = len(phi) // 2 - 1 if potential.face > 0 else len(phi) - 1
    arrow(race, np.stack([rho, rate], axis=1), flattest, SIGN_COLOURS[side])
    return float(np.sign(rho[flattest]))


# The potential itself


def _curves(places: dict[str, Potential]) -> list[tuple[str, tuple[Any, ...]]]:
    """What `nearflat portrait` draws of V: the potentials asked, or where none is, several beside the line."""
    every = wide = [*places.values()]
    if not {"given", "beside"} & set(places):
        on = places["on"]
        every = [on, *(replace(on, hat=sign * size) for size in _NEAR for sign in (1.0, -1.0))]
        wide = [
            each for each in every if abs(each.hat) in (0.0, _NEAR[-1])
        ]  # on the axis of phi the others are one
    return [("potential", (wide,)), ("potential-near-flat", (every, True))]


@picture(
    Question.WHICH_MOTIONS,
    "The amended potential, in which the tilt moves like a particle: for constants of motion on the line of the "
    "falling motions, and for constants beside it. On the line, its value at flat is finite; beside the line, it "
    "rises towards flat like a wall, as η²/(2I₁θ²) at a tilt θ from flat.",
    group="phase",
    portraits=lambda asked: _curves(asked.places),
)
def potentials(ax: Axes, several: Sequence[Potential], near_flat: bool = False) -> None:
    """Draw V, eqs (3.8) and (6.9), of several potentials of one disk and one sigma3_bar, with its equilibria.

    near_flat: draw them against the tilt from the flat state of their face, on a logarithmic axis, which shows
    how the wall rises.
    """
    disk = several[0].disk
    top = max(float(each.V(0.0)) for each in several) + (0.2 if near_flat else 0.6) * disk.energy_unit
    ordered = sorted(several, key=lambda each: (each.hat != 0.0, each.hat < 0.0, abs(each.hat)))
    signs = [int(np.sign(each.hat)) for each in ordered]
    for place, (potential, side) in enumerate(zip(ordered, signs, strict=True)):
        alone = signs.count(side) == 1
        style = {"color": DARK, "lw": 2.4}
        if side:
            style = {**_BESIDE[side], "lw": _WIDTHS[1 if alone else signs[:place].count(side) % len(_WIDTHS)]}
        name = (
            rf"$\hat\eta$ = {number(potential.eta_hat, '.4g')}"
            if side and alone
            else rf"$\hat\eta$ {'>' if side > 0 else '<'} 0"
        )
        name = name if side else r"on the line, $\hat\eta$ = 0"
        _curve(ax, potential, near_flat, top, {**style, "label": name})
        if not near_flat:
            _mark(ax, potential, at_energy=True)
        if side == 0:
            _end_at_flat(ax, potential, near_flat)
    ax.set_ylim(-0.05 * top, top)  # V_0, hardly above 0, stands clear of the axis
    legend_below(ax, ncols=2 if near_flat else 3)
    x = r"$\varphi$ (rad); flat at ±π/2"
    if near_flat:
        x = r"tilt from flat $\theta$ (rad)"
        walls = [abs(each.eta_hat) / disk.rate_unit for each in several if each.hat]
        ax.set_xscale("log")
        ax.set_xlim(2.0, 0.1 * min(walls, default=1e-5))  # flat at the right, as in phi
    else:
        phi_axis(ax)
    unit = "$m g r$" if disk.energy_unit == 1.0 else f"energy; $m g r$ = {disk.energy_unit:.3g}"
    title = f"{_name(several[0])}, {'beside $F$ a wall rises at flat' if near_flat else 'amended potential'}"
    dress(ax, x, f"amended potential $V$ ({unit})", title)


def _end_at_flat(ax: Axes, potential: Potential, near_flat: bool) -> None:
    """Where V ends on the line: V_0."""
    at_flat = potential.at_flat(potential.face)
    if near_flat:
        ax.axhline(at_flat, color=DARK, lw=1.4, ls=":", label=r"$V_0$, at flat")
    else:
        style: dict[str, Any] = {"color": DARK, "ms": 7, "ls": "", "clip_on": False, "zorder": 6}
        ax.plot([potential.face * HALF_PI], [at_flat], marker="s", label=r"$V_0$", **style)


def _curve(ax: Axes, potential: Potential, near_flat: bool, top: float, style: dict[str, Any]) -> None:
    """Draw V up to `top`: over phi, or over the tilt from the flat state of its face."""
    y = np.linspace(0.0, 14.5, 1451) if near_flat else np.linspace(-9.0, 9.0, 1801)
    V = potential.at_y((potential.face if near_flat else 1) * y).V * potential.disk.energy_unit
    x = 2.0 * np.arctan(np.exp(-y)) if near_flat else np.arctan(np.sinh(y))
    ax.plot(x, np.where(top >= V, V, np.nan), **style)
    if near_flat and potential.hat > 0.0:
        wall = x[np.flatnonzero(top >= V)[-1]]
        size = rf"$\hat\eta = \pm${number(potential.eta_hat, '.4g')}"
        there: dict[str, Any] = {"xytext": (5, 0), "textcoords": "offset points", "fontsize": SMALL}
        ax.annotate(size, (wall, 0.72 * top), color=DARK, va="center", **there)
