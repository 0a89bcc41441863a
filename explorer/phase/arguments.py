"""Readers of arrays and ranges: what users give as coordinates, constants of motion or times.

Whatever numpy makes an array of real numbers of is read, and rounded to doubles. What is masked, None or NA, as in
tables of users, becomes NaN, which is a sample with the status bad_input. Text, bool, dates and complex numbers
are refused. What was given is never changed.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer.errors import InputError, double_of, number, shown

Array = NDArray[np.float64]
_LARGEST_TABLE = 10**9  # entries to which arguments may broadcast: 8 GB for each column


def read_columns(**named: ArrayLike) -> tuple[list[Array], tuple[int, ...]]:
    """Read arrays of numbers that belong together.

    Parameters
    ----------
    **named : array_like
        Arguments by name, as this module describes them.

    Returns
    -------
    list of (n,) arrays, and tuple of int
        New flat columns of one length, and the shape to which the arguments broadcast; () for plain numbers, of
        which columns have one entry.

    Raises
    ------
    InputError
        If one is no array of real numbers, or they do not broadcast.
    """
    arrays = [column(name, value) for name, value in named.items()]
    try:
        shape = np.broadcast_shapes(*(array.shape for array in arrays))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in zip(named, arrays, strict=True))
        raise InputError(f"shapes do not fit together: {shapes}; give arrays that broadcast") from None
    if math.prod(shape) > _LARGEST_TABLE:
        raise InputError(f"{', '.join(named)} broadcast to {shape}; give up to {_LARGEST_TABLE:,} entries at once")
    return [np.array(np.broadcast_to(array, shape), order="C").ravel() for array in arrays], shape


def column(name: str, value: Any) -> Array:
    """Read one array of real numbers, as this module describes it. Raises InputError."""
    try:
        given = plain_array(value)
    except ValueError:  # of lists of several lengths
        raise InputError(
            f"{name} = {shown(value)} is not an array of real numbers; give one of one shape"
        ) from None
    if given.dtype.kind in "iuf":
        return given.astype(np.float64, copy=False)
    entries = [entry_of(entry) for entry in given.ravel().tolist()] if given.dtype.kind == "O" else [None]
    if None in entries:
        remedy = "give numbers, not text" if given.dtype.kind in "US" else "give numbers"
        raise InputError(f"{name} = {shown(value)} is not an array of real numbers; {remedy}")
    return np.array(entries, dtype=np.float64).reshape(given.shape)


def plain_array(value: Any) -> NDArray[Any]:
    """What numpy makes of a value; what a masked array hides is NaN among numbers, None among other objects."""
    if not isinstance(value, np.ma.MaskedArray) or not np.ma.getmaskarray(value).any():
        return np.asarray(value)
    missing: Any = np.nan if value.dtype.kind in "iuf" else None
    return np.where(value.mask, missing, value.data)


def entry_of(value: Any) -> float | None:
    """An entry of an array of objects: NaN where it says that there is no value, None where it is no number."""
    if value is None or type(value).__name__ in ("NAType", "NaTType", "MaskedConstant"):
        return math.nan
    return None if isinstance(value, str) else double_of(value)


def read_pair(name: str, value: Any, form: str, unbounded: bool = False) -> tuple[float, float]:
    """Read two finite numbers, "FIRST:SECOND" or a pair. Raises InputError, which asks for `form`.

    unbounded: whether one may be left out, as in "FIRST:", ":SECOND" or a pair with None, and is then infinite.
    """
    ends = value.split(":") if isinstance(value, str) else value
    try:
        first, second = (
            bound if unbounded and (end is None or end in ("", bound)) else number(name, end)
            for end, bound in zip(ends, (-math.inf, math.inf), strict=True)
        )
    except (TypeError, ValueError):  # what is no pair, or not of finite numbers
        raise InputError(f"{name} = {shown(value)} is not {form}, with finite numbers") from None
    return first, second


def read_range(name: str, value: Any, unbounded: bool = False) -> tuple[float, float]:
    """Read (low, high) with low <= high.

    Parameters
    ----------
    name : str
        As for `number`.
    value : str, number or pair of numbers
        "LOW:HIGH" or a pair of numbers, or one number for a range of one point.
    unbounded : bool
        Whether an end may be left out, as in "LOW:", ":HIGH" or a pair with None, and is then infinite.

    Raises
    ------
    InputError
        If `value` is no range, or the range is empty.
    """
    if double_of(value) is not None:
        value = (value, value)
    form = "a number or a range LOW:HIGH" + (", LOW: or :HIGH" if unbounded else "")
    low, high = read_pair(name, value, form, unbounded)
    if low > high:
        raise InputError(f"{name} = {low:g}:{high:g} is empty; give LOW:HIGH, the smaller number first")
    return low, high


def returned_numbers(name: str, value: Any) -> NDArray[Any]:
    """What a function of the user's returned: an array of real numbers, doubles at most, or of bools.

    name: what the function is called. What is masked is NaN. Raises InputError for text and complex numbers.
    """
    given = plain_array(value)
    if given.dtype.kind not in "fiub":
        raise InputError(f"{name}: the function returned {shown(value)}; let it return real numbers")
    return given.astype(np.float64) if given.dtype.kind == "f" and given.itemsize > 8 else given
