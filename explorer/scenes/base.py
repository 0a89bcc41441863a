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

from explorer.disk import Disk

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Table = dict[str, NDArray[Any]]
# Called as often as wanted; each call starts from the first chunk.
Tables = Callable[[], Iterator[Table]]

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
    def summarise(self, tables: Tables) -> dict[str, Any]:
        """The scene's numbers from all samples, in chunk order."""

    @abstractmethod
    def figures(self, summary: dict[str, Any], tables: Tables) -> "Iterable[tuple[str, Figure]]":
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

    def chunks(self) -> int:
        return -(-self.samples // self.chunk_size)

    def chunk_length(self, index: int) -> int:
        """How many samples chunk `index` holds; only the last is shorter."""
        return min(self.chunk_size, self.samples - index * self.chunk_size)

    def common_options(self) -> dict[str, Any]:
        return {**super().common_options(), "samples": self.samples, "chunk_size": self.chunk_size}


def column(tables: Tables, name: str) -> NDArray[Any]:
    """One column of all chunks, in order."""
    return np.concatenate([table[name] for table in tables()])
