"""Readers of arrays and ranges: what users give as coordinates, constants of motion or times.

Arrays of real numbers are read, also those of pandas. Integers are rounded to the nearest double; a long double
must be one. What is masked, None or NA becomes NaN, which is a sample with the status bad_input. Text, bool, dates
and complex numbers are refused. What was given is never changed.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import wraps
from itertools import islice
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer.errors import (
    SHOWN,
    InputError,
    RunError,
    double_of,
    number,
    plain_number,
    reader,
    shorten,
    shown,
    suggest,
    text_of,
)

Array = NDArray[np.float64]
F = TypeVar("F", bound=Callable[..., Any])
K = TypeVar("K")
# What numpy reads by itself and to an end, and what says that it is an array.
_OWN = frozenset((bool, int, float, complex, str, bytes, type(None), range, memoryview, np.ndarray, np.float64))
_BOOLS = frozenset((bool, np.bool_))
# In a sequence it takes a bool for 1, and what an array hides for a number.
_OWN_INSIDE = _OWN - {bool, np.ndarray}
_ARRAYS = ("__array__", "__array_interface__", "__array_struct__")
_LONGEST = 10**7  # entries of a sequence that is none of Python's
_DEEPEST = 64  # lists in lists: numpy has no more axes
_MOST_AXES = 32  # of an array: more than these numpy makes, but does not broadcast
_LARGEST_TABLE = 10**9  # entries to which arguments may broadcast: 8 GB for each column


def columns_of(**named: ArrayLike) -> list[Array]:
    """The arguments as new flat columns of one length. InputError names what is not a number or does not fit."""
    return read_columns(named)[0]


def read_columns(named: dict[str, ArrayLike]) -> tuple[list[Array], tuple[int, ...]]:
    """Read arrays of numbers that belong together.

    Parameters
    ----------
    named : dict of str to array_like
        Arguments by name, as this module describes them.

    Returns
    -------
    list of (n,) arrays, and tuple of int
        New flat columns of one length, and the shape to which the arguments broadcast; plain numbers count as
        arrays of one entry.

    Raises
    ------
    InputError
        Where one is no array of real numbers, or they do not broadcast.
    """
    arrays = [column(name, value) for name, value in named.items()]
    try:
        shape = np.broadcast_shapes(*(array.shape for array in arrays)) or (1,)
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in zip(named, arrays, strict=True))
        raise InputError(f"shapes do not fit together: {shapes}; give arrays that broadcast") from None
    if math.prod(shape) > _LARGEST_TABLE:
        raise InputError(f"{', '.join(named)} broadcast to {shape}; give up to {_LARGEST_TABLE:,} entries at once")
    return [_column_of(array, shape) for array in arrays], shape


def _column_of(values: Array, shape: tuple[int, ...]) -> Array:
    """A new flat column of values that broadcast to a shape, copied once."""
    new = np.empty(shape)
    new[...] = values
    return new.ravel()


@reader
def column(name: str, value: Any) -> Array:
    """Read one array of real numbers, as this module describes it. Raises InputError."""
    if isinstance(value, np.ndarray) and value.dtype == np.float64 and type(value) is np.ndarray:
        _check_axes(name, value)
        return value
    try:
        given = np.asarray(plain_array(value))
    except Exception:  # ragged lists, and objects with an own way to fail
        raise InputError(
            f"{name} = {shown(value)} is not an array of real numbers; give one of one shape"
        ) from None
    _check_axes(name, given)
    read = _real(given)
    if read is None:
        kind = "" if given.dtype.kind == "O" and given.ndim == 0 else f" but of {given.dtype}"
        remedy = "give numbers, not text" if given.dtype.kind in "US" else "give numbers in doubles"
        kind = "" if given.dtype.kind in "US" else kind
        raise InputError(f"{name} = {shown(value)} is not an array of real numbers{kind}; {remedy}")
    return read


def _check_axes(name: str, given: NDArray[Any]) -> None:
    if given.ndim > _MOST_AXES:
        raise InputError(f"{name} is an array of {given.ndim} axes; give one of {_MOST_AXES} at most")


def plain_array(value: Any, depth: int = 0) -> Any:
    """What numpy reads as what it is: sequences as lists, masked arrays as others; the rest as it is given.

    Sequences of foreign kinds get the length that they say they have: numpy asks some without end. Bools among
    numbers stay bools, in an array of objects.
    """
    if isinstance(value, list | tuple):
        kinds = set(map(type, value))
        if depth >= _DEEPEST or kinds <= _OWN_INSIDE or kinds <= _BOOLS:
            return value
        entries = [plain_array(each, depth + 1) for each in value]
        return np.asarray(entries, dtype=object) if kinds & _BOOLS else entries
    if isinstance(value, np.ma.MaskedArray):
        value = _unmasked(value)
    if depth and isinstance(value, np.ndarray) and value.dtype.kind == "b":
        return value.astype(object)
    known = type(value) in _OWN or isinstance(value, Mapping) or any(hasattr(value, name) for name in _ARRAYS)
    if known or not hasattr(value, "__getitem__"):
        return value
    return list(islice(value, min(len(value), _LONGEST)))


def _unmasked(array: np.ma.MaskedArray[Any, Any]) -> Any:
    """A masked array as another: what it hides is NaN among numbers, NaT among dates, None among other objects."""
    given, mask = np.asarray(array), np.ma.getmaskarray(array)
    if given.dtype.kind == "c" or not mask.any():
        return given
    if given.dtype.kind in "iuf":
        return np.where(mask, np.nan, given)
    dates = given.dtype.kind in "mM"
    cells = given.astype(given.dtype if dates else object)
    cells[mask] = "NaT" if dates else None
    return cells[()]


def _real(given: NDArray[Any]) -> Array | None:
    """An array as doubles; None where its entries are no real numbers, or would be cut."""
    if given.dtype.kind == "O":
        entries = [math.nan if _missing(entry) else entry_of(entry) for entry in given.ravel().tolist()]
        if None in entries:
            return None
        return np.array(entries, dtype=np.float64).reshape(given.shape)
    if given.dtype.kind not in "iuf":
        return None
    with np.errstate(all="ignore"):
        read = given.astype(np.float64)
        cut = given.dtype.itemsize > 8 and not np.all((read == given) | np.isnan(given))
    return None if cut else read


def entry_of(value: Any) -> float | None:
    """An entry of an array of objects; text is none, and nor is an integer beyond doubles."""
    if type(value) is float:  # as almost all are, and warnings need not be silenced
        return value
    plain = None if isinstance(value, str) else plain_number(value)
    read = double_of(plain)
    beyond = read is not None and math.isinf(read) and not isinstance(plain, float)
    return None if beyond else read


def _missing(value: Any) -> bool:
    """Whether an entry says that there is no value: None, or NA of pandas."""
    return value is None or type(value).__name__ in ("NAType", "NaTType", "MaskedConstant")


@reader
def read_range(name: str, value: Any, unbounded: bool = False) -> tuple[float, float]:
    """Read (low, high) with low <= high.

    Parameters
    ----------
    name : str
        As for `number`.
    value : str or pair of numbers
        "LOW:HIGH", or one number as text for a range of one point, or a pair of numbers.
    unbounded : bool
        Whether an end may be left out, as in "LOW:", ":HIGH" or a pair with None, and is then infinite.

    Raises
    ------
    InputError
        Where `value` is no range, or the range is empty.
    """
    form = "LOW:HIGH, LOW: or :HIGH" if unbounded else "LOW:HIGH"
    text = text_of(value)
    ends = value if text is None else text.split(":")
    if text is not None and len(ends) == 1:
        ends *= 2
    if not isinstance(ends, list | tuple) or len(ends) != 2:
        raise InputError(f"{name} {shown(value)} is not a range; give {form}")
    try:
        low, high = (
            bound if unbounded and (end is None or text_of(end) == "" or end == bound) else number(name, end)
            for end, bound in zip(ends, (-math.inf, math.inf), strict=True)
        )
    except (InputError, ArithmeticError):  # a NaN of Decimal that signals
        raise InputError(f"{name} {shown(value)} is not a range; give {form} with finite numbers") from None
    if low > high:
        raise InputError(f"{name} {low:g}:{high:g} is empty; give {form}, the smaller number first")
    return low, high


@contextmanager
def users_own(name: str, remedy: str) -> Iterator[None]:
    """Say as InputError what goes wrong in a function of the user's, or in what it returned."""
    try:
        yield
    except RunError:
        raise
    except Exception as error:
        try:
            why = shorten(str(error), 150)
        except Exception:  # an exception whose text raises
            why = ""
        raise InputError(f"{name}: {shorten(type(error).__name__, SHOWN)}: {why}; {remedy}") from error


