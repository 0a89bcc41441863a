"""The one door of all pictures: what users give is read here, before anything is drawn.

The annotation of an argument says what reads it: a result must be of that kind, and the docstring says which
public call gives one; disks, numbers, ranges and paths have the readers that they have everywhere. What only one
picture can judge, such as the name of an observable, it reads itself.
"""

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, wraps
from itertools import islice
from pathlib import Path
from types import UnionType
from typing import Any, NamedTuple, ParamSpec, TypeVar, Union, get_args, get_origin, get_type_hints

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.errors import InputError, RunError, flag, number, reader, shorten, shown, whole
from explorer.phase.arguments import column, read_range
from explorer.phase.disk import Array, Disk, require_disk
from explorer.phase.paths import path_of

P = ParamSpec("P")
R = TypeVar("R")

_MOST = 10_000  # results in a list
# From where to where numbers go, by the names of arguments; others are whole and positive, or finite.
_LIMITS: dict[str, tuple[float, float]] = {
    "bins": (1, 1000),
    "dpi": (1, 2400),
    "frames": (2, 100_000),
    "height": (0.5, 100.0),
    "samples": (1, 10**18),
}


def reads_arguments(draw: Callable[P, R]) -> Callable[P, R]:
    """Let a picture get its arguments as its annotations say, and say as InputError what it cannot draw."""

    @wraps(draw)
    def read(*given: P.args, **named: P.kwargs) -> R:
        return call(draw, given, named)

    return read


def call(draw: Callable[..., R], given: tuple[Any, ...], named: dict[str, Any]) -> R:
    """Draw what was given.

    Raises InputError for arguments that are none of the picture, and for what goes wrong with those that it cannot
    judge beforehand: keywords for matplotlib, and the entries of a summary.
    """
    form = _form(draw)
    try:
        bound = form.signature.bind(*given, **named)
    except TypeError as error:
        raise InputError(f"{draw.__name__}: {error}; it takes {', '.join(form.kinds)}") from None
    for name, kind in form.kinds.items():
        if name in bound.arguments:
            bound.arguments[name] = _read(name, bound.arguments[name], draw, kind)
    try:
        return draw(*bound.args, **bound.kwargs)
    except (InputError, RunError):
        raise
    except Exception as error:
        foreign = _foreign(form, bound.arguments)
        if not foreign:
            raise
        why = shorten(f"{type(error).__name__}: {error}", 120)
        raise InputError(f"{draw.__name__}: {' or '.join(foreign)} cannot be drawn ({why})") from error


@reader
def _read(name: str, value: Any, draw: Callable[..., Any], kind: Any) -> Any:
    return _Argument(draw, name).read(kind, value)


class _Form(NamedTuple):
    """How a picture is called: the kinds of its arguments by name, and that of its other keywords."""

    signature: inspect.Signature
    kinds: dict[str, Any]
    look: str | None


@cache
def _form(draw: Callable[..., Any]) -> _Form:
    signature, hints = inspect.signature(draw), get_type_hints(draw)
    several = (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL)
    kinds = {name: hints.get(name, Any) for name, each in signature.parameters.items() if each.kind not in several}
    look = [name for name, each in signature.parameters.items() if each.kind is several[0]]
    return _Form(signature, kinds, look[0] if look else None)


def _foreign(form: _Form, arguments: Mapping[str, Any]) -> list[str]:
    """What was given that no reader here can vouch for."""
    tables = [name for name, kind in form.kinds.items() if _of_summary(kind, arguments.get(name))]
    look = arguments.get(form.look, {}) if form.look else {}
    return [*(f"{name} = {shown(value)}" for name, value in islice(look.items(), 2)), *tables]


def _of_summary(kind: Any, value: Any) -> bool:
    """Whether a value is a summary, or rows of one, of which nobody knows what it holds."""
    entries = [entry for each in _several(kind) for entry in get_args(each)]
    of_any = Any in entries or any(Any in get_args(entry) for entry in entries)
    return of_any and isinstance(value, Mapping | list)


def _several(kind: Any) -> tuple[Any, ...]:
    """The kinds that an argument may have."""
    return get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)


