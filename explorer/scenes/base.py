"""What every scene offers, and how samples are cut into chunks.

To add a scene: one file with one frozen dataclass that implements Scene and declares its options as Keywords, and
one line in `registry.SCENES`; for a scene of a user, `registry.register` instead of that line. A scene draws or
receives initial states, asks `motion.plan` for observables, and reduces what comes back.
It knows nothing of files, workers or where pictures are kept.
"""

import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self, TypeAlias, TypedDict, TypeVar

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, RunError, shown, suggest
from explorer.measure import statistics
from explorer.motion.plan import Plan, plan
from explorer.motion.trials import MotionTrial, Trial
from explorer.phase.disk import Disk
from explorer.scenes.options import (
    ACCURACY,
    CHUNK_SIZE,
    DISK,
    KEEP,
    METHOD,
    SAMPLES,
    SEED,
    Disks,
    Option,
    as_json,
    options_of,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# A picture that is drawn when it is called, with ax= and keywords of its function where it takes them; or one that
# is there.
Picture: TypeAlias = "Figure | Callable[..., Axes | Figure]"
S = TypeVar("S", bound="Scene")
Table = dict[str, NDArray[Any]]
Tally = dict[str, Any]

DEFAULT_CHUNK = 1 << 16  # samples; a kernel call on it stays well under a second
# Memory (bytes) of compiled code and libraries, measured.
BASE_MEMORY = 450e6
# A budget is shared by at least so many jobs, so that the numbers do not depend on how many there are.
SHARERS = 4
MOST_CHUNKS = 20_000_000  # files in one folder
SMALLEST_CHUNK, LARGEST_CHUNK = 1 << 12, 1 << 20
_SMALLEST_PART = 1 << 11  # samples, below which what every call costs would tell


class NoStateError(InputError, RunError):
    """No sample of a run is a state, so nothing that it computed is of use."""


@dataclass(frozen=True)
class Chunks:
    """The chunks of a scene that are computed, in their order; each of the two can be gone through once.

    tallies: counts of all samples, as JSON gives them back. tables: the rows that were kept.
    """

    tallies: Iterator[Tally]
    tables: Iterator[Table]


@dataclass(frozen=True, kw_only=True)
class Scene(ABC):
    """A question about many initial states. Frozen, so that its options identify a run."""

    disks: tuple[Disk, ...] = (Disk.uniform(),)
    seed: int = 0
    accuracy: float = 1e-6
    method: str = "auto"

    name: ClassVar[str]
    observables: ClassVar[tuple[str, ...]] = ()
    # What it stores of a sample, by the names of `phase.columns`; chunks may have other columns besides.
    columns: ClassVar[tuple[str, ...]] = ("status",)
    # How many samples `trade` draws unless it is said.
    tried: ClassVar[int] = 4096
    # What else it stores where the states are given, and not drawn as it does by itself.
    columns_of_given: ClassVar[tuple[str, ...]] = ()

    class Keywords(TypedDict, total=False):
        """What users may give, by name: its type, and how it is read."""

        disk: Annotated[Disks, DISK]
        seed: Annotated[int, SEED]
        accuracy: Annotated[float, ACCURACY]
        method: Annotated[str, METHOD]

    OPTIONS: ClassVar[tuple[Option, ...]] = options_of(Keywords)

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if "Keywords" in vars(cls):
            cls.OPTIONS = options_of(cls.Keywords)

    def __post_init__(self) -> None:
        """Raise InputError where options do not go together; scenes add what they must refuse."""
        _ = self.plan  # a method that cannot give the observables is refused before anything is written

    @classmethod
    def of(cls, options: Mapping[str, Any]) -> Self:
        """The scene that a user describes by options, each by its word or its field's name.

        An option that is None keeps its default. Raises InputError for an option that the scene does not take, or
        a value that it cannot use.
        """
        cls.require_options(options)
        known = cls._by_name()
        given: dict[str, Any] = {}
        for key, value in options.items():
            if value is not None:
                given[known[key].name] = known[key].read(known[key].flag, value)
        return cls(**cls.completed(given))

    @classmethod
    def require_options(cls, names: Iterable[str], offered: Iterable[Option] | None = None) -> None:
        """Raise InputError for a name of no option, with what is offered: by default all options of the scene."""
        for name in names:
            if name not in cls._by_name():
                plain = re.fullmatch("[a-z][a-z0-9_]*", name)
                flag = f"--{name.replace('_', '-')}" if plain else shown(name)
                flags = [option.flag for option in offered or cls.OPTIONS]
                raise InputError(f"{flag}: {cls.name} takes no such option; {suggest(flag, flags)}")

    @classmethod
    def _by_name(cls) -> dict[str, Option]:
        return {name: option for option in cls.OPTIONS for name in (option.word, option.name)}

    @classmethod
    def completed(cls, given: dict[str, Any]) -> dict[str, Any]:
        """What was given, and those defaults that depend on it."""
        return given

    def options(self) -> dict[str, Any]:
        """Everything that decides the numbers, ready for JSON; `of` takes it back, without the scene's name."""
        return {"scene": self.name, **{o.name: as_json(getattr(self, o.name)) for o in self.OPTIONS}}

    @abstractmethod
    def chunks(self) -> int:
        """Number of independent pieces of work."""

    @abstractmethod
    def length(self, index: int) -> int:
        """How many samples chunk `index` stands for."""

    @abstractmethod
    def compute(self, index: int) -> Table:
        """The samples of chunk `index`: columns of equal length."""

    def tally(self, index: int, table: Table) -> Tally:
        """Counts of all samples of chunk `index`, ready for JSON; kept whichever rows are."""
        return {"status": statistics.count_status([table["status"]])}

    def kept(self, index: int, table: Table) -> Table:
        """The rows of chunk `index` that are stored."""
        return table

    def process(self, index: int) -> tuple[Table, Tally]:
        """The rows of chunk `index` that are stored, and the counts of all its samples."""
        table = self.compute(index)
        return self.kept(index, table), self.tally(index, table)

    def begin(self, index: int, parts: int) -> tuple[Table, Tally, int]:
        """As `process`, of one of so many parts of the chunk where it can be parted; and how many samples that is.

        Tells what the chunk costs. What is drawn may differ from what the chunk draws.
        """
        return *self.process(index), self.length(index)

    def add_up(self, chunks: Chunks) -> Any:
        """All chunks together: what `summarise` and `figures` need, in one pass; by default all tallies."""
        return list(chunks.tallies)

    def together(self, others: Sequence["Scene"]) -> "Scene":
        """The scene of which runs of this one and of others with other seeds are parts. Raises InputError."""
        if others:
            raise InputError(
                f"{self.name}: draws no samples, so another run of it says the same; nothing to merge"
            )
        return self

    def add_up_several(self, parts: Sequence[tuple["Scene", Chunks]]) -> Any:
        """As `add_up`, of the chunks of several runs."""
        tallies = chain.from_iterable(chunks.tallies for _, chunks in parts)
        tables = chain.from_iterable(chunks.tables for _, chunks in parts)
        return self.add_up(Chunks(tallies, tables))

    @abstractmethod
    def summarise(self, total: Any) -> dict[str, Any]:
        """The scene's numbers, from what `add_up` returns."""

    def figures(self, summary: dict[str, Any], total: Any) -> "Iterable[tuple[str, Picture]]":
        """Named pictures; each is drawn when it is called."""
        return ()

    @property
    def figure_count(self) -> int:
        """How many pictures `figures` has, for the estimate of what a run costs."""
        return 0

    def headline(self, summary: dict[str, Any]) -> list[str]:
        """The summary in a few lines of text."""
        return []

    def trial(self) -> Trial | None:
        """Its samples as `trade` tries methods on them; None where it computes nothing by a method of choice."""
        return None

    @property
    def trial_size(self) -> int | None:
        """How many samples `trial` has at most, told without drawing one; None where there is no saying."""
        return getattr(self, "samples", None) if type(self).trial is not Scene.trial else None

    def motions(self, count: int, t_end: float | None) -> MotionTrial | None:
        """Motions in time from its first `count` starts, likewise. t_end: units of the disk; None: its own."""
        return None

    @property
    def disk(self) -> Disk:
        """The disk of a scene that takes one."""
        return self.disks[0]

    @property
    def label(self) -> str:
        """Names the disks in a folder name."""
        return "+".join(disk.name for disk in self.disks)

    @property
    def kernels(self) -> tuple[str, ...]:
        """What its chunks and its numbers call of the compiled layer, by the names of `compiled.warmup`.

        A run compiles these before its first chunk, in two processes; others are compiled when they are called.
        """
        return ()

    @property
    def kernels_of_figures(self) -> tuple[str, ...]:
        """What its pictures call besides."""
        return ()

    @cached_property
    def plan(self) -> Plan:
        """How the observables are computed. Raises InputError where the method cannot give them."""
        return plan(self.observables, self.accuracy, self.method)

    @property
    def plans(self) -> tuple[Plan, ...]:
        """Every plan by which its numbers are computed; their steps are part of what a run is."""
        return (self.plan,)


@dataclass(frozen=True, kw_only=True)
class SampledScene(Scene):
    """A scene made of `samples` equal draws on one disk."""

    samples: int = 100_000
    chunk_size: int = DEFAULT_CHUNK
    keep: str = "near"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.chunks() > MOST_CHUNKS:
            raise InputError(
                f"--samples {self.samples} in chunks of {self.chunk_size}: makes {self.chunks():,} files; give a "
                f"larger chunk_size, so that there are {MOST_CHUNKS:,} at most"
            )

    # Memory of one sample while its chunk is computed (bytes), for a budget.
    bytes_per_sample: ClassVar[int] = 1000

    class Keywords(Scene.Keywords, total=False):
        samples: Annotated[int | float, SAMPLES]
        chunk_size: Annotated[int, CHUNK_SIZE]
        keep: Annotated[str, KEEP]

    def chunks(self) -> int:
        return -(-self.samples // self.chunk_size)

    def length(self, index: int) -> int:
        """How many samples chunk `index` stands for; only the last is shorter."""
        return min(self.chunk_size, self.samples - index * self.chunk_size)

    def begin(self, index: int, parts: int) -> tuple[Table, Tally, int]:
        size = part_of(self.chunk_size, parts)
        smaller, first = copy(self), index * (self.chunk_size // size)
        # Nothing that follows from the options depends on it, so it is not checked again.
        object.__setattr__(smaller, "chunk_size", size)
        return *smaller.process(first), smaller.length(first)

    def together(self, others: Sequence[Scene]) -> Scene:
        return together(self, others)

    def near(self, index: int, table: Table) -> NDArray[np.bool_]:
        """Rows of chunk `index` that lie near F."""
        return np.ones(table["status"].size, dtype=bool)

    def kept(self, index: int, table: Table) -> Table:
        if self.keep == "all":
            return table
        if self.keep == "none":
            return {name: values[:0].copy() for name, values in table.items()}
        rows = self.near(index, table)
        return table if rows.all() else {name: values[rows] for name, values in table.items()}


def part_of(length: int, parts: int) -> int:
    """The length of one of so many parts of a chunk, or of all of it where parts would be too small."""
    return length // min(parts, max(1, length // _SMALLEST_PART))


def joined(tables: Sequence[Table]) -> Table:
    """Tables with the same columns, one below the other."""
    return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}


def together(first: S, others: Sequence[Scene]) -> S:
    """A scene with the `samples` of all, which must differ in nothing but samples, seeds and chunks."""
    more: Any = {"samples": sum(getattr(scene, "samples", 0) for scene in (first, *others))}
    return replace(first, **more)


def chunk_size_for(kind: type[SampledScene], memory: Any, jobs: int) -> int:
    """The largest power of two of samples per chunk with which a few chunks at once fit into a budget.

    The same for all `jobs` up to SHARERS. Raises InputError, with what is needed, where not even small chunks fit.
    """
    budget, jobs = read_memory("--memory", memory), max(jobs, SHARERS)
    least = BASE_MEMORY + jobs * SMALLEST_CHUNK * kind.bytes_per_sample
    if budget < least:
        raise InputError(
            f"--memory {memory}: {kind.name} with up to {jobs} jobs needs at least {least / 1e6:.0f}MB; give more"
        )
    fits = int((budget - BASE_MEMORY) / (jobs * kind.bytes_per_sample))
    return min(1 << (fits.bit_length() - 1), LARGEST_CHUNK)


def read_memory(flag: str, value: Any) -> float:
    """Bytes from "1GB", "500MB" or a number. Raises InputError."""
    match = re.fullmatch(r"\s*([0-9.eE+]+)\s*([KMGT]?)(?:i?B)?\s*", str(value), re.IGNORECASE)
    try:
        size = float(match[1]) * 1000.0 ** " KMGT".index(match[2].upper() or " ") if match else float(value)
        if not 0.0 < size < 1e18:
            raise ValueError(value)
        return size
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{flag} {shown(value)} is no amount; write 1GB or 500MB") from None
