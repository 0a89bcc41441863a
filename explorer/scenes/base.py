"""What every scene offers, and how samples are cut into chunks.

To add a scene: one file with one frozen dataclass that implements Scene, one line in
`registry.SCENES`. A scene draws or receives initial states, asks `models` for observables, and
reduces what comes back. It knows nothing of files, workers or pictures' storage.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from explorer.measure import statistics
from explorer.phase.disk import Disk

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Table = dict[str, NDArray[Any]]
Tally = dict[str, Any]


@dataclass(frozen=True)
class Chunks:
    """What a scene computed, in the order of its chunks; each call starts from the first.

    tallies(): of all samples, ready for JSON. tables(): the rows that were kept.
    """

    tallies: Callable[[], Iterator[Tally]]
    tables: Callable[[], Iterator[Table]]


KEEP = ("none", "near", "all")
CHUNK_SIZE = 1 << 16  # samples; a kernel call on it stays well under a second


@dataclass(frozen=True)
class Scene(ABC):
    """A question about many initial states. Frozen, so that its options identify a run."""

    disks: tuple[Disk, ...]
    seed: int = 0
    accuracy: float = 1e-6
    method: str = "auto"

    name: ClassVar[str]
    observables: ClassVar[tuple[str, ...]]
    # Readers of options that mean something of their own here.
    readers: ClassVar[dict[str, Callable[[Any], Any]]] = {}

    @abstractmethod
    def options(self) -> dict[str, Any]:
        """Everything that decides the numbers, ready for JSON."""

    @abstractmethod
    def chunks(self) -> int:
        """Number of independent pieces of work."""

    @abstractmethod
    def compute(self, index: int) -> Table:
        """The samples of one piece: columns of equal length."""

    @abstractmethod
    def length(self, index: int) -> int:
        """How many samples chunk `index` stands for."""

    def process(self, index: int) -> tuple[Table, Tally]:
        """The rows of a chunk that are stored, and the counts of all its samples."""
        table = self.compute(index)
        return self.kept(table), self.tally(table)

    def tally(self, table: Table) -> Tally:
        """Counts of all samples of a chunk, ready for JSON; kept whichever rows are."""
        return {"status": statistics.count_status([table["status"]])}

    def kept(self, table: Table) -> Table:
        """The rows of a chunk that are stored."""
        return table

    @abstractmethod
    def summarise(self, chunks: Chunks) -> dict[str, Any]:
        """The scene's numbers from all samples, in chunk order."""

    @abstractmethod
    def figures(self, summary: dict[str, Any], chunks: Chunks) -> "Iterable[tuple[str, Figure]]":
        """Named pictures, drawn one at a time."""

    def headline(self, summary: dict[str, Any]) -> list[str]:
        """A few lines for a person."""
        return []

    @property
    def disk(self) -> Disk:
        """The disk of a scene that takes one."""
        return self.disks[0]

    @property
    def label(self) -> str:
        """Names the disks in a folder name."""
        return "+".join(disk.name for disk in self.disks)

    def common_options(self) -> dict[str, Any]:
        return {
            "scene": self.name,
            "disks": [disk.describe() for disk in self.disks],
            "seed": self.seed,
            "accuracy": self.accuracy,
            "method": self.method,
        }


@dataclass(frozen=True)
class SampledScene(Scene):
    """A scene made of `samples` equal draws on one disk."""

    samples: int = 100_000
    chunk_size: int = CHUNK_SIZE
    keep: str = "near"

    # Memory of one sample while its chunk is computed (bytes), for a budget.
    bytes_per_sample: ClassVar[int]

    def chunks(self) -> int:
        return -(-self.samples // self.chunk_size)

    @classmethod
    def default_chunk(cls, samples: int) -> int:
        """Samples per chunk unless a person says otherwise."""
        return CHUNK_SIZE

    def length(self, index: int) -> int:
        """How many samples chunk `index` stands for; only the last is shorter."""
        return min(self.chunk_size, self.samples - index * self.chunk_size)

    def near(self, table: Table) -> NDArray[np.bool_]:
        """Rows near F."""
        return np.ones(table["status"].size, dtype=bool)

    def kept(self, table: Table) -> Table:
        if self.keep == "all":
            return table
        rows = self.near(table) if self.keep == "near" else np.zeros(table["status"].size, dtype=bool)
        return {name: values[rows] for name, values in table.items()}

    def common_options(self) -> dict[str, Any]:
        sampled = {"samples": self.samples, "chunk_size": self.chunk_size, "keep": self.keep}
        return {**super().common_options(), **sampled}
