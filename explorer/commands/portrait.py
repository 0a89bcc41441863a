"""`nearflat portrait`: the pictures that the paper does not have, each made by one command.

A group is a function that yields names and pictures of a disk; its docstring is the title above them. Lengths on
the way from F are in natural units, `unit` is sqrt(g/r): sigma3_bar and phidot of most pictures.
"""

import argparse
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from explorer.commands import Answer
from explorer.commands.gallery import picture_lines
from explorer.errors import InputError, note, one_of
from explorer.phase.disk import Disk
from explorer.phase.paths import made_folder
from explorer.phase.states import constants_to_states
from explorer.portrait.bifurcation_portraits import bifurcation_portraits
from explorer.portrait.bodies import flat_body, measured_gaps, race_numbers
from explorer.portrait.conservation import conservation as conserved
from explorer.portrait.contact_forces import contact_forces
from explorer.portrait.falling_surface import falling_surface, zoom
from explorer.portrait.film import film
from explorer.portrait.general_solvers import general_solvers
from explorer.portrait.near_flat import near_flat, toward_limits
from explorer.portrait.rocking import rocking
from explorer.portrait.rotation import rotation_map
from explorer.portrait.slices import Slice, slice_map
from explorer.portrait.wander import resonance, wander, wander_path
from explorer.scenes.options import DISK, FOLDER, Options, Reader, option, options_of
from explorer.scenes.portrait import Portrait
from explorer.scenes.scene import Scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Pictures = Iterator[tuple[str, "Figure"]]

POINTS = 401  # a side of a slice
FILM = "film"  # written as it is drawn, not a figure


