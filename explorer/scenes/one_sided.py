"""Scene one-sided: how motions near F approach the two limit motions, and how these differ.

From points of F drawn at the vertical, motions start at eta_hat = +-10^-k beside them and run
through several falls. Away from the impacts their distance to the limit motion of their side
shrinks like eta ln(1/eta); the two limits themselves stay 2 kappa pi mod 2 pi apart per fall.
"""

import math
from collections.abc import Iterator
from functools import cached_property, partial
from typing import Any

import numpy as np

from explorer.errors import InputError
from explorer.measure.distributions import Distribution
from explorer.measure.races import SIDES
from explorer.measure.sampling import Range, numbered_stream
from explorer.measure.tallies import ByName
from explorer.motion import limit_motions
from explorer.motion.both_sides import QUANTITIES, both_sides, limits_from, sample_times
from explorer.motion.plan import TIGHTEST
from explorer.motion.trajectories import trajectories_by
from explorer.phase.coordinates import coordinates_to_states
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.results import Columns, count_status, stacked
from explorer.phase.states import Array
from explorer.scenes.options import BOX, DISK, NUMBER, RANGE, option, plain
from explorer.scenes.scene import SAMPLES, Counts, Picture, Scene
from explorer.scenes.starts import BOX_NEAR_F, ETA_HAT, box_near_f, eta_hat_span, starts_near_f

BLOCK = 8  # starts per chunk
# A distance from the limit is some eta ln(1/eta), and a motion errs by up to fifty times its accuracy where its
# path is long. So the accuracy is this share of the smallest eta_hat.
_SHARE = 1e-3
# The limits coincide where the measured gap is below this (rad); it is 1.48 and more elsewhere.
SAME = 1e-3


class Approach(Counts):
    """Of each disk and start, null where a motion failed.

    distances: from the limit of its side, [of eta_hat > 0, of eta_hat < 0], the largest |eta_hat| first. apart: by
    how much chi between the first two impacts is larger at the smallest eta_hat > 0 than at -eta_hat.
    """

    distances: ByName[list[Any]]
    apart: ByName[list[Any]]


