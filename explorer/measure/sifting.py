"""States drawn evenly from a box, counted and sifted by one compiled pass: only those near F leave it."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from explorer import compiled
from explorer.measure.sampling import PER_STREAM, Box, Ranges, Stream
from explorer.measure.tallies import LOWEST_BIN, NO_ENDS, PER_DECADE, LogHistogram
from explorer.phase.disk import LARGEST_RATE, Disk
from explorer.phase.energy import eta_hat_to_eta
from explorer.phase.falling_set import obstacle
from explorer.phase.states import COORDINATES, Array

# All states by nearer face and sign of eta, in the order of the compiled pass.
FACES = tuple(f"face_{face}_eta_{sign}" for face in ("minus", "plus") for sign in ("negative", "zero", "positive"))
KERNELS = ("sifting.sift_batch",)  # of `sift`, for `compiled.warmup`


@dataclass(frozen=True)
class Sifted:
    """What became of the states.

    faces: counts by FACES; a state that is none is in no face. could_fall, distance: of those that could fall on
    the nearer face. columns: coordinates of those of them that are near, in their order.
    """

    faces: dict[str, int]
    could_fall: int
    distance: LogHistogram
    columns: dict[str, Array]


def in_lanes(disk: Disk, box: Ranges) -> bool:
    """Whether the pass takes this box: of phi, phidot, sigma3 and sigma4, of which none is bad input."""
    rates = (abs(end) for name, ends in box.ranges.items() if name != "phi" for end in ends)
    return isinstance(box, Box) and max(rates) < LARGEST_RATE * disk.rate_unit


def sift(disk: Disk, box: Ranges, streams: Iterable[Stream], sizes: tuple[int, int], near: float) -> Sifted:
    """Draw, judge and count states, which are those of `Box.draw` from these streams, PER_STREAM of each.

    sizes: how many states, and how many are drawn at once. near: |eta_hat|, units of the disk.
    """
    count, block = sizes
    low, high = np.array([box.ranges[name] for name in COORDINATES]).T.copy()
    keys = [compiled.philox.round_keys(each.bit_generator.state["state"]["key"]) for each in streams]
    draw = compiled.sifting.Draw(np.concatenate(keys), PER_STREAM, low, high - low, block, disk.rate_unit)
    eta_per_eta_hat = eta_hat_to_eta(disk.body, 1.0)
    sieve = compiled.sifting.Sieve(obstacle(disk), eta_per_eta_hat, near, float(PER_DECADE), -LOWEST_BIN)
    found = compiled.sifting.Found(
        faces=np.zeros(len(FACES), np.int64),
        bins=np.zeros(-2 * LOWEST_BIN, np.int32),
        ends=np.array([np.inf, -np.inf]),
        totals=np.zeros(3, np.int64),
        columns=np.empty((len(COORDINATES), count)),
    )
    compiled.sifting.sift_batch(draw, count, sieve, disk.natural, disk.whole, found)
    could, zeros, kept = found.totals.tolist()
    return Sifted(
        faces=dict(zip(FACES, found.faces.tolist(), strict=True)),
        could_fall=could,
        distance=LogHistogram(0, LOWEST_BIN, [0 * found.bins, found.bins], [0, zeros], [NO_ENDS, found.ends]),
        columns=dict(zip(COORDINATES, found.columns[:, :kept].copy(), strict=True)),
    )
