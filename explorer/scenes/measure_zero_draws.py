"""What a chunk of scene measure-zero is: plain draws from the density, or a batch of draws in a tube beside F.

Both compute a table with the same columns, and count it with what only they know.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from explorer import compiled
from explorer.measure import statistics
from explorer.measure.box_integrals import NaturalDensity
from explorer.measure.density import Density
from explorer.measure.falling_constant import FallingConstant, constant_of
from explorer.measure.laws import SHAPE_BINS
from explorer.measure.sampling import chunk_stream
from explorer.measure.tubes import Draws, dimensions, draw_tube, widest_eta
from explorer.motion.plan import Plan, plan
from explorer.motion.turning_points import smallest_tilt, turning_points
from explorer.phase.constants import NaturalConstants, natural_constants
from explorer.phase.disk import Disk
from explorer.phase.states import COORDINATES, Array, States, phi_to_states
from explorer.scenes.base import Table, Tally

# The next term of the law is of order delta: 1e-4 of C here, and rungs above only measure it.
LAW_LIMIT = 1e-4
_NEAREST_FLAT = 0.01  # share of the box's distance from flat up to which the law may be tested
_NARROWEST = 1e-3  # half-width of a tube over the narrowest width of the density, likewise
ENERGY_BINS = 6
_SKIPPED = "not followed"  # the status of draws that are counted only
_WAYS = "right", "wrong", "not_resolved"
_CHECKED = 256  # hits per chunk whose race is followed by integration,
CHECKED_BY = "dopri5"  # by this method
# The draws near F that say where the bins of energy end: how many, their stream, and their tilt (rad).
_EDGE_DRAWS, _EDGE_STREAM, _EDGE_TILT = 4096, 1 << 40, 1e-8


def checking() -> Plan:
    """How the races of some hits are followed, to see which way they go."""
    return plan(("race_angle",), 1e-4, CHECKED_BY)


@dataclass(frozen=True)
class Question:
    """What is asked of which disk: P(theta_min < delta) for states drawn from a density, rung by rung.

    deltas: the rungs (rad), largest first. plan: how theta_min is computed. samples: plain draws. scrambled:
    whether the draws of a tube are Sobol points, each batch a scramble of its own.
    """

    disk: Disk
    source: Density
    deltas: Array
    plan: Plan
    samples: int
    seed: int
    scrambled: bool

    @cached_property
    def law_limit(self) -> float:
        """The largest delta at which the next term of the law may be neglected."""
        natural = NaturalDensity(self.disk, self.source)
        away = 0.5 * np.pi - max(map(abs, self.source.box.phi))
        near_flat = _NEAREST_FLAT * away if away > 0.0 else LAW_LIMIT
        # The half-width of a thin tube is proportional to its delta.
        thin = 1e-9
        width = float(widest_eta(np.array([natural.most_energy()]), thin, self.disk)[0]) / thin
        return float(min(LAW_LIMIT, near_flat, _NARROWEST * natural.narrowest() / width))

    @cached_property
    def tested(self) -> NDArray[np.bool_]:
        """The rungs at which the law is tested."""
        return self.deltas <= self.law_limit

    @cached_property
    def constant(self) -> FallingConstant:
        """C by quadrature. Raises InputError where the density is zero in all of the box."""
        return constant_of(self.disk, self.source)

    @cached_property
    def mass(self) -> float:
        """Integral of the density, natural units: all that draws need of C. Raises InputError where it is zero."""
        natural = NaturalDensity(self.disk, self.source)
        return natural.product() or self.constant.mass

    @cached_property
    def energy_edges(self) -> Array:
        """Inner edges of the bins of energy: quantiles of a few states near F; empty where there are none.

        They are the same for all seeds, so that runs can be merged.
        """
        random = chunk_stream(0, _EDGE_STREAM)
        energies = []
        for face in (1, -1):
            draws = self.draw(face, _EDGE_TILT, random.random((_EDGE_DRAWS, dimensions(self.source))))
            energies.append(draws.energy[draws.weight > 0.0])
        together = np.concatenate(energies)
        inner = np.arange(1, ENERGY_BINS) / ENERGY_BINS
        return np.quantile(together, inner) if together.size > 10 * ENERGY_BINS else np.zeros(0)

    def draw(self, face: int, delta: float, points: Array) -> Draws:
        """Draws in the tube of tilt delta beside the line of one face, from points of the unit cube."""
        return draw_tube(self.disk, self.source, self.mass, face, float(delta), points, self.plan.accuracy)


@dataclass(frozen=True)
class PlainDraws:
    """Draws from the density. Those that cannot come flatter than the first rung are counted, not followed."""

    question: Question
    index: int  # of the chunk, and of its random stream
    count: int

    def compute(self) -> Table:
        """The draws that are followed; theta_min is 0 for those that fall."""
        disk = self.question.disk
        columns, states, known = self.followed()
        plus = known.nearer_plus
        theta, status, _ = smallest_tilt(states, self.question.plan, known)
        return {
            **columns,
            "sigma3_bar": known.sigma3_bar * disk.rate_unit,
            "eta_hat": disk.eta_to_eta_hat(known.eta(plus)) * disk.rate_unit,
            "energy": known.energy * disk.energy_unit,
            "face": np.where(plus, 1, -1).astype(np.int8),
            "delta": np.full(plus.size, np.nan),
            "weight": np.ones(plus.size),
            "theta_min": np.where(status == compiled.status.Status.FALLS, 0.0, theta),
            "status": status.astype(np.int8),
        }

    def followed(self) -> tuple[Table, States, NaturalConstants]:
        """The draws that are followed: their coordinates, states and constants."""
        disk = self.question.disk
        columns = self.question.source.draw(disk, chunk_stream(self.question.seed, self.index), self.count)
        states = phi_to_states(disk, **columns)
        natural = natural_constants(states)
        eta_hat = disk.eta_to_eta_hat(natural.eta(natural.nearer_plus))
        rows = np.flatnonzero(abs(eta_hat) <= widest_eta(natural.energy, self.question.deltas[0], disk))
        return {name: values[rows] for name, values in columns.items()}, states.at(rows), natural.at(rows)

    def near(self, table: Table) -> NDArray[np.bool_]:
        """Rows flatter than the first rung."""
        near: NDArray[np.bool_] = table["theta_min"] < self.question.deltas[0]
        return near

    def tally(self, table: Table) -> Tally:
        """Hits of every rung by face and by sign of eta (0 counts as +), and the way their races go."""
        theta, plus, above = table["theta_min"], table["face"] == 1, table["eta_hat"] >= 0.0
        kinds = [face & sign for face in (plus, ~plus) for sign in (above, ~above)]
        skipped = {_SKIPPED: self.count - theta.size}
        return {
            "kind": "plain",
            "draws": self.count,
            "hits": [
                [int(np.count_nonzero(theta[kind] < delta)) for kind in kinds] for delta in self.question.deltas
            ],
            "status": statistics.add_counts([statistics.count_status([table["status"]]), skipped]),
            "race": self._race(table),
        }

    def _race(self, table: Table) -> dict[str, int]:
        """Which way the contact point races at the flattest moment, by integration, against the sign of eta."""
        rows = np.flatnonzero(self.near(table) & (table["theta_min"] > 0.0))[:_CHECKED]
        theta, face, eta_hat = (table[name][rows] for name in ("theta_min", "face", "eta_hat"))
        states = phi_to_states(self.question.disk, **{name: table[name][rows] for name in COORDINATES})
        natural, how = natural_constants(states), checking()
        counts = dict.fromkeys(_WAYS, 0)
        for each in (states, states.reversed()):
            turn = turning_points(each, how, natural)
            here = (turn.face == face) & (abs(turn.theta / theta - 1.0) < 0.5)
            agrees = np.sign(turn.way) == np.sign(eta_hat)
            counts["right"] += int((here & agrees).sum())
            counts["wrong"] += int((here & ~agrees).sum())
            counts["not_resolved"] += int((turn.status != compiled.status.Status.OK).sum())
        return counts


@dataclass(frozen=True)
class TubeDraws:
    """A batch of weighted draws in the tube of one rung at one face."""

    question: Question
    index: int  # of the chunk, and of its random stream
    count: int
    rung: int
    face: int
    part: int

    @property
    def delta(self) -> float:
        return float(self.question.deltas[self.rung])

    def compute(self) -> Table:
        """All draws. sigma3 and sigma4 are NaN: doubles do not hold such a small eta_hat as a difference."""
        random, size = chunk_stream(self.question.seed, self.index), dimensions(self.question.source)
        if self.question.scrambled:
            points = scipy.stats.qmc.Sobol(size, scramble=True, bits=53, rng=random).random(self.count)
        else:
            points = random.random((self.count, size))
        draws = self.question.draw(self.face, self.delta, points)
        return {
            "phi": draws.phi,
            "phidot": draws.phidot,
            "sigma3": np.full(self.count, np.nan),
            "sigma4": np.full(self.count, np.nan),
            "sigma3_bar": draws.sigma3_bar,
            "eta_hat": draws.eta_hat,
            "energy": draws.energy,
            "face": np.full(self.count, self.face, np.int8),
            "delta": np.full(self.count, self.delta),
            "weight": draws.weight,
            "theta_min": draws.theta_min,
            "status": draws.status,
        }

    def near(self, table: Table) -> NDArray[np.bool_]:
        """All rows of the first batch, which show what the draws and weights of every tube look like."""
        return np.full(table["status"].size, self.part == 0)

    def tally(self, table: Table) -> Tally:
        """Sums of weights and of their squares over the hits: all, by sign of eta, by energy, by tilt."""
        weight, theta, edges = table["weight"], table["theta_min"], self.question.energy_edges
        hit = weight * (theta < self.delta)
        bins = {
            "energy": (np.searchsorted(edges, table["energy"]), edges.size + 1),
            "tilt": ((np.nan_to_num(theta) / self.delta * SHAPE_BINS).astype(np.int64), SHAPE_BINS),
        }
        tally: Tally = {
            "kind": "tube",
            "rung": self.rung,
            "face": self.face,
            "draws": self.count,
            "sum": float(hit.sum()),
            "squares": float((hit * hit).sum()),
            "sum_eta_positive": float(hit[table["eta_hat"] > 0.0].sum()),
            "hits": int(np.count_nonzero(hit)),
            "unresolved": float(weight[table["status"] != compiled.status.Status.OK].sum()),
            "status": statistics.count_status([table["status"]]),
        }
        rows = hit > 0.0
        for name, (where, size) in bins.items():
            place = np.minimum(where[rows], size - 1)
            tally[name] = np.bincount(place, hit[rows], size).tolist()
            tally[f"{name}_squares"] = np.bincount(place, hit[rows] ** 2, size).tolist()
        return tally
