"""The options of scenes: how a scene declares one, and the readers of what only scenes are given.

The table `Keywords` of a scene is the only place that knows its options. The command line, TOML files, `ex.run`
with its signature and its documentation, and run.json all go through it, in both directions: what `as_json`
writes, the readers take back.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, get_args, get_origin, get_type_hints

from explorer.errors import InputError, flag, number, one_of, shown, whole
from explorer.measure.density import Function
from explorer.measure.sampling import Box, Range, parse_ranges
from explorer.motion.plan import METHODS
from explorer.phase.arguments import read_range
from explorer.phase.disk import SYNTAX, Disk
from explorer.portrait.slices import Slice
from explorer.scenes.given_states import GivenStates

# What users may give: one disk or several, ranges of coordinates, a range that may be open, distances from F.
Disks = Disk | str | Sequence[Disk | str]
Ranges = Box | str | Mapping[str, Range]
OpenRange = str | tuple[float | None, float | None]
Distances = str | float | Range

MOST_SAMPLES = 10**12
_KEEP = ("none", "near", "all")


@dataclass(frozen=True)
class Option:
    """One option of a scene.

    flag: as on the command line; a flag without dashes is an option for Python and for files only.
    read: called as read(flag, value); returns the value of the scene's field; raises InputError naming the flag.
    metavar, text: for --help; an option without a metavar takes no value and means True.
    default: for --help, in words, where the default of the field does not say it.
    field: the name of the scene's field, where it is not the word of the flag.
    several: whether the flag may be given several times.
    kind: the types that Python accepts; `options_of` takes them from the annotation.
    """

    flag: str
    read: Callable[[str, Any], Any]
    metavar: str
    text: str
    default: str = ""
    field: str = ""
    several: bool = False
    kind: Any = Any

    @property
    def word(self) -> str:
        """The option as a keyword of Python: "--eta-hat" is eta_hat."""
        return self.flag.lstrip("-").replace("-", "_")

    @property
    def name(self) -> str:
        """The name of the scene's field, which is also the key in run.json."""
        return self.field or self.word

    def help_for(self, kind: type) -> str:
        """The sentence of --help, with the default that this kind of scene has."""
        plain = getattr(kind, self.name, None)
        default = self.default or ("" if plain is None or plain is False else _written(plain))
        return f"{self.text} (default {default})" if default else self.text


def options_of(keywords: type) -> tuple[Option, ...]:
    """The options that a typed dictionary of keywords declares: `seed: Annotated[int, Option("--seed", ...)]`."""
    hints = get_type_hints(keywords, include_extras=True).values()
    return tuple(replace(hint.__metadata__[0], kind=hint.__origin__) for hint in hints)


def described(kinds: Iterable[Any]) -> Iterator[tuple[Option, str]]:
    """Each option of some scenes, once, and its sentence, which says for which scenes it is, unless for all."""
    several = list(kinds)
    takers: dict[str, list[tuple[Any, Option]]] = {}
    for kind in several:
        for option in kind.OPTIONS:
            takers.setdefault(option.word, []).append((kind, option))
    for pairs in takers.values():
        texts: dict[str, list[str]] = {}
        for kind, option in pairs:
            texts.setdefault(option.help_for(kind), []).append(kind.name)
        alone = len(texts) == 1 and len(pairs) == len(several)
        sentences = [text if alone else f"{', '.join(names)}: {text}" for text, names in texts.items()]
        accepted = [option.kind for _, option in pairs]
        yield replace(pairs[0][1], kind=accepted), "; ".join(sentences)


_WORDS = {tuple: "pair", Sequence: "list", Mapping: "mapping", Callable: "function", Path: "path"}


def type_words(hint: Any) -> str:
    """A type, or several, as a docstring says it: "Disk or str or list"."""
    if isinstance(hint, list | UnionType):
        parts = [type_words(part) for part in (hint if isinstance(hint, list) else get_args(hint))]
        return " or ".join(dict.fromkeys(word for part in parts for word in part.split(" or ") if word))
    origin = get_origin(hint) or hint
    return "" if hint is NoneType else _WORDS.get(origin, origin.__name__)


