"""A scene: a question about many initial states, in one file.

It declares its options as fields (`options.option`) and what it counts (`measure.tallies`), and offers `draw`,
`observe`, `count` and `summarise`; where it makes sense `near`, `headline` and `figures`. How samples are cut into
chunks and blocks, which rows are kept, files and workers are not its concern.
"""

import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, RunError, shown
from explorer.measure import statistics
from explorer.measure.sampling import LaneStream, Stream
from explorer.measure.tallies import ByName, Tally
from explorer.motion.plan import METHODS, Plan, plan
from explorer.motion.trials import MotionTrial, Trial
from explorer.phase.columns import Column
from explorer.phase.disk import SYNTAX, Disk
from explorer.scenes.options import DISK, NUMBER, Options, option, whole_from, word_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# A picture that is drawn when it is called, with ax= and keywords of its function where it takes them.
Picture: TypeAlias = "Callable[..., Axes | Figure]"
Table = dict[str, NDArray[Any]]
SAMPLES = whole_from(1, 10**12), "number of samples; 1e6 is a whole number too"
MOST_CHUNKS = 20_000_000  # files in one folder
_FREE = ("seed", "samples", "chunk_size", "keep")  # in which runs of one question may differ


class Counts(Tally):
    """What every scene counts: in which status its samples ended, also those whose rows are not kept."""

    status: ByName[int]


class Scene(Options, ABC):
    """What every scene is told."""

    disk: Disk = option(DISK, f"disk: {SYNTAX}", default=Disk.uniform(), key="disks")
    seed: int = option(whole_from(0, 2**128 - 1, "S"), "seed of the random streams", default=0)
    accuracy: float = option(
        NUMBER._replace(metavar="TOL"),
        "largest error: absolute of angles (rad), relative of times and tilts",
        default=1e-6,
    )
    method: str = option(word_of(*METHODS), ", ".join(METHODS), default="auto")

    name: ClassVar[str]  # race-angles of class RaceAngles
    tally: ClassVar[type[Counts]] = Counts
    observables: ClassVar[tuple[str, ...]] = ()
    # What it stores of a sample, by the names of `phase.columns`, or with what they mean; chunks may have others.
    columns: ClassVar[Sequence[str] | dict[str, Column]] = ("status",)
    columns_of_given: ClassVar[tuple[str, ...]] = ()  # what else it stores where the states are given
    drawn: ClassVar[int] = 0  # about how many pictures `figures` has, for what a run costs
    tried: ClassVar[int] = 4096  # samples that `trade` draws, unless it is said

    def __init_subclass__(cls, **how: Any) -> None:
        super().__init_subclass__(**how)
        if "name" not in vars(cls):
            cls.name = re.sub(r"(?<=.)(?=[A-Z])", "-", cls.__name__).lower()

    def __post_init__(self) -> None:
        """Raise InputError where options do not go together; scenes add what they must refuse."""
        super().__post_init__()
        _ = self.plan  # a method that cannot give the observables is refused before anything is written
        if not self.observables and self.method != "auto":
            raise InputError(f"--method {self.method}: {self.name} names no observables, so it has no methods")

    @property
    def options(self) -> dict[str, Any]:
        """Everything that decides the numbers, ready for JSON."""
        return {"scene": self.name, **self.as_json()}

    @property
    @abstractmethod
    def chunks(self) -> int:
        """Number of independent pieces of work."""

    @abstractmethod
    def length(self, index: int) -> int:
        """How many samples chunk `index` stands for."""

    @abstractmethod
    def chunk(self, index: int) -> tuple[Table, Any]:
        """The rows of chunk `index` that are stored, and the counts of all its samples."""

    def summarise(self, tally: Any) -> dict[str, Any]:
        """The numbers of a run, from what was counted of all samples."""
        return {"samples": sum(tally.status.values()), "status": dict(tally.status)}

    def figures(self, summary: dict[str, Any], tally: Any) -> Iterable[tuple[str, Picture]]:
        """Named pictures; each is drawn when it is called."""
        return ()

    def headline(self, summary: dict[str, Any]) -> list[str]:
        """The summary in a few lines of text."""
        plain = [f"{name}: {value}" for name, value in summary.items() if isinstance(value, int | float | str)]
        return [*plain, *(f"{count:,} {name}" for name, count in summary.get("status", {}).items())]

    def trial(self) -> Trial | None:
        """Its samples as `trade` tries methods on them; None where it computes nothing by a method of choice."""
        return None

    def motions(self, count: int, t_end: float | None) -> MotionTrial | None:
        """Motions in time from its first `count` starts, likewise. t_end: units of the disk; None: its own."""
        return None

    def together(self, others: "Sequence[Scene]") -> Self:
        """The scene of which runs of this one and of others with other seeds are parts. Raises InputError."""
        mine = self.options
        if "samples" not in mine:
            raise InputError(f"merge: {self.name} draws no samples, so another run of it says the same")
        for other in others:
            theirs = other.options
            for key in {**mine, **theirs}:
                if key not in _FREE and mine.get(key) != theirs.get(key):
                    one, two = shown(mine.get(key)), shown(theirs.get(key))
                    raise InputError(
                        f"merge: one run has {key} = {one}, another {two}; only runs of the same question can be "
                        "added up"
                    )
        runs: list[Scene] = [self, *others]
        seeds = [scene.seed for scene in runs]
        for seed in seeds:
            if seeds.count(seed) > 1:
                raise InputError(
                    f"merge: two runs have seed {seed}, so one repeats samples of the other; give runs with "
                    "different seeds, or resume one of them with more samples"
                )
        if mine.get("states") is not None:
            raise InputError("merge: these runs have given states; give one run with the states of all of them")
        more: Any = {"samples": sum(scene.options["samples"] for scene in runs)}
        return replace(self, **more)

    @property
    def label(self) -> str:
        """Names the disk in the name of a folder."""
        return self.disk.name

    @property
    def kernels(self) -> tuple[str, ...]:
        """What it calls of the compiled layer, by the names of `compiled.warmup`: a run compiles these first."""
        return ()

    @cached_property
    def plan(self) -> Plan:
        """How the observables are computed. Raises InputError where the method cannot give them."""
        return plan(self.observables, self.accuracy, self.method)

    @property
    def plans(self) -> tuple[Plan, ...]:
        """Every plan by which its numbers are computed; their steps are part of what a run is."""
        return (self.plan,)