class OneSided(Scene):
    """What is the limit from each side of F? Distances of motions from the limit motion as eta_hat shrinks."""

    disk: tuple[Disk, ...] = option(  # type: ignore[assignment]  # several
        DISK,
        "disk, as for other scenes; several may be given",
        default=(Disk.uniform(), Disk.hoop(), Disk.matching()),
        key="disks",
        several=True,
    )
    samples: int = option(SAMPLES[0], "points of the falling set per disk", default=32)
    box: Distribution | None = option(
        BOX, BOX_NEAR_F, follows=lambda self, given: given and box_near_f(self.disk[0], given)
    )
    eta_hat: Range | None = option(RANGE, ETA_HAT, words="1e-6:1e-1 natural units, one distance for each decade")
    accuracy: float = option(
        NUMBER._replace(metavar="TOL"),
        "largest error accepted: of angles in rad, of paths in disk radii",
        words=f"{_SHARE:g} of the smallest |eta_hat| in natural units",
        follows=lambda self, given: self.fine_enough if given is None else given,
    )

    tally = Approach
    observables = QUANTITIES
    columns = (
        *("base", "sigma3_bar", "phidot", "eta_hat", "status"),
        *(f"distance_{name}" for name in QUANTITIES),
        *("distance", "chi_between"),
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        for disk in self.disk:
            require_axial_inertia(disk)
            self.span(disk)
        if len({disk.name for disk in self.disk}) < len(self.disk):
            raise InputError("disk: one-sided needs different names; name disks in TOML files")

    def span(self, disk: Disk) -> Range:
        """|eta_hat| in the units of the disk; 1e-6 to 1e-1 natural units unless given."""
        return eta_hat_span(disk, self.eta_hat, (1e-6, 1e-1))

    @property
    def fine_enough(self) -> float:
        """The accuracy that tells the smallest distance, as far as the method can."""
        smallest = min(self.span(disk)[0] / disk.rate_unit for disk in self.disk)
        return max(_SHARE * smallest, TIGHTEST.get(self.method, TIGHTEST["dop853"]))

    def ladder(self, disk: Disk) -> Array:
        """Magnitudes of eta_hat, one per decade, from the largest down."""
        low, high = self.span(disk)
        return np.geomspace(high, low, max(1, round(math.log10(high / low)) + 1))

    @cached_property
    def parts(self) -> list[tuple[Disk, int, int]]:
        """Of each chunk the disk, the number of its first start, and how many it has."""
        firsts = range(0, self.samples, BLOCK)
        return [(disk, first, min(BLOCK, self.samples - first)) for disk in self.disk for first in firsts]

    @property
    def chunks(self) -> int:
        return len(self.disk) * -(-self.samples // BLOCK)  # a list of too many could not be held

    def length(self, index: int) -> int:
        disk, _, count = self.parts[index]
        return 2 * count * self.ladder(disk).size

    def starts(self, index: int) -> list[dict[str, float]]:
        """Points of F of chunk `index`, each by its phidot, sigma3_bar and face at the vertical."""
        disk, _, count = self.parts[index]
        box = self.box or box_near_f(disk, None)
        drawn = starts_near_f(box, numbered_stream(self.seed, index), count)
        return [{name: float(values[i]) for name, values in drawn.items()} for i in range(count)]

    @property
    def kernels(self) -> tuple[str, ...]:
        return *limit_motions.KERNELS, self.plan.in_time.kernel

    def chunk(self, index: int) -> tuple[Columns, Approach]:
        (disk, first, _), tally = self.parts[index], Approach()
        tables = [self._approach(disk, first + i, start) for i, start in enumerate(self.starts(index))]
        for table in tables:
            distance, chi = (table[name].reshape(2, -1) for name in ("distance", "chi_between"))
            tally.distances[disk.name] += [plain(distance)]
            tally.apart[disk.name] += plain(chi[:1, -1] - chi[1:, -1])
        table = stacked(tables)
        tally.status += count_status(table["status"])
        return table, tally

    def _approach(self, disk: Disk, base: int, start: dict[str, float]) -> Columns:
        """All rungs of the ladder, both signs, beside one point of F."""
        eta_hat = np.concatenate([self.ladder(disk), -self.ladder(disk)])
        limits = limits_from(coordinates_to_states(disk, degrees=False, eta_hat=0.0, **start))
        times, middle = sample_times(limits[1])
        beside = coordinates_to_states(disk, degrees=False, eta_hat=eta_hat, **start)
        motion = trajectories_by(beside, self.plan, times, QUANTITIES)
        assert motion.chi is not None
        fixed = {"base": base, "sigma3_bar": start["sigma3_bar"], "phidot": start["phidot"]}
        columns: Columns = {name: np.full(eta_hat.size, value) for name, value in fixed.items()}
        columns |= {"eta_hat": eta_hat, "status": motion.status}
        both = [limits[side](times) for side in SIDES.values()]  # every rung of a side has the same
        for name in QUANTITIES:
            limit = np.array([getattr(each, name) for each in both]).reshape(2, 1, -1)
            away = abs(getattr(motion, name).reshape(2, eta_hat.size // 2, -1) - limit).max(axis=-1)
            columns[f"distance_{name}"] = away.ravel() / (disk.r if name in ("path", "contact") else 1.0)
        columns["distance"] = np.max([columns[f"distance_{name}"] for name in QUANTITIES], axis=0)
        # Between the first two impacts the two sides differ by one fall.
        columns["chi_between"] = motion.chi[:, middle]
        return columns

    def summarise(self, tally: Approach) -> dict[str, Any]:
        per_disk = {disk.name: self._limits(disk, tally) for disk in self.disk}
        return {"samples": self.samples, "disks": per_disk, "status": dict(tally.status)}

    def _limits(self, disk: Disk, tally: Approach) -> dict[str, Any]:
        """How the motions of a disk approach its limits, and how far these are apart."""
        distances, rows = np.array(tally.distances[disk.name], float), []
        for place, size in enumerate(self.ladder(disk).tolist()):
            rows.append({"eta_hat": size})
            for side, name in enumerate(SIDES):
                known = distances[:, side, place]
                known = known[np.isfinite(known)]
                rows[-1][f"motions_{name}"] = known.size
                if known.size:
                    rows[-1] |= {f"median_{name}": float(np.median(known)), f"largest_{name}": float(known.max())}
        # 2 kappa pi mod 2 pi from the motions nearest to F, brought next to the exact value
        apart = [each for each in tally.apart[disk.name] if each is not None]
        error = np.array([math.remainder(each - disk.gap, 2.0 * math.pi) for each in apart])
        largest = float(abs(error).max()) if error.size else None
        # Further from F than the limits are from each other, there is nothing to measure.
        measured = None if largest is None or largest >= 0.5 else float(disk.gap + np.median(error))
        near = rows[-1]["eta_hat"]
        return {
            "gap": {"exact": disk.gap, "measured": measured, "largest_error": largest, "at_eta_hat": near},
            "coincide": None if measured is None else abs(math.remainder(measured, 2.0 * math.pi)) < SAME,
            "kappa": disk.kappa,
            "distances": rows,
        }

    def figures(self, summary: dict[str, Any], tally: Approach) -> Iterator[tuple[str, Picture]]:
        from explorer.pictures import one_sided

        yield "distance", partial(one_sided.one_sided_distance, summary)
        for index, (disk, first, _) in enumerate(self.parts):
            if first:
                continue
            start = coordinates_to_states(disk, degrees=False, eta_hat=0.0, **self.starts(index)[0])
            both = both_sides(start)
            yield f"motion-{disk.name}", partial(one_sided.one_sided_motion, both)
            yield f"contact-{disk.name}", partial(one_sided.contact_paths, both)

    def headline(self, summary: dict[str, Any]) -> list[str]:
        verdict = {True: "they coincide", False: "they differ", None: "start nearer to the falling set"}
        lines = []
        for name, limits in summary["disks"].items():
            exact, found = limits["gap"]["exact"], limits["gap"]["measured"]
            measured = "not measured" if found is None else f"{found:+.6f}"
            text = f"{measured} rad (exact {exact:.6f}); {verdict[limits['coincide']]}"
            lines.append(f"{name}: angle between the directions in which the two limit motions rise: {text}")
        return lines
