"""`nearflat portrait`: the pictures that the paper does not have, each made by one command."""

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from explorer.commands import pictures
from explorer.commands.gallery import picture_lines
from explorer.commands.made_by import leave_page
from explorer.errors import InputError, note, one_of
from explorer.phase.disk import Disk
from explorer.phase.paths import path_of
from explorer.phase.states import constants_to_states
from explorer.portrait.bodies import flat_body, measured_gaps, race_numbers
from explorer.portrait.rocking import rocking
from explorer.portrait.slices import Slice, slice_map
from explorer.portrait.wander import resonance, wander, wander_path
from explorer.scenes.base import Scene
from explorer.scenes.portrait import Portrait

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Pictures = Iterator[tuple[str, "Figure"]]

_CONSTANTS = [option for option in Portrait.OPTIONS if option not in Scene.OPTIONS]
POINTS = 401  # a side of a slice
_BODIES = (0.5, 2.0, 3.0, 4.0, 8.0, 12.0)  # m r^2/I1 at which race numbers are measured
# Paths: beside F, natural units; speeds and sigma3_bar at which a resonance is sought; periods shown.
_ETA_HAT, _SPEEDS, _BARS, _PERIODS = 0.01, (1.0, 0.5, 2.0, 0.25), (0.1, 1.4), 12
# sigma3_bar of a path without a resonance; values of it that are tried for the radius; periods of what closes.
_GENERIC, _TRIED, _WALKED = 0.7, 53, 4


@dataclass(frozen=True)
class Group:
    """Pictures of one kind: what they show, and the function that draws them."""

    text: str
    draw: Callable[[Disk, dict[str, Any]], Pictures]


def _phase(disk: Disk, options: dict[str, Any]) -> Pictures:
    """(phi, phidot) portraits, potentials and steady motions: the pictures of scene portrait."""
    from explorer import plot

    for name, picture in Portrait.of({**options, "disk": disk}).pictures():
        yield name, plot.figure_of(picture)


def _slices(disk: Disk, _options: dict[str, Any]) -> Pictures:
    from explorer import plot

    for number, where in enumerate(Slice.defaults(disk), 1):
        yield f"slice-{number}", plot.figure_of(plot.race_slice_map, slice_map(disk, where, points=POINTS))


def _race(disk: Disk, _options: dict[str, Any]) -> Pictures:
    from explorer import plot

    yield "race-numbers", plot.race_bodies(race_numbers(), measured_gaps([*map(flat_body, _BODIES), disk]))


def _bounces(disk: Disk, _options: dict[str, Any]) -> Pictures:
    from explorer import plot

    several = {one.name: one for one in (Disk.uniform(), Disk.hoop(), disk)}
    yield "bounces", plot.figure_of(plot.rocking_turns, [rocking(one) for one in several.values()])


def _paths(disk: Disk, _options: dict[str, Any]) -> Pictures:
    """A generic rosette and a resonance, chi(tau) a whole number of turns; the radius on the way between."""
    from explorer import plot

    unit = disk.rate_unit
    bars = np.linspace(*_BARS, _TRIED) * unit
    for eta_hat, phidot in ((sign * _ETA_HAT * unit, speed * unit) for speed in _SPEEDS for sign in (1.0, -1.0)):
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
    generic = wander_path(constants_to_states(disk, _GENERIC * unit, eta_hat, phidot), _PERIODS)
    resonant = wander_path(start, _PERIODS)
    # The walk goes on for ever: as much of it as a rosette takes room
    yield "paths", plot.rosette_and_resonance(generic, wander_path(start, _WALKED))
    yield "distance", plot.figure_of(plot.wander_distance, {"generic": generic, "resonant": resonant})
    yield "radius", plot.figure_of(plot.wander_radius, disk, bars, wanders, {whole: bar})