class SampledScene(Scene):
    """How many samples, and which of them are stored."""

    samples: int = option(*SAMPLES, default=100_000)
    keep: str = option(
        word_of("none", "near", "all"),
        "samples to store: those near the falling set (near), all or none; counts are always of all",
        default="near",
    )
    # A kernel call on a chunk stays well under a second.
    chunk_size: int = option(whole_from(1, 10**8), "samples per chunk", default=1 << 16)

    block: ClassVar[int] = 1 << 15  # samples at once: columns of them stay in a processor's cache
    bytes_per_sample: ClassVar[int] = 1000  # while its chunk is computed, for a budget of memory

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.chunks > MOST_CHUNKS:
            raise InputError(
                f"--samples {self.samples} in chunks of {self.chunk_size}: makes {self.chunks:,} files; give a "
                f"larger chunk_size, so that there are {MOST_CHUNKS:,} at most"
            )

    # What a scene offers

    def draw(self, random: Stream, count: int) -> Table:
        """So many samples, or what makes them: columns, from the random stream of a chunk."""
        raise NotImplementedError

    def observe(self, drawn: Any) -> Table:
        """All columns of a block of samples that are stored or counted; one is `status`."""
        raise NotImplementedError

    def count(self, tally: Any, table: Table) -> None:
        """Add the samples of a block to a tally, whose `status` is counted already."""

    def near(self, table: Table) -> NDArray[np.bool_]:
        """The rows that keep="near" stores."""
        return np.ones(table["status"].size, bool)

    @property
    def rows(self) -> int:
        """How many rows a sample has, which share its status."""
        return 1

    # What is made of it

    @property
    def chunks(self) -> int:
        return -(-self.samples // self.chunk_size)

    def length(self, index: int) -> int:
        """How many samples chunk `index` stands for; only the last is shorter."""
        return min(self.chunk_size, self.samples - index * self.chunk_size)

    def blocks(self, index: int) -> Iterator[Any]:
        """What `observe` takes, block by block."""
        drawn = self.draw(LaneStream(self.seed, index), self.length(index))
        for first in range(0, self.length(index), self.block):
            yield {name: values[first : first + self.block] for name, values in drawn.items()}

    def chunk(self, index: int) -> tuple[Table, Any]:
        tally, kept = self.tally(), []
        for block in self.blocks(index):
            table = self.observe(block)
            if "status" not in table:
                raise RunError(f"{self.name}: `observe` gives no column `status`; give one code for each sample")
            table["status"] = table["status"].astype(np.int8, copy=False)
            tally.status += statistics.count_status([table["status"][:: self.rows]])
            self.count(tally, table)
            kept.append(self.kept(table))
        return joined(kept), tally

    def kept(self, table: Table) -> Table:
        """The rows of a block that are stored."""
        if self.keep == "all":
            return table
        if self.keep == "none":
            return {name: values[:0].copy() for name, values in table.items()}
        rows = self.near(table)
        return table if rows.all() else {name: values[rows] for name, values in table.items()}


def joined(tables: Sequence[Table]) -> Table:
    """Tables with the same columns, one below the other."""
    return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}
