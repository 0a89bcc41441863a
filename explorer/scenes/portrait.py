"""Scene portrait: phase portraits of the tilt on l_+ and beside it, and the steady motions of a disk.

No samples are drawn. Each chunk is one portrait: the levels of the energy at one pair of constants of motion.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Any, ClassVar

import numpy as np

from explorer.errors import InputError
from explorer.measure.sampling import Range
from explorer.measure.tallies import ByName
from explorer.phase.bifurcation import thresholds
from explorer.phase.disk import require_axial_inertia
from explorer.phase.falling_set import well
from explorer.phase.potential import Component, Potential
from explorer.phase.potential import potential as potential_at
from explorer.scenes.options import NUMBER, RANGE, option
from explorer.scenes.scene import Counts, Picture, Scene, Table, joined

LEVELS = 9
# Natural units; on l_+ there is a well, a separatrix and, beside it, the wall at once.
SIGMA3_BAR, BESIDE = 0.25, 0.01


class PortraitCounts(Counts):
    """Rows of the summary, ready for JSON: places, levels, equilibria and separatrices."""

    rows: ByName[list[Any]]


class Portrait(Scene):
    """Which motions exist at given constants of motion? Portraits, equilibria, separatrices, thresholds.

    With neither sigma4_bar nor eta_hat, on l_+ and on both sides of it; with eta_hat, on l_+ and there. Constants
    are in the units of the disk. energy: range of the levels.
    """

    sigma3_bar: float | None = option(
        NUMBER, "constant of motion, in the units of the disk", words="0.25 natural units"
    )
    sigma4_bar: float | None = option(NUMBER, "the other constant, in the units of the disk, instead of eta_hat")
    eta_hat: float | None = option(
        NUMBER,
        "signed distance from F on face +1, in the units of the disk",
        words="three: 0, and one on each side",
    )
    energy: Range | None = option(
        RANGE, "range of the energies whose curves the phase portraits show, in the units of the disk"
    )

    tally = PortraitCounts
    observables: ClassVar[tuple[str, ...]] = ("constants",)
    columns = ("energy", "piece", "falls", "phi", "phidot", "status")
    kernels = ("falling.critical_X2_batch", "falling.line_chart_batch")

    def __post_init__(self) -> None:
        super().__post_init__()
        require_axial_inertia(self.disk)
        if self.sigma4_bar is not None and self.eta_hat is not None:
            raise InputError(
                f"sigma4_bar {self.sigma4_bar:g} and eta_hat {self.eta_hat:g} set the same quantity; leave one out"
            )
        for potential in self.places().values():
            potential.levels(self.energy, LEVELS)

    @property
    def bar(self) -> float:
        """sigma3_bar; unless given, 0.25 natural units, or less where there is no well then."""
        if self.sigma3_bar is not None:
            return self.sigma3_bar
        return min(SIGMA3_BAR, 0.9 * well(self.disk).sigma3_bar) * self.disk.rate_unit

    def places(self) -> dict[str, Potential]:
        """The potentials whose portraits are drawn, by name."""
        disk = self.disk
        if self.sigma4_bar is not None:
            return {"given": potential_at(disk, self.bar, sigma4_bar=self.sigma4_bar)}
        line = {"on": potential_at(disk, self.bar)}
        if self.eta_hat is not None:
            return line | ({"beside": potential_at(disk, self.bar, self.eta_hat)} if self.eta_hat else {})
        # For bodies whose wells have a small sigma3_bar, that much nearer to the line.
        size = BESIDE / SIGMA3_BAR * min(abs(self.bar), SIGMA3_BAR * disk.rate_unit) or BESIDE * disk.rate_unit
        return line | {"plus": potential_at(disk, self.bar, size), "minus": potential_at(disk, self.bar, -size)}

    @property
    def chunks(self) -> int:
        return len(self.places())

    def length(self, index: int) -> int:
        """A sample is a level."""
        return LEVELS

    def chunk(self, index: int) -> tuple[Table, PortraitCounts]:
        """Points of the levels of one portrait: energy, number of the piece, whether it falls, phi, phidot."""
        name, potential = list(self.places().items())[index]
        levels = {E: potential.components(E) for E in potential.levels(self.energy, LEVELS).tolist()}
        parts: list[Table] = []
        for energy, pieces in levels.items():
            for place, piece in enumerate(pieces):
                phi, phidot = potential.curve(piece)
                fixed = {"energy": energy, "piece": place, "falls": piece.falls}
                parts.append({key: np.full(phi.size, value) for key, value in fixed.items()})
                parts[-1] |= {"phi": phi, "phidot": phidot, "status": np.zeros(phi.size, np.int8)}
        table, own = joined(parts), ("phi", "theta", "energy", "curvature", "kind")
        rows: dict[str, list[dict[str, Any]]] = {
            "levels": [{"energy": energy, "pieces": _pieces(pieces)} for energy, pieces in levels.items()],
            "equilibria": [{key: getattr(at, key) for key in own} for at in potential.equilibria],
            "separatrices": [
                {"phi": each.saddle.phi, "energy": each.saddle.energy, "branches": _pieces(each.branches)}
                for each in potential.separatrices()
            ],
        }
        tally = PortraitCounts()
        tally.status["ok"] += len(levels)
        tally.rows["places"] += [_place(name, potential, table)]
        for kind, each in rows.items():
            tally.rows[kind] += [{"place": name, **row} for row in each]
        return table, tally

    def summarise(self, tally: PortraitCounts) -> dict[str, Any]:
        return {
            "samples": tally.status["ok"],
            "sigma3_bar": self.bar,
            **tally.rows,
            "thresholds": thresholds(self.disk),
            "status": dict(tally.status),
        }

    def figures(self, summary: dict[str, Any], tally: PortraitCounts) -> Iterator[tuple[str, Picture]]:
        """All pictures of the group, which need no run."""
        from explorer.pictures.calls import portraits_of

        return portraits_of("phase", self)

    def headline(self, summary: dict[str, Any]) -> list[str]:
        lines = []
        for place in summary["places"]:
            kinds = [row["kind"] for row in summary["equilibria"] if row["place"] == place["name"]]
            what = ", ".join(f"{kinds.count(kind)} {kind}" for kind in sorted(set(kinds))) or "no equilibrium"
            ends = "flat within reach" if place["reaches_flat"] else "walls at both flat states"
            lines.append(f"{place['name']} (eta_hat = {place['eta_hat']:.6g}): {what}; {ends}")
        for name in ("straight_rolling", "spinning_upright", "circular_rolling"):
            lines.append(
                f"threshold of {name.replace('_', ' ')}: {summary['thresholds'][name]['closed_form']:.10g}"
            )
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
        "reaches_flat": [face for face in (-1, 1) if math.isfinite(potential.at_flat(face))],
        # Of all points of the levels with |phi| < 1.5 rad
        "largest_energy_error": float(abs(energy / table["energy"][inside] - 1.0).max(initial=0.0)),
    }


def _pieces(pieces: Sequence[Component]) -> list[dict[str, Any]]:
    return [{"low": each.low, "high": each.high, "ends": [*each.ends], "falls": each.falls} for each in pieces]
