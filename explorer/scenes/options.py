"""Options, declared once: a field of a frozen dataclass is a flag, a key of TOML and run.json, a keyword, a help.

    samples: int = option(whole_from(1), "number of samples", default=100_000)

The constructor reads what a user gave, in any of these ways, and what `as_json` wrote. A reader is called with the
name of the option and the value, and raises InputError with both.
"""

import argparse
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import Field, dataclass, field, fields, is_dataclass
from functools import partial
from inspect import get_annotations
from pathlib import Path
from typing import Any, NamedTuple, Self, dataclass_transform

import numpy as np

from explorer.compiled import usable_cores
from explorer.errors import MOST_JOBS, InputError, flag, number, one_of, shown, suggest, whole
from explorer.measure.distributions import Distribution, Weight, read_given
from explorer.paths import path_of
from explorer.phase.arguments import read_range
from explorer.phase.disk import Disk


class Reader(NamedTuple):
    """How a value is read: read(name, value).

    metavar: what help calls it; "" of a flag that stands alone, and None of an option of Python and files only.
    accepts: the types that users may give, as an annotation.
    """

    read: Callable[[str, Any], Any]
    metavar: str | None
    accepts: str


def option(
    reader: Reader,
    text: str,
    *,
    default: Any = None,
    words: str = "",
    follows: Callable[[Any, Any], Any] | None = None,
    key: str = "",
    also: str = "",
    several: bool = False,
    required: bool = False,
) -> Any:
    """A field that is an option.

    text: for help, and words: its default, where the value does not say it. follows: called with all options and
    with what was read, None where nothing was given; returns the value. key: what records call it that list
    one or several, as `slices` for slice. also: another name that it has in Python. several: whether the value is
    a tuple, of one or of a list, and the flag may be given more than once. required: whether it must be given.
    """
    if several:
        accepts = f"{reader.accepts} | Sequence[{reader.accepts}]"
        reader = Reader(partial(_read_all, reader.read), reader.metavar, accepts)
    about = {"reader": reader, "text": text, "words": words, "follows": follows, "required": required}
    return field(default=default, metadata={**about, "key": key, "also": also, "several": several})


def workers(text: str) -> Any:
    """An option that says how many workers there are."""
    words = "the cores that this process may use"
    return option(whole_from(1, MOST_JOBS), text, words=words, follows=lambda self, given: given or usable_cores())


def seeded() -> Any:
    """An option that says which random numbers are drawn."""
    kinds = "int | float | str | np.random.SeedSequence | np.random.Generator"
    return option(Reader(read_rng, "S", kinds), "seed of the random streams", default=0, also="rng")


