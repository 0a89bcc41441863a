"""What phase portraits are drawn of: the potentials on F and beside it, and the levels of the energy in them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from explorer.phase.bifurcation import thresholds
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.falling_set import well
from explorer.phase.potential import Component, Potential, potential

# Natural units; on l_+ there is a well, a separatrix and, beside it, the wall at once.
SIGMA3_BAR, BESIDE = 0.25, 0.01


@dataclass(frozen=True)
class Portrait:
    """Which motions of the tilt exist at given constants of motion: what `nearflat portrait` draws.

    With neither sigma4_bar nor eta_hat, the constants are those on the line l_+ and on both sides of it; with
    eta_hat, on l_+ and there.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    sigma3_bar : float, optional
        Constant of motion, units of the disk; by default 0.25 natural units, or less for a body that has no well
        on l_+ there.
    sigma4_bar : float, optional
        The other constant, units of the disk, instead of eta_hat.
    eta_hat : float, optional
        Signed distance from F on face +1, units of the disk.
    energy : (float, float), optional
        Range of the energies of the levels, units of the disk; by default from the bottom of each potential to
        above its saddles.

    Raises
    ------
    InputError
        For a disk with I3 = 0, for sigma4_bar and eta_hat together, and for energies that no motion has.

    Examples
    --------
    >>> import explorer as ex
    >>> from explorer.phase.portrait import Portrait
    >>> found = Portrait(ex.Disk.uniform(), eta_hat=0.01).describe()
    >>> [(at["place"], at["kind"]) for at in found["equilibria"]][:3]
    [('on', 'centre'), ('on', 'saddle'), ('beside', 'centre')]
    """

    disk: Disk
    sigma3_bar: float | None = None
    sigma4_bar: float | None = None
    eta_hat: float | None = None
    energy: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        require_axial_inertia(self.disk)
        for each in self.places.values():
            each.levels(self.energy)

    @cached_property
    def places(self) -> dict[str, Potential]:
        """The potentials whose portraits are drawn, by name: given; on, and beside; or on, plus and minus."""
        disk, unit, bar = self.disk, self.disk.rate_unit, self.sigma3_bar
        if bar is None:
            bar = min(SIGMA3_BAR, 0.9 * well(disk).sigma3_bar) * unit
        if self.sigma4_bar is not None:
            return {"given": potential(disk, bar, self.eta_hat, sigma4_bar=self.sigma4_bar)}
        line = {"on": potential(disk, bar)}
        if self.eta_hat is not None:
            return line | ({"beside": potential(disk, bar, self.eta_hat)} if self.eta_hat else {})
        # For bodies whose wells have a small sigma3_bar, that much nearer to the line.
        size = BESIDE / SIGMA3_BAR * min(abs(bar), SIGMA3_BAR * unit) or BESIDE * unit
        return line | {"plus": potential(disk, bar, size), "minus": potential(disk, bar, -size)}

    def describe(self) -> dict[str, Any]:
        """The places, their levels, equilibria and separatrices, and thresholds of the disk, ready for JSON."""
        rows: dict[str, list[dict[str, Any]]] = {
            name: [] for name in ("places", "levels", "equilibria", "separatrices")
        }
        for name, each in self.places.items():
            constants = {key: getattr(each, key) for key in ("sigma3_bar", "sigma4_bar", "eta_hat", "face")}
            flat = [face for face in (-1, 1) if math.isfinite(each.at_flat(face))]
            rows["places"].append({"name": name, **constants, "reaches_flat": flat})
            for energy in each.levels(self.energy).tolist():
                pieces = _pieces(each.components(energy))
                rows["levels"].append({"place": name, "energy": energy, "pieces": pieces})
            for at in each.equilibria:
                own = {key: getattr(at, key) for key in ("phi", "theta", "energy", "curvature", "kind")}
                rows["equilibria"].append({"place": name, **own})
            for saddle, branches in ((line.saddle, line.branches) for line in each.separatrices()):
                own = {"phi": saddle.phi, "energy": saddle.energy, "branches": _pieces(branches)}
                rows["separatrices"].append({"place": name, **own})
        return {**rows, "thresholds": thresholds(self.disk)}


def _pieces(pieces: Sequence[Component]) -> list[dict[str, Any]]:
    return [{"low": each.low, "high": each.high, "ends": [*each.ends], "falls": each.falls} for each in pieces]