def hero(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """what happens, on both sides of F"""
    from explorer import plot

    # Near enough to F that the disk looks flat, far enough that its race is seen to take time.
    yield "hero", plot.hero(film(disk, 0.01 * unit, unit, unit, 300))


def definitions(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """what things are called"""
    from explorer import plot

    yield "definitions", plot.definitions(disk)


def limit(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """the limit from each side of F"""
    from explorer import plot

    yield "limit-paths", plot.limit_paths(toward_limits(disk, (0.3, 0.1, 0.01, 1e-4), unit, unit))
    for name, sizes, draw in (
        ("race-collapse", (0.1, 1e-2, 1e-4, 1e-8), partial(plot.figure_of, plot.race_collapse)),
        ("blow-up", (0.1, 0.03, 0.01, 0.003), plot.blow_up),
    ):
        yield name, draw(near_flat(disk, [sign * size * unit for size in sizes for sign in (1, -1)], unit, unit))


def surface(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """F as a surface, and under a magnifying glass"""
    from explorer import plot

    yield "falling-surface", plot.falling_surface(falling_surface(disk, unit))
    halves = [half * unit for half in (0.3, 3e-5, 3e-9, 3e-13)]  # sides of squares round a point of F
    yield "zoom", plot.zoom_on_f(zoom(disk, halves, unit, unit))


def rotation(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """turns of the contact point per period"""
    from explorer import plot

    yield "rotation", plot.figure_of(plot.rotation_map, rotation_map(disk, 2.0 * disk.energy_unit))


def solvers(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """general solvers beside this one"""
    from explorer import plot

    sizes = np.logspace(-1.0, -8.0, 50) * np.resize([1.0, -1.0], 50)  # the sides in turn
    yield "missed-races", plot.missed_races(general_solvers(disk, sizes * unit, unit, unit))


def phase(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """motions in (phi, phidot), potentials, steady motions"""
    from explorer import plot

    for name, picture in Portrait.of({**given, "disk": disk}).pictures():
        yield name, plot.figure_of(picture)


def bifurcation(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """steady motions, and the motions between them"""
    from explorer import plot

    for path in ("line", "spinning"):
        yield f"bifurcation-{path}", plot.bifurcation_portraits(bifurcation_portraits(disk, path))


def slices(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """slices of the phase space by tilt and by side of F"""
    from explorer import plot

    for number, where in enumerate(Slice.defaults(disk), 1):
        yield f"slice-{number}", plot.figure_of(plot.race_slice_map, slice_map(disk, where, points=POINTS))


def race(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """race number and gap of all bodies"""
    from explorer import plot

    bodies = map(flat_body, (0.5, 2.0, 3.0, 4.0, 8.0, 12.0))  # by m r^2/I1
    yield "race-numbers", plot.race_bodies(race_numbers(), measured_gaps([*bodies, disk]))


def bounces(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """turn per bounce, from the Euler disk to the race"""
    from explorer import plot

    several = {one.name: one for one in (Disk.uniform(), Disk.hoop(), disk)}
    yield "bounces", plot.figure_of(plot.rocking_turns, [rocking(one) for one in several.values()])


def paths(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """paths over many periods, wander and resonance"""
    from explorer import plot

    # A resonance, chi(tau) a whole number of turns, is sought among motions of several speeds and many sigma3_bar.
    bars = np.linspace(0.1, 1.4, 53) * unit
    for eta_hat, phidot in ((sign * 0.01 * unit, v * unit) for v in (1.0, 0.5, 2.0, 0.25) for sign in (1.0, -1.0)):
        wanders = wander(constants_to_states(disk, bars, eta_hat, phidot))
        turns = wanders.chi / (2.0 * np.pi)
        met = np.flatnonzero(np.floor(turns[1:]) != np.floor(turns[:-1]))
        if met.size:
            break
    else:
        raise InputError("--only paths: no resonance chi(tau) = 2 pi n was found for this disk; take another one")
    i = int(met[0])
    whole = int(max(np.floor(turns[i]), np.floor(turns[i + 1])))
    bar, start = resonance(disk, eta_hat, phidot, whole, (bars[i], bars[i + 1]))
    generic = wander_path(constants_to_states(disk, 0.7 * unit, eta_hat, phidot), 12)
    # The walk goes on for ever: as much of it as a rosette takes room
    yield "paths", plot.rosette_and_resonance(generic, wander_path(start, 4))
    yield (
        "distance",
        plot.figure_of(plot.wander_distance, {"generic": generic, "resonant": wander_path(start, 12)}),
    )
    yield "radius", plot.figure_of(plot.wander_radius, disk, bars, wanders, {whole: bar})


def forces(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """what the contact has to bear over a period"""
    from explorer import plot

    sizes = [size * unit for size in (0.3, 0.1, 0.01)]
    yield "forces", plot.contact_forces(contact_forces(disk, sizes, unit, unit))


def conservation(disk: Disk, unit: float, given: dict[str, Any]) -> Pictures:
    """what is left of the constants after thousands of passages"""
    from explorer import plot

    yield "conservation", plot.conservation(conserved(disk))


GROUPS: dict[str, Callable[[Disk, float, dict[str, Any]], Pictures]] = {
    each.__name__: each
    for each in (
        *(hero, definitions, limit, surface, rotation, solvers, phase, bifurcation),
        *(slices, race, bounces, paths, forces, conservation),
    )
}


class Drawn(Options):
    """What is drawn, and where it goes."""

    disk: Disk = option(DISK, "as for run", default=Disk.uniform())
    only: str | None = option(
        Reader(partial(one_of, known=[*GROUPS, FILM]), "GROUP", "str"),
        f"one group of pictures: {', '.join([*GROUPS, FILM])}",
        words="all",
    )
    out: Path = option(FOLDER, "folder", default=Path("results/portrait"))


_OF_PHASE = {each.name for each in options_of(Portrait)} - {each.name for each in options_of(Scene)}


def portrait(asked: Drawn, given: dict[str, Any], quiet: bool = True) -> list[Path]:
    """Draw all groups of pictures, or one, into a folder; returns the files.

    given, for the group phase, as for scene portrait: sigma3_bar, sigma4_bar or eta_hat, energy, well. Raises
    InputError where they cannot be used.
    """
    folder, disk, files = asked.out, asked.disk, list[Path]()
    if given and asked.only not in (None, "phase"):
        names = ", ".join(f"--{key.replace('_', '-')}" for key in given)
        raise InputError(f"{names}: only the group phase takes this; leave it out, or --only phase")
    # What the options do not allow is said before anything is written.
    Portrait.of({**given, "disk": disk})
    command = "nearflat portrait" + (f" --only {asked.only}" if asked.only else "")
    lines = [f"# Portraits of the {disk.name} disk", "", f"Made by `{command}`."]
    made_folder("--out", folder)
    for name in [asked.only] if asked.only else [*GROUPS, FILM]:
        note(f"drawing {name}", quiet)
        text, drawn = _drawn(name, folder, disk, given)
        lines += ["", f"## {text[0].upper()}{text[1:]}", "", f"`nearflat portrait --only {name}`"]
        lines += [line for path in drawn for line in ("", *picture_lines(path, folder))]
        files += drawn
    (folder / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return files


def _drawn(name: str, folder: Path, disk: Disk, given: dict[str, Any]) -> tuple[str, list[Path]]:
    """Draw a group; its title, and the files that a page shows."""
    from explorer import plot

    if name == FILM:  # the small one for pages, the large one for talks
        small, large = (folder / f"{FILM}.{kind}" for kind in ("gif", "webp"))
        for path in (small, large):
            plot.animate(path, disk)
        return "nearly falling flat on both sides of F, slower near flat", [small]
    files = []
    for each, figure in GROUPS[name](disk, disk.rate_unit, given):
        for kind in ("svg", "png"):
            plot.save(figure, folder / f"{each}.{kind}")
        files.append(folder / f"{each}.png")
    return str(GROUPS[name].__doc__), files


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of `nearflat portrait`: those of its pictures, and of scene portrait for the group phase."""
    Drawn.add_to(command)
    Portrait.add_to(command, _OF_PHASE)


def call(options: argparse.Namespace) -> Answer:
    """Draw, and say how many there are."""
    asked = Drawn.of(Drawn.said(options))
    given = {name: value for name, value in Portrait.said(options).items() if name in _OF_PHASE}
    files = [str(path) for path in portrait(asked, given, options.quiet)]
    return Answer({"files": files}, f"{len(files)} pictures are in {asked.out}.")