GROUPS = {
    "hero": Group("what happens, on both sides of F", pictures.hero),
    "definitions": Group("what things are called", pictures.definitions),
    "limit": Group("the limit from each side of F", pictures.limit),
    "surface": Group("F as a surface, and under a magnifying glass", pictures.surface),
    "rotation": Group("turns of the contact point per period", pictures.rotation),
    "solvers": Group("general solvers beside this one", pictures.solvers),
    "phase": Group("motions in (phi, phidot), potentials, steady motions", _phase),
    "bifurcation": Group("steady motions, and the motions between them", pictures.bifurcation),
    "slices": Group("slices of the phase space by tilt and by side of F", _slices),
    "race": Group("race number and gap of all bodies", _race),
    "bounces": Group("turn per bounce, from the Euler disk to the race", _bounces),
    "paths": Group("paths over many periods, wander and resonance", _paths),
    "forces": Group("what the contact has to bear over a period", pictures.forces),
    "conservation": Group("what is left of the constants after thousands of passages", pictures.kept),
}
FILM = "film"  # written as it is drawn, not a figure


def portrait(
    out: Path | str, disk: Disk, *, only: str | None = None, quiet: bool = True, **options: Any
) -> list[Path]:
    """Draw all groups of pictures, or one, into a folder; returns the files.

    options, for the group phase, as for scene portrait: sigma3_bar, sigma4_bar or eta_hat, energy, well.
    Raises InputError for an unknown group or a folder that cannot be written.
    """
    names = [*GROUPS, FILM]
    if only is not None:
        one_of("--only", only, names)
    folder = path_of("--out", out)
    if options and only not in (None, "phase"):
        given = ", ".join(f"--{key.replace('_', '-')}" for key in options)
        raise InputError(f"{given}: only the group phase takes this; leave it out, or --only phase")
    # What the options do not allow is said before anything is written.
    Portrait.of({**options, "disk": disk})
    written: dict[str, list[Path]] = {}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name in names if only is None else [only]:
            note(f"drawing {name}", quiet)
            if name == FILM:
                written[name] = _film(folder, disk)
            else:
                written[name] = _write(folder, GROUPS[name].draw(disk, options))
        command = "nearflat portrait" if only is None else f"nearflat portrait --only {only}"
        each = {path.name: f"nearflat portrait --only {name}" for name, paths in written.items() for path in paths}
        leave_page(folder, _page(written, disk, command), command, each)
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be written ({error.strerror})") from None
    return [path for paths in written.values() for path in paths]


def _write(folder: Path, pictures: Pictures) -> list[Path]:
    from explorer.plot import save

    paths = []
    for name, figure in pictures:
        for kind in ("svg", "png"):
            save(figure, folder / f"{name}.{kind}")
        paths.append(folder / f"{name}.png")
    return paths


def _film(folder: Path, disk: Disk) -> list[Path]:
    from explorer import plot

    # The small one for pages, the large one for talks.
    small, large = (folder / f"{FILM}.{kind}" for kind in ("gif", "webp"))
    for path in (small, large):
        plot.animate(path, disk)
    return [small]


def _page(written: dict[str, list[Path]], disk: Disk, command: str) -> list[str]:
    lines = [f"# Portraits of the {disk.name} disk", "", f"Made by `{command}`."]
    for name, paths in written.items():
        text = GROUPS[name].text if name in GROUPS else "nearly falling flat on both sides of F, slower near flat"
        lines += ["", f"## {text[0].upper()}{text[1:]}", "", f"`nearflat portrait --only {name}`"]
        for path in paths:
            lines += ["", *picture_lines(path, path.parent)]
    return lines


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of `nearflat portrait`: those of its pictures, and of scene portrait for the group phase."""
    command.add_argument("--disk", default="uniform", metavar="DISK", help="as for run (default uniform)")
    groups = ", ".join([*GROUPS, FILM])
    command.add_argument("--only", metavar="GROUP", help=f"one group of pictures: {groups} (default all)")
    for option in _CONSTANTS:
        text = f"phase: {option.help_for(Portrait)}"
        if option.metavar:
            command.add_argument(option.flag, metavar=option.metavar, help=text)
        else:
            command.add_argument(option.flag, action="store_const", const=True, help=text)
    command.add_argument("--out", default="results/portrait", metavar="DIR", help="default results/portrait")


def call(options: argparse.Namespace) -> int:
    given = {option.word: getattr(options, option.word) for option in _CONSTANTS}
    given = {name: value for name, value in given.items() if value is not None}
    disk = Disk.parse(options.disk)
    written = portrait(options.out, disk, only=options.only, quiet=options.quiet, **given)
    print(f"{len(written)} pictures are in {options.out}.")
    return 0