def as_json(value: Any) -> Any:
    """The value of an option as run.json holds it; an infinite end of a range is null."""
    if hasattr(value, "describe") and not isinstance(value, type):
        return value.describe()
    if isinstance(value, Mapping):
        return {name: as_json(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [as_json(item) for item in value]
    return None if isinstance(value, float) and math.isinf(value) else value


def _written(value: Any) -> str:
    """A default as a user would write it."""
    if isinstance(value, tuple) and value and isinstance(value[0], float):
        return ":".join(f"{end:g}" for end in value)
    if isinstance(value, tuple):
        return ", ".join(getattr(item, "name", str(item)) for item in value)
    return f"{value:g}" if isinstance(value, float) else str(value)


def read_disk(flag: str, value: Any) -> tuple[Disk, ...]:
    """Read one disk. Raises InputError."""
    disks = read_disks(flag, value)
    if len(disks) > 1:
        raise InputError(f"{flag}: this scene takes one disk, {len(disks)} were given; leave out the others")
    return disks


def read_disks(flag: str, value: Any) -> tuple[Disk, ...]:
    """Read disks: each a Disk, a text as for Disk.parse, or the numbers that run.json has. Raises InputError."""
    several = [value] if isinstance(value, str | Disk | Mapping) else value
    if not isinstance(several, list | tuple) or not several:
        raise InputError(f"{flag} {shown(value)} is not a disk; give a Disk, a name, or a list of them")
    return tuple(_one_disk(flag, disk) for disk in several)


def _one_disk(flag: str, value: Any) -> Disk:
    if isinstance(value, Disk):
        return value
    if isinstance(value, Mapping):
        try:
            return Disk(**value)
        except (TypeError, InputError) as error:
            raise InputError(f"{flag} {shown(dict(value))}: {error}; give m, r, g, I1, I3 and name") from None
    if not isinstance(value, str):
        raise InputError(f"{flag} {shown(value)} is not a disk; give a Disk or a name")
    return Disk.parse(value)


def read_ranges(flag: str, value: Any) -> dict[str, Range]:
    """Read ranges of coordinates: "phi=0,phidot=-2:2", a mapping, or a Box. Raises InputError."""
    given = as_json(value)
    for name, ends in given.items() if isinstance(given, Mapping) else ():
        if not isinstance(ends, str | list):
            raise InputError(f"{flag} {name} = {shown(ends)} is not a range; give LOW:HIGH or a pair of numbers")
    return parse_ranges(given, flag)


def read_slices(flag: str, value: Any) -> tuple[Slice, ...]:
    """Read slices, each as text or a mapping. Raises InputError."""
    several = [value] if isinstance(value, str | Slice | Mapping) else value
    if not isinstance(several, list | tuple) or not several:
        raise InputError(f"{flag} {shown(value)} is not a slice or a list of slices")
    return tuple(Slice.of(each, flag) for each in several)


def read_density(flag: str, value: Any) -> Function:
    """Read a density. A stored run says only which function it had. Raises InputError."""
    if isinstance(value, Mapping):
        raise InputError(
            f"{flag}: this run has a density that was given in Python; go on with run(..., density=...) there"
        )
    if not callable(value):
        raise InputError(f"{flag} = {shown(value)} cannot be called; give a function of four arrays")
    density: Function = value
    return density


# Options of several scenes.
DISK = Option(
    "--disk",
    read_disk,
    "DISK",
    f"disk: {SYNTAX}",
    field="disks",
    several=True,
)
SEED = Option("--seed", partial(whole, high=2**128 - 1), "S", "seed of the random streams")
ACCURACY = Option(
    "--accuracy", number, "TOL", "largest error: absolute of angles (rad), relative of times and tilts"
)
METHOD = Option("--method", partial(one_of, known=METHODS), "NAME", ", ".join(METHODS))
SAMPLES = Option(
    "--samples", partial(whole, low=1, high=MOST_SAMPLES), "N", "number of samples; 1e6 is a whole number too"
)
CHUNK_SIZE = Option("chunk_size", partial(whole, low=1, high=10**8), "N", "samples per chunk")
KEEP = Option(
    "--keep",
    partial(one_of, known=_KEEP),
    "WHICH",
    "samples to store: those near the falling set (near), all or none; counts are always of all",
)
BOX = Option(
    "--box",
    read_ranges,
    "BOX",
    'where states are drawn, in the units of the disk: "phi=0,phidot=-2:2,sigma3=-2:2,sigma4=-2:2"',
    default="that, in natural units",
)
ENERGY = Option(
    "--energy",
    partial(read_range, unbounded=True),
    "LOW:HIGH",
    "only states with an energy in this range, in the units of the disk; :HIGH and LOW: leave one end open",
)
GAUSSIAN = Option(
    "--gaussian",
    read_ranges,
    "BELLS",
    'coordinates drawn from a Gaussian that the box cuts off: "phidot=MEAN:DEVIATION,..", in the units of the '
    "disk",
)
DENSITY = Option(
    "density",
    read_density,
    "FUNCTION",
    "a density, called as density(phi, phidot, sigma3, sigma4) with arrays in the units of the disk",
)
STATES = Option(
    "--states",
    GivenStates.of,
    "FILE",
    "Parquet or CSV file with states, instead of --box: columns tilt, tilt_rate, precession, spin; or phi, "
    "phidot, sigma3, sigma4; or phidot, sigma3_bar, eta_hat; all other columns go on into the results",
)
DEGREES = Option("--degrees", flag, "", "angles and rates in --states are in degrees")