@dataclass_transform(kw_only_default=True, frozen_default=True, field_specifiers=(option, workers, seeded))
class Options:
    """Fields that are options; a subclass is a frozen dataclass without saying so."""

    def __init_subclass__(cls, **how: Any) -> None:
        super().__init_subclass__(**how)
        inherited = {each.name for each in fields(cls.__mro__[1])} if is_dataclass(cls.__mro__[1]) else set()
        for name, value in vars(cls).items():
            here, declared = f"{cls.__name__}.{name}", isinstance(value, Field)
            if name in inherited and not declared:
                raise TypeError(f"{here} is an option; declare it anew by option(...)")
            if name not in inherited and declared and hasattr(super(cls, cls), name):
                raise TypeError(
                    f"{here} is the name of a method or an attribute already; give your option another name"
                )
        dataclass(frozen=True, kw_only=True, repr=False)(cls)

    def __post_init__(self) -> None:
        """Read what was given, and then find what follows from it. Raises InputError."""
        for each in options_of(type(self)):
            given = getattr(self, each.name)
            if given is None and each.metadata["required"]:
                raise InputError(f"{each.name}: is needed; {each.metadata['text']}")
            value = None if given is None else each.metadata["reader"].read(each.name, given)
            object.__setattr__(self, each.name, value)
        for each in options_of(type(self)):
            if each.metadata["follows"]:
                object.__setattr__(self, each.name, each.metadata["follows"](self, getattr(self, each.name)))

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> Self:
        """From names and values; None leaves the default. Raises InputError for a name that is no option."""
        known = {name: each.name for each in options_of(cls) for name in (key_of(each), *names_of(each))}
        for name in given:
            if name not in known:
                what, names = getattr(cls, "name", cls.__name__.lower()), [each.name for each in options_of(cls)]
                said = name if name.isidentifier() else shown(name)
                raise InputError(f"{said}: {what} takes no such option; {suggest(name, names)}")
            if name != known[name] and given.get(known[name]) is not None:
                raise InputError(f"{known[name]} and {name} are the same option; leave one out")
        return cls(**{known[name]: value for name, value in given.items() if value is not None})

    @classmethod
    def said(cls, words: argparse.Namespace) -> dict[str, Any]:
        """What a command line says of these options."""
        return {each.name: getattr(words, each.name) for each in options_of(cls) if hasattr(words, each.name)}

    def as_json(self) -> dict[str, Any]:
        """What decides the numbers; `of` takes it back."""
        record = {}
        for each in options_of(type(self)):
            value = getattr(self, each.name)
            listed = key_of(each) != each.name and not isinstance(value, tuple)
            record[key_of(each)] = plain([value] if listed else value)
        return record

    @classmethod
    def add_to(cls, parser: argparse.ArgumentParser, words: Sequence[str] = ()) -> None:
        """Add the flags to a parser, in a group for each class that declares some. words: are not looked at."""
        left = {each.name: each for each in options_of(cls) if each.metadata["reader"].metavar is not None}
        for kind in cls.__mro__:
            own = [left.pop(name) for name in get_annotations(kind) if name in left]
            group = parser.add_argument_group(first_line(kind).rstrip(".")) if own else parser
            for each in own:
                reader = each.metadata["reader"]
                how: dict[str, Any] = {"metavar": reader.metavar}
                if reader.metavar == "":
                    how = {"action": argparse.BooleanOptionalAction}
                elif each.metadata["several"]:
                    how["action"] = "append"
                flag, text = f"--{each.name.replace('_', '-')}", described(each).replace("%", "%%")
                group.add_argument(flag, dest=each.name, default=argparse.SUPPRESS, help=text, **how)


def _read_all(read: Callable[[str, Any], Any], name: str, value: Any) -> tuple[Any, ...]:
    """One value, or each of a list."""
    if isinstance(value, list | tuple) and not value:
        raise InputError(f"{name} {shown(value)}: is empty; give one or several, or leave it out")
    return tuple(read(name, each) for each in (value if isinstance(value, list | tuple) else [value]))


def options_of(kind: type) -> "tuple[Field[Any], ...]":
    """The options that a class declares and inherits."""
    return tuple(each for each in fields(kind) if "reader" in each.metadata)


def key_of(each: "Field[Any]") -> str:
    """What records call an option."""
    return each.metadata["key"] or each.name


def names_of(each: "Field[Any]") -> list[str]:
    """What an option is called in Python, first by its own name."""
    return list(filter(None, (each.name, each.metadata["also"])))


def described(each: "Field[Any]") -> str:
    """The sentence of help, with the default."""
    default = each.metadata["words"] or (
        "" if each.default is None or each.default is False else written(each.default)
    )
    return f"{each.metadata['text']} (default {default})" if default else str(each.metadata["text"])


def first_line(kind: type) -> str:
    return (kind.__doc__ or kind.__name__).partition("\n")[0]


def written(value: Any) -> str:
    """A default as a user would write it."""
    if isinstance(value, tuple):
        return (":" if isinstance(value[0], float) else ", ").join(map(written, value))
    return f"{value:g}" if isinstance(value, float) else str(value.name if isinstance(value, Disk) else value)


