"""What scene falling-set counts of states that it does not keep."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from explorer.measure import statistics
from explorer.measure.log_counts import LogCounts, pack, unpack
from explorer.phase.states import Array
from explorer.scenes.base import Table, Tally

# Cells of the map of all samples over the plane of constants of motion.
MAP_CELLS = 160
NO_CODE = 65535


def nearer(table: Table) -> Array:
    """|eta_hat| to the line of the nearer face."""
    nearer: Array = np.fmin(abs(table["eta_hat_plus"]), abs(table["eta_hat_minus"]))
    return nearer


def count_faces(on_plus: NDArray[np.bool_], eta: Array) -> dict[str, int]:
    """States by nearer face and sign of eta; NaN is in none."""
    above, zero = eta > 0.0, eta == 0.0
    below = eta < 0.0
    counts = {}
    for name, chosen in (("plus", on_plus), ("minus", ~on_plus)):
        counts[f"face_{name}_eta_positive"] = int(np.count_nonzero(chosen & above))
        counts[f"face_{name}_eta_negative"] = int(np.count_nonzero(chosen & below))
        counts[f"face_{name}_eta_zero"] = int(np.count_nonzero(chosen & zero)) if zero.any() else 0
    return counts


def no_cells() -> NDArray[np.uint16]:
    """A map with nothing in it."""
    return np.full(MAP_CELLS * MAP_CELLS, NO_CODE, np.uint16)


@dataclass
class FallingCounts:
    """Counts of many states: what a chunk's tally holds."""

    faces: dict[str, int] = field(default_factory=dict)
    status: dict[str, int] = field(default_factory=dict)
    could_fall: int = 0
    theta_min: LogCounts = field(default_factory=LogCounts)
    distance: LogCounts = field(default_factory=LogCounts)
    plane: NDArray[np.uint16] = field(default_factory=no_cells)

    @classmethod
    def of(cls, tally: Tally) -> "FallingCounts":
        return cls(
            tally["faces"],
            tally["status"],
            tally["could_fall"],
            LogCounts(tally["theta_min"]),
            LogCounts(tally["distance"]),
            unpack(tally["plane"]),
        )

    def add(self, other: "FallingCounts") -> None:
        self.faces = statistics.add_counts([self.faces, other.faces])
        self.status = statistics.add_counts([self.status, other.status])
        self.could_fall += other.could_fall
        self.theta_min.add(other.theta_min)
        self.distance.add(other.distance)
        self.plane = np.minimum(self.plane, other.plane)

    def tally(self) -> Tally:
        """Ready for JSON."""
        return {
            "faces": self.faces,
            "status": self.status,
            "could_fall": self.could_fall,
            "theta_min": self.theta_min.state(),
            "distance": self.distance.state(),
            "plane": pack(self.plane),
        }
