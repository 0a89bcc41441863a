"""A scene: a question about many initial states, in one file.

It declares its options as fields (`options.option`) and what it counts (`measure.tallies`), and offers `draw`,
`observe`, `count` and `summarise`; where it makes sense `near`, `headline` and `figures`. How samples are cut into
chunks and blocks, which rows are kept, files and workers are not its concern.
"""

import os
import re
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, RunError, one_of, said, shown, suggest, whole
from explorer.measure.sampling import PER_STREAM, Stream, numbered_stream
from explorer.measure.tallies import ByName, Tally
from explorer.motion.plan import METHODS, Plan, plan
from explorer.paths import path_of, read_toml
from explorer.phase.columns import Column
from explorer.phase.disk import SYNTAX, Disk
from explorer.phase.results import Columns as Columns
from explorer.phase.results import count_status, stacked
from explorer.scenes.options import DISK, NUMBER, Options, Reader, option, options_of, seeded, whole_from, word_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# A picture that is drawn when it is called, with ax= and keywords of its function where it takes them.
Picture: TypeAlias = "Callable[..., Axes | Figure]"
K = TypeVar("K", bound="type[Scene]")
SAMPLES = whole_from(1, 10**12), "number of samples, e.g. 1e6"
# Above so many samples a run is large, and so are its chunks where few of their rows are stored.
MANY, _LARGEST = 10_000_000, 1 << 26


def read_chunk_size(name: str, value: Any) -> int:
    """Read the size of a chunk: whole streams, or an even part of one. Raises InputError with the nearest size."""
    size = whole(name, value, low=1, high=_LARGEST)
    step = min(PER_STREAM, 1 << size.bit_length() - 1)
    if nearest := size % step and round(size / step) * step:
        raise InputError(f"{said(name, value)} is no power of two and no multiple of {PER_STREAM}; give {nearest}")
    return size


class Counts(Tally):
    """What every scene counts: in which status its samples ended, also those whose rows are not kept."""

    status: ByName[int]


class Scene(Options, ABC):
    """Options of every scene."""

    disk: Disk = option(DISK, f"disk: {SYNTAX}", default=Disk.uniform(), key="disks")
    seed: int = seeded()
    accuracy: float = option(
        NUMBER._replace(metavar="TOL"),
        "largest error accepted: absolute for angles (rad), relative for times and tilts",
        default=1e-6,
    )
    method: str = option(word_of(*METHODS), ", ".join(METHODS), default="auto")

    name: ClassVar[str]  # race-angles of class RaceAngles
    tally: ClassVar[type[Counts]] = Counts
    observables: ClassVar[tuple[str, ...]] = ()
    # What it stores of a sample, by the names of `phase.columns`, or with what they mean; chunks may have others.
    columns: ClassVar[Sequence[str] | dict[str, Column]] = ("status",)
    columns_of_given: ClassVar[tuple[str, ...]] = ()  # what else it stores where the states are given
    bytes_per_sample: ClassVar[int] = 1000  # at most, while it is computed
    # Lines that are said of a run: `str.format` with the summary; one whose numbers are not there is not.
    says: ClassVar[Sequence[str]] = ()
    unsaid: ClassVar[Sequence[str]] = ()  # of an object, the options that were not given

    def __init_subclass__(cls, **how: Any) -> None:
        super().__init_subclass__(**how)
        if "name" not in vars(cls):
            cls.name = re.sub(r"(?<=.)(?=[A-Z])", "-", cls.__name__).lower()

    def __post_init__(self) -> None:
        """Raise InputError where options do not go together; scenes add what they must refuse."""
        unsaid = [each.name for each in options_of(type(self)) if getattr(self, each.name) is None]
        object.__setattr__(self, "unsaid", unsaid)
        super().__post_init__()
        _ = self.plan  # a method that cannot give the observables is refused before anything is written
        if not self.observables and self.method != "auto":
            raise InputError(f"method {self.method}: {self.name} names no observables, so it has no methods")

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

    def drawn(self, index: int) -> int:
        """How many samples the streams of chunk `index` give; it is another chunk where more would come."""
        return self.length(index)

    @abstractmethod
    def chunk(self, index: int) -> tuple[Columns, Any]:
        """The rows of chunk `index` that are stored, and the counts of all its samples."""

    def summarise(self, tally: Any) -> dict[str, Any]:
        """The numbers of a run, from what was counted of all samples."""
        return {"samples": sum(tally.status.values()), "status": dict(tally.status)}

    def figures(self, summary: dict[str, Any], tally: Any) -> Iterable[tuple[str, Picture]]:
        """Named pictures; each is drawn when it is called."""
        return ()

    def headline(self, summary: dict[str, Any]) -> list[str]:
        """The summary in a few lines of text: `says`, or its numbers that are no options; how samples ended."""
        lines = [text for line in self.says if (text := _filled(line, summary))]
        known = {*self.options, "digest"}
        plain = [
            f"{name}: {value}"
            for name, value in summary.items()
            if isinstance(value, int | float | str) and name not in known
        ]
        ended = ", ".join(f"{count:,} {name}" for name, count in summary.get("status", {}).items())
        return [*(lines or plain), *([f"status: {ended}"] if ended else [])]

    @property
    def label(self) -> str:
        """Names the disk, or several, in the name of a folder."""
        return "+".join(disk["name"] for disk in self.options["disks"])

    @property
    def kernels(self) -> tuple[str, ...]:
        """What it calls of the compiled layer, by the names of `compiled.warmup`: a run compiles these first."""
        return ()

    @cached_property
    def plan(self) -> Plan:
        """How the observables are computed. Raises InputError where the method cannot give them."""
        return plan(self.observables, self.accuracy, self.method)