def plain(value: Any) -> Any:
    """A value as JSON has it; an open end of a range, and what is no number, is null."""
    if hasattr(value, "describe") and not isinstance(value, type):
        return dict(value.describe())
    if isinstance(value, Mapping):
        return {name: plain(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, np.generic | np.ndarray):
        return plain(value.tolist())
    if isinstance(value, Path):
        return str(value)
    return None if isinstance(value, float) and not math.isfinite(value) else value


# Readers of several scenes


def whole_from(low: int, high: int | None = None, metavar: str = "N") -> Reader:
    """A whole number."""
    return Reader(partial(whole, low=low, high=high), metavar, "int | float | str")


def number_from(low: float, high: float = math.inf, metavar: str = "X") -> Reader:
    """A finite number."""
    return Reader(partial(number, low=low, high=high), metavar, "float | str")


def word_of(*known: str) -> Reader:
    """One of some words."""
    metavar = "|".join(known) if len(known) < 5 else "NAME"
    return Reader(partial(one_of, known=known), metavar, f"Literal[{', '.join(map(repr, known))}]")


def read_disk(name: str, value: Any) -> Disk:
    """Read a disk: a Disk, a text as for Disk.parse, or the numbers that run.json has. Raises InputError."""
    if isinstance(value, list | tuple):
        if len(value) != 1:
            raise InputError(f"{name}: this scene takes one disk, {len(value)} were given; leave out the others")
        (value,) = value
    if isinstance(value, Disk):
        return value
    if isinstance(value, Mapping):
        try:
            return Disk(**value)
        except (TypeError, InputError) as error:
            raise InputError(f"{name} {shown(dict(value))}: {error}; give m, r, g, I1, I3 and name") from None
    if not isinstance(value, str):
        raise InputError(f"{name} {shown(value)} is not a disk; give a Disk or a name")
    return Disk.parse(value)


def read_rng(name: str, value: Any) -> int:
    """A seed from an int, or from a SeedSequence or Generator of numpy, which give 128 bits. Raises InputError."""
    if isinstance(value, np.random.SeedSequence):
        if not value.spawn_key and isinstance(value.entropy, int) and value.entropy < 2**128:
            return value.entropy
        return int.from_bytes(value.generate_state(4).astype("<u4").tobytes(), "little")
    if isinstance(value, np.random.Generator):
        return int.from_bytes(value.integers(0, 2**32, 4, dtype=np.uint32).astype("<u4").tobytes(), "little")
    return whole(name, value, high=2**128 - 1)


def read_box(name: str, value: Any) -> Any:
    """Read what is given of each coordinate; a box that was read already stays. Raises InputError."""
    return value if isinstance(value, Distribution) else read_given(name, value)


def read_density(name: str, value: Any) -> Weight:
    """Read a density. A stored run says only which function it had. Raises InputError."""
    if not callable(value):
        remedy = (
            "was given in Python; go on with run(..., density=...) there" if isinstance(value, Mapping) else ""
        )
        raise InputError(f"{name} {shown(value)} {remedy or 'cannot be called; give a function of arrays'}")
    density: Weight = value
    return density


TEXT = Reader(lambda name, value: str(value), "TEXT", "str")
FOLDER = Reader(path_of, "DIR", "Path | str")
TRUTH = Reader(flag, "", "bool")
NUMBER = Reader(number, "X", "float | str")
RANGE = Reader(read_range, "LOW:HIGH", "str | float | tuple[float, float]")
OPEN_RANGE = Reader(partial(read_range, unbounded=True), "LOW:HIGH", "str | tuple[float | None, float | None]")
BOX = Reader(read_box, "NAME=VALUE,..", "str | Mapping[str, Any]")
DISK = Reader(read_disk, "DISK", "Disk | str")
DENSITY = Reader(read_density, None, "Callable[..., Array]")
