"""Bifurcations of steady motions along a path through the constants: their tilts, and their energies."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from explorer.errors import InputError, one_of
from explorer.phase.bifurcation import PATHS, Branch, bifurcation, whole_path
from explorer.phase.disk import Disk
from explorer.phase.potential import CENTRE, SADDLE, Component, Potential
from explorer.phase.states import Array
from explorer.pictures.potential import STEADY, grounds, small_portrait
from explorer.pictures.register import Question, picture
from explorer.pictures.style import (
    BOUNCES,
    DARK,
    FALLS,
    FLAT_TICKS,
    HALF_PI,
    SERIES,
    SIZE,
    SMALL,
    TEXT,
    UNSTABLE,
    coordinate_label,
    dress,
    label,
    legend_below,
    legend_of_all,
    values_label,
)

# The constant that goes along a path, and what motions are on it.
_ALONG = {
    "spinning": ("sigma3_bar", r"motions with $\bar\sigma_4$ = 0: spinning upright"),
    "rolling": ("sigma4_bar", r"motions with $\bar\sigma_3$ = 0: straight rolling"),
    "line": ("sigma3_bar", "motions on the falling line $l_+$"),
}
_ON = {"spinning": r"$\bar\sigma_4$ = 0", "rolling": r"$\bar\sigma_3$ = 0", "line": "on $l_+$"}
_SAYS = {"line": "only motions in the well do not fall"}
_OF_WELLS = "motions of little energy keep to one of two wells"
_DRAWN = ("line", "spinning")  # by `nearflat portrait`
# Thresholds of the bodies that the paper names, in closed form.
_EXACT = {
    ("uniform", "rolling"): r" = ±$1/\sqrt{3}$",
    ("uniform", "spinning"): r" = ±$2/\sqrt{5}$",
    ("hoop", "rolling"): " = ±1/2",
    ("hoop", "spinning"): r" = ±$\sqrt{2/3}$",
}
_SHARES = (0.55, 1.2)  # of the threshold: where the places of portraits lie
_SAME = 1e-9  # of an energy: nearer levels are one


@picture(
    Question.WHICH_MOTIONS,
    "The tilt of steady motions, those that keep their tilt, along a path in the plane of constants: solid where "
    "they are stable, dashed where they are not. At the thin vertical line a branch appears, ends or changes its "
    "stability.",
    group="phase",
    portraits=lambda asked: [(f"steady-{path}", (asked.disk, path)) for path in PATHS],
)
def bifurcation_of_tilts(ax: Axes, disk: Disk, path: str) -> None:
    """Draw the tilts of all steady motions along a path through the plane of constants.

    path: "spinning" (sigma4_bar = 0), "rolling" (sigma3_bar = 0) or "line" (on l_+), as for
    `explorer.bifurcation`.
    """
    threshold = PATHS[one_of("path", path, PATHS)].threshold(disk)
    branches, marks = whole_path(disk, path), (threshold, -threshold)
    looks: dict[str, tuple[Any, str]] = {CENTRE: ("-", "stable"), SADDLE: ((0, (3, 1.5)), "unstable")}
    for branch in branches:
        line, name = looks[branch.kind]
        ax.plot(branch.parameter, branch.phi, color=DARK, ls=line, lw=2.0, label=name)
    name = f"threshold ±{threshold / disk.rate_unit:.5f}{_EXACT.get((disk.name, path), '')}"
    for mark in marks:
        ax.axvline(mark, color=SERIES[1], lw=1.4, ls=":", label=name)
    if path == "line":
        ax.set_xlim(-1.8 * threshold, 1.8 * threshold)
        for mark in marks:
            ax.text(1.4 * mark, 0.0, "no steady\nmotion", ha="center", va="center", fontsize=SMALL)
    ax.set_ylim(-1.68, 1.68)
    ax.set_yticks(*FLAT_TICKS)
    for flat in (-HALF_PI, HALF_PI):
        ax.axhline(flat, color=DARK, lw=0.6)
    legend_below(ax, ncols=3)
    along, words = _ALONG[path]
    dress(ax, coordinate_label(along, disk), r"$\varphi$ (rad); flat at ±π/2", f"{disk.name}, steady {words}")


@picture(
    Question.WHICH_MOTIONS,
    "Which motions there are: the vertical axis is the energy, and the horizontal axis follows a path through "
    "the plane of the two constants of motion. Up to three kinds of curve cut the picture into regions: the "
    "energies of stable steady motions, those of unstable ones, and, on l₊, the energy V₀ above which the disk "
    "can reach flat. Each region has a letter; the picture of the regions shows a phase portrait for each "
    "letter.",
    group="bifurcation",
    portraits=lambda asked: [(f"bifurcation-{path}", (asked.disk, path)) for path in _DRAWN],
)
def bifurcation_of_energies(
    ax: Axes, disk: Disk, path: str, places: Sequence[tuple[float, float]] | None = None
) -> None:
    """Draw the energies of steady motions along a path, section 6.2, and the regions that they bound.

    path: as for bifurcation-of-tilts. places: the points that get a letter, each a pair: the parameter of the path
    and the energy, units of the disk; by default one in each region.
    """
    threshold = PATHS[one_of("path", path, PATHS)].threshold(disk)
    places = [place for place, _ in _of_places(disk, path, threshold, places)]
    near = np.geomspace(1e-6, 0.2, 90)  # dense at zero and at the threshold, to well beyond
    parameter = threshold * np.unique(np.concatenate([near, np.linspace(0.2, 1.5, 40), 1.0 - near, 1.0 + near]))
    branches = bifurcation(disk, path, parameter)
    floor = least_energies(disk, path, parameter, branches)
    top, falling = 1.12 * max(energy for _, energy in places), path == "line"
    below = -0.05 * top  # V_0 is hardly above 0: it and the ground below it are seen
    ground = FALLS if falling else BOUNCES
    ax.fill_between(parameter, floor, top, color=ground, lw=0, zorder=0)
    ax.fill_between(parameter, below, floor, fc="white", ec="0.8", hatch="//", lw=0, zorder=0)
    low, high = _along(parameter, branches, CENTRE, np.fmin), _along(parameter, branches, SADDLE, np.fmax)
    both = np.isfinite(low) & np.isfinite(high)
    ax.fill_between(parameter[both], low[both], high[both], color=UNSTABLE, lw=0, zorder=1)
    looks: dict[str, dict[str, Any]] = {
        CENTRE: {"ls": "-", "label": "stable steady motion"},
        SADDLE: {"ls": (0, (4, 1.5)), "label": "unstable one"},
    }
    for branch in branches:
        ax.plot(branch.parameter, branch.energy, color=STEADY, lw=2.4, **looks[branch.kind], zorder=3)
    if falling:
        ax.plot(parameter, floor, color=DARK, lw=2.6, ls=":", label="$V_0$, at flat")
    ax.axvline(threshold, color=DARK, lw=0.8, label="threshold")
    for number, place in enumerate(places):
        ax.plot(*place, "o", ms=14, color="white", mec="0.5", zorder=5)
        middle: dict[str, Any] = {"ha": "center", "va": "center_baseline"}
        ax.text(*place, _letter(number), fontweight="bold", fontsize=SMALL, zorder=6, **middle)
    ax.set_xlim(0.0, 1.45 * threshold)
    ax.set_ylim(below, top)
    parts = (
        Patch(fc=UNSTABLE, ec=DARK, label="a well, or a fall" if falling else "two wells"),
        Patch(fc=ground, ec=DARK, label="falls" if falling else "one well"),
        Patch(fc="white", ec="0.6", hatch="//", label="no motion"),
    )
    legend_below(ax, ncols=3, handles=[*ax.get_legend_handles_labels()[0], *parts])
    along, on = _ALONG[path][0], _ON[path]
    merge = "the well closes" if falling else "two wells become one"
    title = f"{disk.name}, {on}: {merge} at {values_label({along: threshold}, disk)}"
    label(ax, disk, along, "energy", title)


@picture(
    Question.WHICH_MOTIONS,
    "A phase portrait for each region that has a letter in the picture of the energies along a path. The thick "
    "curves are the motions with the energy at which the letter stands in that picture, and the title says what "
    "they do. Where the background is violet, the disk falls; elsewhere it goes to and fro. If there are two "
    "wells and the energy is small, it stays in one of them.",
    (SIZE[0], 5.2),
    "bifurcation",
    lambda asked: [(f"regions-{path}", (asked.disk, path)) for path in _DRAWN],
)
def portraits_of_regions(
    figure: Figure, disk: Disk, path: str, places: Sequence[tuple[float, float]] | None = None
) -> None:
    """Draw a small phase portrait for each letter of bifurcation-of-energies.

    path, places: as there.
    """
    threshold = PATHS[one_of("path", path, PATHS)].threshold(disk)
    found = _of_places(disk, path, threshold, places)
    rows = -(-len(found) // 3)
    panels = figure.subplots(rows, -(-len(found) // rows), sharex=True, sharey=True, squeeze=False)
    for ax in panels.ravel()[len(found) :]:
        ax.axis("off")
    fastest = 0.0
    for number, (ax, ((_, energy), potential)) in enumerate(zip(panels.ravel(), found, strict=False)):
        fastest = max(fastest, small_portrait(ax, potential, energy))
        title = f"{_letter(number)}: at this energy\n{_fate(potential.components(energy))}"
        dress(ax, "", "", title)
    for ax in panels[-1]:
        ax.set_xlabel(r"$\varphi$ (rad)", fontsize=TEXT)
    for ax in panels[:, 0]:
        ax.set_ylabel(coordinate_label("phidot", disk), fontsize=TEXT)
    panels[0, 0].set_ylim(-1.1 * fastest, 1.1 * fastest)
    figure.suptitle(f"{disk.name}, {_ON[path]}: {_SAYS.get(path, _OF_WELLS)}", fontsize=TEXT)
    legend_of_all(figure, panels.ravel(), ncols=3, more=grounds(potential for _, potential in found))


def _of_places(
    disk: Disk, path: str, threshold: float, places: Sequence[tuple[float, float]] | None
) -> list[tuple[tuple[float, float], Potential]]:
    """Places, by default one in each region, with their potentials. Raises InputError where there is no motion."""
    chosen = one_in_each_region(disk, path, threshold) if places is None else places
    found = [(place, PATHS[path].potential(disk, place[0])) for place in chosen]
    for (at, energy), potential in found:
        if not energy > potential.bottom:
            least = f"give more than {potential.bottom:g}"
            raise InputError(f"places: there is no motion of energy {energy:g} at {at:g}; {least}")
    return found


def one_in_each_region(disk: Disk, path: str, threshold: float) -> list[tuple[float, float]]:
    """Between the levels on one side of the threshold and above them, and as high on its other side."""
    inner, outer = (share * threshold for share in _SHARES)
    levels = _changes(PATHS[path].potential(disk, inner))
    energies = [0.5 * (low + high) for low, high in pairwise(levels)]
    energies.append(levels[-1] + 0.25 * disk.energy_unit)
    beyond = max(energies[-1], _changes(PATHS[path].potential(disk, outer))[-1] + 0.1 * disk.energy_unit)
    return [(inner, energy) for energy in energies] + [(outer, beyond)]


def _changes(potential: Potential) -> list[float]:
    """Energies at which the motions change: where V ends at flat, and of equilibria; increasing."""
    ends = [potential.at_flat(face) for face in (-1, 1)]
    found: list[float] = []
    for energy in sorted([end for end in ends if np.isfinite(end)] + [at.energy for at in potential.equilibria]):
        if not found or energy - found[-1] > _SAME * potential.disk.energy_unit:
            found.append(energy)
    return found


def _letter(number: int) -> str:
    return chr(ord("A") + number)


def _fate(pieces: tuple[Component, ...]) -> str:
    """What motions of one energy do."""
    falls = [piece.falls for piece in pieces]
    if any(falls):
        return "all fall" if all(falls) else "some fall"
    return "all bounce" if len(pieces) == 1 else f"{len(pieces)} wells"


def least_energies(disk: Disk, path: str, parameter: Array, branches: Sequence[Branch]) -> Array:
    """The least energy of all motions along the path."""
    if path == "line":
        return np.asarray(disk.energy_at_flat(parameter))
    floor = _along(parameter, branches, CENTRE, np.fmin)
    for row in np.flatnonzero(np.isnan(floor)):  # at the threshold, where the one steady motion is of no branch
        floor[row] = PATHS[path].potential(disk, float(parameter[row])).bottom
    return floor


def _along(parameter: Array, branches: Sequence[Branch], kind: str, choose: np.ufunc) -> Array:
    """Energies of steady motions of one kind, the least or the largest; NaN where there are none."""
    energy = np.full(parameter.size, np.nan)
    for branch in branches:
        if branch.kind == kind:
            rows = np.searchsorted(parameter, branch.parameter)
            energy[rows] = choose(energy[rows], branch.energy)
    return energy