def returned_numbers(value: Any) -> NDArray[Any]:
    """What a function of the user's returned, as an array of real numbers or bools that keeps its type.

    Long doubles are rounded to doubles. Raises TypeError for masked entries, which would show what they hide, for
    long doubles beyond doubles, and for complex numbers, dates, text and other objects.
    """
    if isinstance(value, np.ma.MaskedArray) and np.ma.getmaskarray(value).any():
        raise TypeError("it returned masked entries")
    given = np.asarray(value)
    if given.dtype.kind not in "fiub":
        raise TypeError(f"it returned {given.dtype}")
    if given.dtype.kind != "f" or given.dtype.itemsize <= 8:
        return given
    with np.errstate(all="ignore"):
        read = given.astype(np.float64)
    if np.any(np.isinf(read) & np.isfinite(given)):
        raise TypeError(f"it returned {given.dtype} beyond doubles")
    return read


def known_keywords(what: str, given: Iterable[str], known: Collection[str]) -> None:
    """Raise InputError, with the nearest one, for a keyword that `what` does not take."""
    for name in given:
        if name not in known:
            raise InputError(f"{what}: takes no {name!r}; {suggest(name, known)}")


def keywords_of(what: str, given: Mapping[str, Any], kind: Callable[..., K], known: Collection[str]) -> K:
    """Keywords as the NamedTuple that has them, with its defaults. Raises InputError for one that is not known."""
    known_keywords(what, given, known)
    return kind(**given)


def explained(function: F) -> F:
    """Let a function say as InputError, with its arguments, that it was called with others."""
    signature = inspect.signature(function)
    names = [name for name in signature.parameters if name not in ("self", "cls")]
    name = function.__qualname__.removesuffix(".__init__")

    @wraps(function)
    def call(*given: Any, **named: Any) -> Any:
        known_keywords(name, named, names)
        try:
            signature.bind(*given, **named)
        except TypeError as error:
            raise InputError(f"{name}: {error}; it takes {', '.join(names)}") from None
        return function(*given, **named)

    return cast(F, call)
