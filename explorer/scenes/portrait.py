"""Scene portrait: phase portraits of the tilt on l_+ and beside it, and the steady motions of a disk.

No samples are drawn. Each chunk is one portrait: the levels of the energy at one pair of constants of motion.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from explorer.errors import InputError
from explorer.measure.sampling import Range, parse_range
from explorer.phase.disk import require_axial_inertia
from explorer.phase.membership import well
from explorer.portrait.potential import (
    Component,
    Potential,
    at_constants,
    level_energies,
    on_line,
    require_well,
    well_separatrix,
)
from explorer.portrait.steady import PATHS, bifurcation, path_values, thresholds
from explorer.scenes.base import Chunks, Scene, Table, Tally

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LEVELS = 9
# Natural units; on l_+ there is a well, a separatrix and, beside it, the wall at once.
SIGMA3_BAR, BESIDE = 0.25, 0.01
# |eta_hat| of the curves of the potential, natural units
_CURVES = (0.001, 0.01, 0.1)


def read_number(option: str, value: Any) -> float:
    """A finite number. Raises InputError naming the option."""
    try:
        number = math.nan if isinstance(value, bool) else float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not abs(number) < 1e100:
        raise InputError(f"{option} {value!r} must be a finite number")
    return number


def read_energies(value: Any) -> Range:
    """(low, high) from "LOW:HIGH" or a pair. Raises InputError."""
    if isinstance(value, str):
        return parse_range(value, "--energies")
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise InputError(f"--energies {value!r} is not a range; give LOW:HIGH or a pair of numbers")
    return read_number("--energies", value[0]), read_number("--energies", value[1])


def read_flag(value: Any) -> bool:
    """True or False. Raises InputError."""
    if not isinstance(value, bool):
        raise InputError(f"--well {value!r} must be true or false")
    return value


@dataclass(frozen=True)
class Portrait(Scene):
    """Portraits at sigma3_bar (rad per unit of time) and one of sigma4_bar or eta_hat.

    With neither, on l_+ and on both sides of it; with eta_hat, on l_+ and there. energies: range of the levels.
    well: insist that l_+ carries a well at sigma3_bar.
    """

    sigma3_bar: float | None = None
    sigma4_bar: float | None = None
    eta_hat: float | None = None
    energies: Range | None = None
    well: bool = False

    name: ClassVar[str] = "portrait"
    observables: ClassVar[tuple[str, ...]] = ("constants",)
    readers: ClassVar[dict[str, Any]] = {
        "sigma3_bar": lambda value: read_number("--sigma3-bar", value),
        "sigma4_bar": lambda value: read_number("--sigma4-bar", value),
        "eta_hat": lambda value: read_number("--eta-hat", value),
        "energies": read_energies,
        "well": read_flag,
    }

    def __post_init__(self) -> None:
        require_axial_inertia(self.disk)
        if self.sigma4_bar is not None and self.eta_hat is not None:
            raise InputError(
                f"--sigma4-bar {self.sigma4_bar:g} and --eta-hat {self.eta_hat:g} say the same; leave out one"
            )
        if self.well:
            require_well(self.disk, self.bar)
            if self.sigma4_bar is not None:
                raise InputError(f"--sigma4-bar {self.sigma4_bar:g}: a well is asked for on l_+; leave it out")
        for potential in self.places().values():
            level_energies(potential, self.energies, LEVELS)

    @property
    def bar(self) -> float:
        """sigma3_bar; unless given, 0.25 natural units, or less where there is no well then."""
        if self.sigma3_bar is not None:
            return self.sigma3_bar
        return min(SIGMA3_BAR, 0.9 * well(self.disk)[1]) * self.disk.rate_unit

    def places(self) -> dict[str, Potential]:
        """The potentials whose portraits are drawn, by name."""
        disk = self.disk
        if self.sigma4_bar is not None:
            return {"given": at_constants(disk, self.bar, self.sigma4_bar)}
        line = {"on": on_line(disk, self.bar)}
        if self.eta_hat is not None:
            return line | ({"beside": on_line(disk, self.bar, self.eta_hat)} if self.eta_hat else {})
        # For bodies whose wells have a small sigma3_bar, that much nearer to the line.
        size = BESIDE / SIGMA3_BAR * min(abs(self.bar), SIGMA3_BAR * disk.rate_unit) or BESIDE * disk.rate_unit
        return line | {"plus": on_line(disk, self.bar, size), "minus": on_line(disk, self.bar, -size)}

    def options(self) -> dict[str, Any]:
        return {
            **self.common_options(),
            "sigma3_bar": self.sigma3_bar,
            "sigma4_bar": self.sigma4_bar,
            "eta_hat": self.eta_hat,
            "energies": self.energies and list(self.energies),
            "well": self.well,
        }

    def chunks(self) -> int:
        return len(self.places())

    def length(self, index: int) -> int:
        """A sample is a level."""
        return LEVELS

    def compute(self, index: int) -> Table:
        """Points of the levels: energy, number of the piece, whether it falls, phi, phidot (upper half)."""
        potential = list(self.places().values())[index]
        parts = []
        for energy in level_energies(potential, self.energies, LEVELS):
            for number, piece in enumerate(potential.components(float(energy))):
                phi, phidot = potential.curve(piece)
                fixed = {"energy": energy, "piece": number, "falls": piece.falls}
                parts.append({key: np.full(phi.size, value) for key, value in fixed.items()})
                parts[-1] |= {"phi": phi, "phidot": phidot, "status": np.zeros(phi.size, np.int8)}
        return {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}

    def tally(self, table: Table) -> Tally:
        return {"status": {"ok": int(np.unique(table["energy"]).size)}}

    def summarise(self, chunks: Chunks) -> dict[str, Any]:
        found: dict[str, Any] = {key: [] for key in ("places", "levels", "equilibria", "separatrices")}
        for (name, potential), table in zip(self.places().items(), chunks.tables(), strict=True):
            found["places"].append(_place(name, potential, table))
            for energy in np.unique(table["energy"]):
                pieces = [_piece(piece) for piece in potential.components(float(energy))]
                found["levels"].append({"place": name, "energy": float(energy), "pieces": pieces})
            for at in potential.equilibria:
                row = {key: getattr(at, key) for key in ("phi", "theta", "energy", "curvature", "kind")}
                found["equilibria"].append({"place": name, **row})
            for each in potential.separatrices():
                row = {"place": name, "phi": each.saddle.phi, "energy": each.saddle.energy}
                found["separatrices"].append({**row, "branches": [_piece(piece) for piece in each.branches]})
        return {
            "samples": len(found["levels"]),
            "sigma3_bar": self.bar,
            **found,
            "thresholds": thresholds(self.disk),
            "well_on_the_line": self._well(),
            "status": {"ok": len(found["levels"])},
        }

    def _well(self) -> dict[str, Any] | None:
        """The well on l_+ at this sigma3_bar, within the left branch of its separatrix."""
        if not 0.0 < abs(self.bar) < well(self.disk)[1] * self.disk.rate_unit:
            return None
        rim = well_separatrix(self.disk, self.bar)
        bottom = min(on_line(self.disk, self.bar).equilibria, key=lambda at: at.phi)
        return {
            "phi": bottom.phi,
            "bottom": bottom.energy,
            "rim": rim.saddle.energy,
            "rim_phi": rim.saddle.phi,
            "left_end": rim.branches[0].low,
        }

    def figures(self, summary: dict[str, Any], chunks: Chunks) -> "Iterator[tuple[str, Figure]]":
        from explorer.plot import potential as potentials
        from explorer.plot import steady, style

        places, disk = self.places(), self.disk
        for name, potential in places.items():
            yield f"portrait-{name}", style.figure_of(potentials.phase_portrait, potential, self.energies)
        line = [*places.values()]
        if self.sigma4_bar is None:
            sizes = [sign * size * disk.rate_unit for size in _CURVES for sign in (1.0, -1.0)]
            line = [on_line(disk, self.bar, eta) for eta in [0.0, *(sizes if self.eta_hat is None else ())]]
            line += [places["beside"]] if "beside" in places else []
        yield "potential", style.figure_of(potentials.potential_curves, line)
        yield "potential-near-flat", style.figure_of(potentials.potential_curves, line, True)
        yield "steady-plane", style.figure_of(steady.steady_plane, disk)
        yield "steady-map", style.figure_of(steady.steady_map, disk)
        for path in PATHS:
            values, marks = path_values(disk, path)
            branches = bifurcation(disk, path, values)
            yield f"steady-{path}", style.figure_of(steady.bifurcations, disk, path, branches, marks)

    def headline(self, summary: dict[str, Any]) -> list[str]:
        lines = []
        for place in summary["places"]:
            kinds = [row["kind"] for row in summary["equilibria"] if row["place"] == place["name"]]
            what = ", ".join(f"{kinds.count(kind)} {kind}" for kind in sorted(set(kinds))) or "no equilibrium"
            ends = "flat within reach" if place["reaches_flat"] else "walls at both flat states"
            lines.append(f"{place['name']} (eta_hat = {place['eta_hat']:.6g}): {what}; {ends}")
        for name in ("straight_rolling", "spinning_upright", "circular_rolling"):
            found = summary["thresholds"][name]
            lines.append(f"{name}: {found['measured']:.10g} from V, {found['closed_form']:.10g} in closed form")
        return lines


def _place(name: str, potential: Potential, table: Table) -> dict[str, Any]:
    inside = abs(table["phi"]) < 1.5
    kinetic = 0.5 * potential.disk.body.M * (table["phidot"][inside] / potential.disk.rate_unit) ** 2
    energy = kinetic * potential.disk.energy_unit + potential.V(table["phi"][inside])
    return {
        "name": name,
        "sigma4_bar": potential.sigma4_bar,
        "eta_hat": potential.eta_hat,
        "face": potential.face,
        "reaches_flat": [face for face in (-1, 1) if math.isfinite(potential.flat_value(face))],
        # Of all points of the levels with |phi| < 1.5 rad
        "largest_energy_error": float(abs(energy / table["energy"][inside] - 1.0).max(initial=0.0)),
    }


def _piece(piece: Component) -> dict[str, Any]:
    return {"low": piece.low, "high": piece.high, "ends": list(piece.ends), "falls": piece.falls}