class _Argument(NamedTuple):
    """An argument of a picture, by name."""

    draw: Callable[..., Any]
    name: str

    def read(self, kind: Any, value: Any) -> Any:
        """The value as its annotation says it. Raises InputError."""
        kinds = _several(kind)
        if value is None and type(None) in kinds:
            return None
        kinds = tuple(each for each in kinds if each is not type(None))
        reader = _READERS.get(frozenset(kinds))
        if reader is not None:
            return reader(self.name, value)
        if not all(map(_can_tell, kinds)):
            return value
        for each in kinds:
            found = self._of_kind(each, value)
            if found is not None:
                return found
        text = inspect.getdoc(self.draw) or ""
        what = _described(text, self.name) or "a result of the kind that it draws"
        of = "an empty " if isinstance(value, list | tuple | dict) and not value else "a "
        said = f"{self.draw.__name__}: {self.name} must be {shorten(what, 160)}"
        raise InputError(f"{said}; {of}{type(value).__name__} was given")

    def _of_kind(self, kind: Any, value: Any) -> Any:
        """A value of one kind, a sequence as a list; None where it is of another kind, or there is none in it."""
        origin, entries = get_origin(kind), get_args(kind)
        if origin is None:
            return value if isinstance(value, kind) else None
        if isinstance(value, Mapping) and origin is not Sequence:
            known = Any in entries or (value and all(isinstance(each, entries[1]) for each in value.values()))
            return value if known else None
        if origin is not Sequence or isinstance(value, Mapping | str) or not isinstance(value, Iterable):
            return None
        try:
            several = list(islice(value, _MOST))
        except Exception:  # a single number of numpy, or an object with its own way to fail
            return None
        of_results = inspect.isclass(entries[0]) and self.name == next(iter(_form(self.draw).kinds))
        if of_results and not several:
            return None
        kinds = get_origin(entries[0]) or entries[0]
        return several if all(isinstance(each, kinds) for each in several) else None


def _can_tell(kind: Any) -> bool:
    """Whether a kind is a result, or holds some."""
    if get_origin(kind) in (Mapping, dict, Sequence):
        return True
    return inspect.isclass(kind) and kind.__module__.startswith("explorer.")


def _described(text: str, name: str) -> str:
    """The kind and the origin of an argument, as a docstring gives them."""
    lines = iter(text.splitlines())
    for line in lines:
        names, colon, kind = line.partition(" : ")
        if colon and name in names.split(", "):
            origin = []
            for more in lines:
                if not more.startswith("    "):
                    break
                origin.append(more.strip())
            said = " ".join(origin).replace("`explorer.", "ex.").replace("`", "").rstrip(".")
            return f"{kind}, {said[:1].lower()}{said[1:]}"
    return ""


def _read_disk(name: str, value: Any) -> Disk:
    require_disk(value)
    disk: Disk = value
    return disk


def _read_whole(name: str, value: Any) -> int:
    low, high = _LIMITS.get(name, (1, 10**9))
    return whole(name, value, int(low), int(high))


def _read_number(name: str, value: Any) -> float:
    return number(name, value, *_LIMITS.get(name, ()))


def _read_numbers(name: str, value: Any) -> list[float]:
    return [number(name, each) for each in column(name, value).ravel().tolist()]


def _read_numbered(name: str, value: Any) -> dict[int, float]:
    if not isinstance(value, Mapping):
        raise InputError(f"{name} = {shown(value)}: give a dict of whole numbers to numbers")
    return {whole(name, key, -(10**9), 10**9): number(name, each) for key, each in value.items()}


def _read_axes(name: str, value: Any) -> Axes:
    if not isinstance(value, Axes):
        raise InputError(f"{name} = {shown(value)} are no Axes of matplotlib; give some, or leave {name} out")
    scales = {value.get_xscale(), value.get_yscale()}
    if value.name != "rectilinear" or value.figure is None or not scales <= {"linear", "log"}:
        raise InputError(f"{name} must be plain Axes of a figure, not {value.name} or another scale; give such")
    return value


def _read_figure(name: str, value: Any) -> Figure:
    if not isinstance(value, Figure):
        raise InputError(f"{name} = {shown(value)} is no Figure; give what plot.figure_of or Run.figure returns")
    return value


# Annotations, without None, and what reads them.
_READERS: dict[frozenset[Any], Callable[[str, Any], Any]] = {
    frozenset({Disk}): _read_disk,
    frozenset({Axes}): _read_axes,
    frozenset({Figure}): _read_figure,
    frozenset({Array}): column,
    frozenset({Sequence[float]}): _read_numbers,
    frozenset({Mapping[int, float]}): _read_numbered,
    frozenset({tuple[float, float]}): read_range,
    frozenset({bool}): flag,
    frozenset({int}): _read_whole,
    frozenset({float}): _read_number,
    frozenset({Path, str}): path_of,
}