class SampledScene(Scene):
    """How many samples, and which of them are stored."""

    samples: int = option(*SAMPLES, default=100_000)
    keep: str = option(
        word_of("none", "near", "all"),
        "which samples to store: near (those near the falling set), all or none; counts always cover all",
        default="near",
    )
    chunk_size: int = option(
        Reader(read_chunk_size, "N", "int | float | str"),
        "samples per chunk: a power of two up to 65536, or a multiple of 65536; no sample depends on it",
        words=f"65536; 2^20 above {MANY:.0e} samples if few rows are stored",
        follows=lambda self, given: given or PER_STREAM << 4 * (self.samples > MANY and self.keep in self.few),
    )

    few: ClassVar[tuple[str, ...]] = ("none",)  # of `keep`, what stores only a small share of the rows

    # What a scene offers

    def draw(self, random: Stream, count: int) -> Columns:
        """So many samples, or what makes them: columns, from a random stream."""
        raise NotImplementedError(_OFFERS)

    def observe(self, drawn: Any) -> Columns:
        """All columns of a block of samples that are stored or counted; one is `status`."""
        raise NotImplementedError(_OFFERS)

    def count(self, tally: Any, table: Columns) -> None:
        """Add the samples of a block to a tally, whose `status` is counted already."""

    def near(self, table: Columns) -> NDArray[np.bool_]:
        """The rows that keep="near" stores."""
        return np.ones(table["status"].size, bool)

    @property
    def block(self) -> int:
        """How many samples are drawn and observed at once; another number would give others."""
        return PER_STREAM

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

    def streams(self, index: int, before: int = 0) -> Iterator[tuple[Stream, int, range]]:
        """The random streams of a chunk, each with how many samples it gives and which of them the chunk has.

        before: how many other streams the run has, which are numbered first.
        """
        first, end = index * self.chunk_size, min((index + 1) * self.chunk_size, self.samples)
        for begin in range(first - first % PER_STREAM, end, PER_STREAM):
            random, count = numbered_stream(self.seed, before + begin // PER_STREAM), self.samples - begin
            yield random, min(count, PER_STREAM), range(max(first - begin, 0), min(end - begin, PER_STREAM))

    def drawn(self, index: int) -> int:
        return sum(count for _, count, _ in self.streams(index))

    def blocks(self, index: int) -> Iterator[Any]:
        """What `observe` takes, block by block.

        A chunk that is a part of a stream draws also what comes before its own samples, and with them.
        """
        for random, due, own in self.streams(index):
            for first in range(0, own.stop, self.block):
                drawn = self.draw(random, count := min(self.block, due - first))
                # At the end of the stream nothing is cut off, so that too many are noticed.
                rows = slice(max(own.start - first, 0), None if own.stop == due else own.stop - first)
                if own.start < first + count:
                    yield {name: values[rows] for name, values in drawn.items()}

    def chunk(self, index: int) -> tuple[Columns, Any]:
        tally, kept = self.tally(), []
        for block in self.blocks(index):
            table = self.checked(self.observe(block))
            tally.status += count_status(table["status"][:: self.rows])
            self.count(tally, table)
            kept.append(self.kept(table))
        if (counted := sum(tally.status.values())) != (due := self.length(index)):
            raise RunError(
                f"scene {self.name}: draw and observe give {counted} samples, not {due}; give one row a sample"
            )
        return stacked(kept), tally

    def checked(self, table: Columns) -> Columns:
        """What `observe` returned. Raises RunError where it is no table with statuses and what `columns` names."""
        missing = [name for name in ("status", *self.columns) if not (isinstance(table, dict) and name in table)]
        if missing:
            raise RunError(f"scene {self.name}: observe returns no column {missing[0]}; return a dict with it")
        shapes = {name: np.shape(values) for name, values in table.items()}
        if len({*shapes.values()}) > 1:
            raise RunError(
                f"scene {self.name}: observe returns columns of several shapes {shapes}; return one row a sample"
            )
        given = np.asarray(table["status"])
        with np.errstate(invalid="ignore"):
            status = given.astype(np.int8, copy=False)
        if status is not given and not np.array_equal(status, given):
            raise RunError(f"scene {self.name}: observe returns statuses that are none; use those of ex.Status")
        return table | {"status": status}

    def kept(self, table: Columns) -> Columns:
        """The rows of a block that are stored."""
        if self.keep == "all":
            return table
        if self.keep == "none":
            return {name: values[:0].copy() for name, values in table.items()}
        rows = self.near(table)
        return table if rows.all() else {name: values[rows] for name, values in table.items()}


def _filled(line: str, known: dict[str, Any]) -> str:
    """A line with its numbers; empty where one is missing."""
    try:
        return line.format(**known)
    except (KeyError, IndexError, TypeError, ValueError):
        return ""


# The scenes by name, those of users among them

# Each is a file and a class of this name: race-angles is RaceAngles in race_angles.py.
NAMES = ("falling-set", "measure-zero", "one-sided", "race-angles")
_GONE = {"portrait": "nearflat portrait --only phase draws its pictures, and with --json gives its numbers"}
_own: dict[str, type[Scene]] = {}
_OFFERS = "a scene offers draw(random, count), observe(drawn), and mostly count(tally, table) and summarise(tally)"


def register(scene: K) -> K:
    """Register a scene of your own, so that `run` and `open` know it by its name. Also usable as a decorator.

    It then has all that the scenes of nearflat have: chunks, resuming, workers of every kind, counts, a summary
    and help. On the command line, `nearflat run my.py:Coins` needs no registration.

    Parameters
    ----------
    scene : type
        A class derived from `explorer.scenes.SampledScene`, with the methods `draw` and `observe` and usually
        `count` and `summarise`; or, if it draws nothing at random, from `explorer.scenes.Scene`, with `chunks`,
        `length` and `chunk`. Its docstring states the question. If you register another class of the same name
        later, it replaces this one.

    Returns
    -------
    type
        The same class.

    Raises
    ------
    InputError
        If it is not such a class, or has the name of one of nearflat's own scenes.

    Examples
    --------
    >>> import explorer as ex
    >>> from explorer.scenes.scene import Counts, SampledScene
    >>> class CoinCounts(Counts):
    ...     heads: int
    >>> @ex.register
    ... class Coins(SampledScene):
    ...     "How often does a coin show heads?"
    ...     tally = CoinCounts
    ...     def draw(self, random, count):
    ...         return {"heads": random.random(count) < 0.5}
    ...     def observe(self, drawn):
    ...         return {**drawn, "status": 0 * drawn["heads"].astype("i1")}
    ...     def count(self, tally, table):
    ...         tally.heads += int(table["heads"].sum())
    ...     def summarise(self, tally):
    ...         return {"share": tally.heads / self.samples}
    >>> round(ex.run("coins", samples=100_000).summary["share"], 2)
    0.5
    """
    if not (isinstance(scene, type) and issubclass(scene, Scene)):
        raise InputError(f"scene = {shown(scene)} is no scene; derive one from explorer.scenes.SampledScene")
    if not scene.__module__.startswith("explorer."):
        if scene.name in NAMES:
            raise InputError(f"scene {scene.name!r} is a scene of nearflat; give yours another name")
        _own[scene.name] = scene
    return scene


def scene_class(name: Any) -> type[Scene]:
    """The class of a scene, by its name, by "FILE.py:CLASS", or itself. Raises InputError with what is known."""
    if isinstance(name, type):
        return register(name)
    if isinstance(name, str) and (".py:" in name or name.endswith(".py")):
        return register(_in_file(name))
    return known_scene(name)


def known_scene(name: Any) -> type[Scene]:
    """The class of a scene of nearflat or of one that is registered; no file is looked for. Raises InputError."""
    known = [*NAMES, *_own]
    if not isinstance(name, str) or name not in known:
        if instead := _GONE.get(str(name)):
            raise InputError(f"scene {name}: there is no such scene any more; {instead}")
        yours = "A scene of your own: nearflat run my.py:Scene, or ex.register(Scene)"
        raise InputError(f"scene {shown(name)} is not known; {suggest(name, known)}. {yours}")
    if name in _own:
        return _own[name]
    home = import_module(f"explorer.scenes.{name.replace('-', '_')}")
    found: type[Scene] = getattr(home, name.title().replace("-", ""))
    return found


def _in_file(where: str) -> type[Scene]:
    """The class that "my.py:Scene" names; its folder becomes one that workers import from, too."""
    path, _, name = where.rpartition(":") if ".py:" in where else (where, "", "")
    file = path_of("scene", path).resolve()
    if not file.is_file():
        raise InputError(f"scene {where}: there is no file {path}")
    if "." in file.stem:
        raise InputError(f"scene {where}: Python cannot import a file with a dot in its name; rename the file")
    if str(file.parent) not in sys.path:
        sys.path.insert(0, str(file.parent))
    with _from_source():
        module = import_module(file.stem)
    if Path(str(module.__file__)).resolve() != file:
        raise InputError(f"scene {where}: {file.stem} is the name of another module; rename the file")
    own = {each: kind for each, kind in vars(module).items() if isinstance(kind, type) and issubclass(kind, Scene)}
    return own[one_of(f"scene {where}:", name, [each for each in own if own[each].__module__ == module.__name__])]


@contextmanager
def _from_source() -> Iterator[None]:
    """Imports compile what the files say: what lies compiled beside them may come from others."""
    before = sys.pycache_prefix, sys.dont_write_bytecode
    sys.pycache_prefix, sys.dont_write_bytecode = os.devnull, True
    try:
        yield
    finally:
        sys.pycache_prefix, sys.dont_write_bytecode = before


def file_of(kind: type[Scene]) -> str | None:
    """ "FILE.py:CLASS" of a user's scene that another process can load in that way; None where there is none."""
    module = sys.modules.get(kind.__module__)
    file = getattr(module, "__file__", None)
    if kind.__module__.startswith("explorer.") or file is None:
        return None
    return f"{Path(file).resolve()}:{kind.__qualname__}"


def is_known(name: str, where: str) -> bool:
    """Whether the registered scene of this name is the one that "FILE.py:CLASS" names."""
    return name in _own and file_of(_own[name]) == where


def scene_of(options: dict[str, Any]) -> Scene:
    """The known scene whose `options` these are. Raises InputError."""
    return known_scene(options["scene"]).of({key: value for key, value in options.items() if key != "scene"})


def read_scene_file(path: Path) -> dict[str, Any]:
    """Options from a TOML file that names a `scene`. Raises InputError."""
    content = read_toml(path, "SCENE")
    if not isinstance(content.get("scene"), str):
        raise InputError(f'{path}: names no scene; write scene = "race-angles" or another at its top')
    names = [key.replace("-", "_") for key in content]
    twice = {name for name in names if names.count(name) > 1}
    if twice:
        raise InputError(f"{path}: {min(twice)} is given twice, with - and with _; leave one out")
    return dict(zip(names, content.values(), strict=True))
