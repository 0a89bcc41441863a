"""Phase portraits of the tilt, and the amended potential that makes them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from explorer.phase.states import Array
from explorer.plot.captions import Question, captioned
from explorer.plot.style import (
    BOUNCES,
    DARK,
    FALLS,
    FLAT_TICKS,
    HALF_PI,
    SERIES,
    SIGN_COLOURS,
    SMALL,
    arrow,
    axes_or_new,
    dress,
    legend_below,
    number,
    open_frame,
    rates_of,
)
from explorer.portrait.potential import CENTRE, SADDLE, Potential
from explorer.portrait.potentials import level_energies

# Curves of the potential: beside the line, the wider the further from it; on it, and where it ends at flat.
_WIDTHS = (1.1, 1.9, 2.8)
BESIDE: dict[int, dict[str, Any]] = {
    1: {"color": SIGN_COLOURS[1], "ls": "-"},
    -1: {"color": SIGN_COLOURS[-1], "ls": (0, (4, 4))},
}
_ON_LINE: dict[str, Any] = {"color": DARK, "lw": 2.4}
_AT_FLAT: dict[str, Any] = {"color": DARK, "ms": 7, "ls": "", "clip_on": False, "zorder": 6}
_MARKS = {CENTRE: ("o", DARK, "centre"), SADDLE: ("X", SERIES[1], "saddle")}
SEPARATRIX = SERIES[1]


@captioned(
    Question.WHICH_MOTIONS,
    "The motions of the tilt at given constants of motion, as levels of the energy. On the line l₊ a motion "
    "runs into the flat state; just beside the line a wall throws it back, and a separatrix parts the well "
    "from the rest.",
)
def phase_portrait(
    potential: Potential, energies: tuple[float, float] | None = None, ax: Axes | None = None, **look: Any
) -> Axes:
    """Draw levels of the energy over (phi, phidot), separatrices and equilibria, over what falls and what bounces.

    Parameters
    ----------
    potential : Potential
        From `explorer.portrait.on_line` or `explorer.portrait.at_constants`.
    energies : (float, float), optional
        Range of the levels, units of the disk; by default from the bottom of V to above all saddles.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the lines of the levels.

    Returns
    -------
    Axes
        phi (rad) and phidot. A flat state behind a wall is a thick line, one that motions reach is dotted.

    References
    ----------
    Section 6.2 of the paper.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import on_line
    >>> plot.phase_portrait(on_line(Disk.uniform(), 0.25)).get_xlabel()
    '$\\\\varphi$ (rad); flat at ±π/2'
    """
    ax = axes_or_new(ax)
    curves = [
        potential.curve(piece)
        for energy in level_energies(potential, energies)
        for piece in potential.components(float(energy))
    ]
    separatrices = [potential.curve(piece) for each in potential.separatrices() for piece in each.branches]
    fastest = 1.08 * max(speed.max() for _, speed in curves)
    _shade(ax, potential, 1.3 * fastest)
    levels: dict[str, Any] = {"color": DARK, "lw": 0.8} | look
    for name, drawn, style in (
        ("level", curves, levels),
        ("separatrix", separatrices, {"color": SEPARATRIX, "lw": 2.4}),
    ):
        for place, (phi, speed) in enumerate(drawn):
            ax.plot(phi, speed, **style, label=None if place else name)
            ax.plot(phi, -speed, **style)
    _arrows(ax, curves, 0.2 * fastest)
    _flat_states(ax, potential)
    _mark(ax, potential, at_energy=False)
    ax.set_xlim(-1.68, 1.68)
    ax.set_ylim(-fastest, fastest)
    ax.set_xticks(*FLAT_TICKS)
    _name_parts(ax, potential)
    return dress(
        ax, r"$\varphi$ (rad); flat at ±π/2", rf"$\dot\varphi$ ({rates_of(potential.disk)})", _title(potential)
    )


def small_portrait(ax: Axes, potential: Potential, energy: float) -> float:
    """Draw a phase portrait that needs no legend, the motions of one energy thick; returns the fastest."""
    chosen = [potential.curve(piece) for piece in potential.components(energy)]
    fastest = 1.25 * max(speed.max() for _, speed in chosen)
    _shade(ax, potential, 2.0 * fastest)
    thin: dict[str, Any] = {"color": "0.45", "lw": 0.6}
    for level in level_energies(potential, (potential.bottom, energy + 0.3 * potential.disk.energy_unit), 7):
        _mirrored(ax, [potential.curve(piece) for piece in potential.components(float(level))], thin)
    separatrices = [potential.curve(piece) for each in potential.separatrices() for piece in each.branches]
    _mirrored(ax, separatrices, {"color": SEPARATRIX, "lw": 1.6})
    _mirrored(ax, chosen, {"color": DARK, "lw": 2.4})
    _arrows(ax, chosen, 0.0, size=16.0)
    _flat_states(ax, potential)
    _mark(ax, potential, at_energy=False, named=False)
    ax.set_xlim(-1.68, 1.68)
    ax.set_xticks([-HALF_PI, 0.0, HALF_PI], ["−π/2", "0", "π/2"])
    ax.tick_params(labelsize=SMALL)
    open_frame(ax)
    return float(fastest)


def _mirrored(ax: Axes, curves: Sequence[tuple[Array, Array]], style: dict[str, Any]) -> None:
    """Draw both halves of levels, phidot >= 0 and <= 0."""
    for phi, speed in curves:
        ax.plot(phi, speed, **style)
        ax.plot(phi, -speed, **style)


def _name_parts(ax: Axes, potential: Potential) -> None:
    """The legend: what falls, what bounces, and the lines."""
    falling = np.isfinite(potential.falling_edge(np.zeros(1))[0])
    patches = [Patch(facecolor=FALLS, label="falls")] if falling else []
    patches.append(Patch(facecolor=BOUNCES, label="bounces"))
    handles = [*patches, *ax.get_legend_handles_labels()[0]]
    for patch in patches:
        patch.set_edgecolor(DARK)
    legend_below(ax, handles=handles, ncols=4)


def _flat_states(ax: Axes, potential: Potential) -> None:
    """Flat states behind a wall, and those that motions reach."""
    walls = {face: bool(np.isinf(potential.flat_value(face))) for face in (-1, 1)}
    for face, wall in walls.items():
        name, dashes, width = ("wall at flat", "-", 4.0) if wall else ("flat, reached", ":", 2.5)
        label = None if face > 0 and walls[-1] == wall else name
        ax.axvline(face * HALF_PI, color=DARK, ls=dashes, lw=width, label=label)


def _arrows(ax: Axes, curves: Sequence[tuple[Array, Array]], least: float, size: float = 11.0) -> None:
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


def _mark(ax: Axes, potential: Potential, at_energy: bool, named: bool = True) -> None:
    seen: set[str] = set()
    for at in potential.equilibria:
        if at.kind in _MARKS:
            marker, colour, name = _MARKS[at.kind]
            label = name if named and name not in seen else None
            seen.add(name)
            height = at.energy if at_energy else 0.0
            style: dict[str, Any] = {"color": colour, "mec": "white", "ms": 9, "ls": "", "zorder": 5}
            ax.plot([at.phi], [height], marker=marker, label=label, **style)


def line_name(potential: Potential) -> str:
    return "l_+" if potential.face > 0 else "l_-"


def _title(potential: Potential) -> str:
    line = line_name(potential)
    where = (
        f"on ${line}$"
        if potential.eta == 0.0
        else rf"$\hat\eta$ = {number(potential.eta_hat, '.4g')} beside ${line}$"
    )
    return rf"{potential.disk.name}: $\bar\sigma_3$ = {potential.sigma3_bar:.4g}, {where}"


@captioned(
    Question.WHICH_MOTIONS,
    "The amended potential on the line of the falling motions and beside it. On the line it ends at a finite "
    "value at flat; beside the line a wall rises there, the steeper the nearer to the line.",
)
def potential_curves(
    potentials: Sequence[Potential], near_flat: bool = False, ax: Axes | None = None, **look: Any
) -> Axes:
    """Draw the amended potential at several constants, with its equilibria: walls off the line, V_0 on it.

    Parameters
    ----------
    potentials : sequence of Potential
        From `explorer.portrait.on_line` or `explorer.portrait.at_constants`, of one disk and one sigma3_bar.
    near_flat : bool
        Draw over the tilt from the flat state of their face, on a logarithmic axis, where the wall rises.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the lines of the levels.

    Returns
    -------
    Axes
        phi or theta (rad), and V in the units of the disk.

    References
    ----------
    Eqs (3.8) and (6.9) of the paper.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import on_line
    >>> ax = plot.potential_curves([on_line(Disk.uniform(), 0.25, eta_hat) for eta_hat in (0.0, 0.01)])
    >>> ax.get_title()
    'uniform: amended potential at $\\\\bar\\\\sigma_3$ = 0.25'
    """
    ax = axes_or_new(ax)
    disk, bar = potentials[0].disk, potentials[0].sigma3_bar
    top = max(float(p.V(0.0)) for p in potentials) + (0.2 if near_flat else 0.6) * disk.energy_unit
    ordered = sorted(potentials, key=lambda p: (p.eta != 0.0, p.eta < 0.0, abs(p.eta)))
    widths = {1: iter(_WIDTHS * len(ordered)), -1: iter(_WIDTHS * len(ordered))}
    several = {sign: sum(np.sign(p.eta) == sign for p in ordered) > 1 for sign in (-1, 1)}
    named: set[str] = set()
    for place, potential in enumerate(ordered):
        sign = int(np.sign(potential.eta))
        style: dict[str, Any] = {"lw": _WIDTHS[1], **BESIDE[sign]} if sign else _ON_LINE
        if sign and several[sign]:
            style = style | {"lw": next(widths[sign])}
        label = _name_of(potential, bool(sign and several[sign]))
        _curve(ax, potential, near_flat, top, {"label": None if label in named else label} | style | look)
        named.add(label)
        if not near_flat:
            _mark(ax, potential, at_energy=True, named=place == 0)
        if sign == 0:
            _end_at_flat(ax, potential, near_flat)
    ax.set_ylim(0.0, top)
    legend_below(ax, ncols=3)
    _tilt_axis(ax, potentials, near_flat)
    x = r"tilt from flat $\theta$ (rad)" if near_flat else r"$\varphi$ (rad); flat at ±π/2"
    unit = "$m g r$" if disk.energy_unit == 1.0 else f"energy; $m g r$ = {disk.energy_unit:.3g}"
    title = rf"{disk.name}: amended potential at $\bar\sigma_3$ = {bar:.4g}"
    return dress(ax, x, f"amended potential $V$ ({unit})", title)


def _name_of(potential: Potential, one_of_several: bool) -> str:
    """A curve in the legend: by its eta_hat, or by its side where others of its side are drawn."""
    if potential.eta == 0.0:
        return r"on the line, $\hat\eta$ = 0"
    if one_of_several:
        return rf"$\hat\eta$ {'>' if potential.eta > 0.0 else '<'} 0"
    return rf"$\hat\eta$ = {number(potential.eta_hat, '.4g')}"


def _end_at_flat(ax: Axes, potential: Potential, near_flat: bool) -> None:
    """Where V ends on the line: V_0."""
    at_flat = potential.flat_value(potential.face) * potential.disk.energy_unit
    if near_flat:
        ax.axhline(at_flat, color=DARK, lw=0.8, ls=":", label=r"$V_0$, at flat")
    else:
        ax.plot([potential.face * HALF_PI], [at_flat], marker="s", label=r"$V_0$", **_AT_FLAT)


def _tilt_axis(ax: Axes, potentials: Sequence[Potential], near_flat: bool) -> None:
    """The horizontal axis: the tilt from flat, logarithmic, or phi."""
    if near_flat:
        ax.set_xscale("log")
        walls = [abs(p.eta_hat) / potentials[0].disk.rate_unit for p in potentials if p.eta]
        ax.set_xlim(2.0, 0.1 * min(walls, default=1e-5))  # flat at the right, as in phi
        if walls:
            ax.text(
                0.97,
                0.95,
                "walls at flat\n" r"$\eta^2/(2I_1\theta^2)$",
                ha="right",
                va="top",
                transform=ax.transAxes,
            )
    else:
        ax.set_xlim(-1.68, 1.68)
        ax.set_xticks(*FLAT_TICKS)


def _curve(ax: Axes, potential: Potential, near_flat: bool, top: float, style: dict[str, Any]) -> None:
    """Draw V up to `top`: over phi, or over the tilt from the flat state of its face."""
    y = np.linspace(0.0, 14.5, 1451) if near_flat else np.linspace(-9.0, 9.0, 1801)
    face = potential.face if near_flat else 1
    V = potential.at_y(face * y).V * potential.disk.energy_unit
    x = 2.0 * np.arctan(np.exp(-y)) if near_flat else np.arctan(np.sinh(y))
    ax.plot(x, np.where(top >= V, V, np.nan), **style)
    if near_flat and potential.eta > 0.0:
        wall = x[np.flatnonzero(top >= V)[-1]]
        size = rf"$\hat\eta = \pm${number(potential.eta_hat, '.4g')}"
        there: dict[str, Any] = {"xytext": (5, 0), "textcoords": "offset points", "fontsize": SMALL}
        ax.annotate(size, (wall, 0.72 * top), color=DARK, va="center", **there)
