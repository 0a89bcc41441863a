"""What a picture is drawn from: a result of another kind is refused before anything is drawn.

The annotation of the first argument says the kind, and its entry in the docstring where it comes from.
"""

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from types import UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from explorer.errors import InputError
from explorer.phase.disk import Disk


def require_drawable(draw: Callable[..., Any], value: Any) -> None:
    """Raise InputError where `value` is no first argument of the picture `draw`."""
    name, kinds = _first(draw)
    if kinds and not any(_is(value, kind) for kind in kinds):
        what = _described(inspect.getdoc(draw) or "", name) or "a result of the kind that it draws"
        raise InputError(f"{draw.__name__}: {name} must be {what}; a {type(value).__name__} was given")


@cache
def _first(draw: Callable[..., Any]) -> tuple[str, tuple[Any, ...]]:
    """The name of the first argument, and its kinds; none where it is something else than results."""
    name = next(iter(inspect.signature(draw).parameters))
    kind = get_type_hints(draw).get(name, Any)
    kinds = get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)
    return name, kinds if all(map(_can_tell, kinds)) else ()


def _can_tell(kind: Any) -> bool:
    """Whether a kind is a result, or holds some. A disk and plain numbers have readers of their own."""
    if get_origin(kind) in (Mapping, dict, Sequence):
        return True
    return inspect.isclass(kind) and kind is not Disk and kind.__module__.startswith("explorer.")


def _is(value: Any, kind: Any) -> bool:
    origin = get_origin(kind)
    if origin is None:
        return isinstance(value, kind)
    if origin is not Sequence:
        return isinstance(value, Mapping)
    if not isinstance(value, Iterable) or isinstance(value, Mapping | str):
        return False
    (each,) = get_args(kind)
    # What can be read once only, as a generator, is left to the picture.
    return each is Any or not isinstance(value, Sequence) or all(_is(entry, each) for entry in value)


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
