"""What users are told, and the readers of what users write.

Every message names the argument, the value and the remedy. An option is called by its name in Python, eta_hat of
--eta-hat. Public functions, the command line and files
from users have their arguments read here: a reader returns the value with its proper type, raises InputError for
what a person may have mistyped, and never changes what it was given. What an object of another package raises when
it is read passes through as it is.

Numbers are those of Python and numpy, and text; never a bool or a complex number. Readers of arrays and ranges, of
states and of disks, which need numpy, are in `phase.arguments`, `phase.states` and `phase.disk`, those of files in
`paths`.
"""

import math
import re
import sys
import warnings
from collections.abc import Collection, Iterable
from decimal import Decimal
from difflib import get_close_matches
from numbers import Integral, Real
from typing import Any

MOST_JOBS = 1024  # threads or processes: more only take memory
SHOWN = 60  # characters of a value in it
_ELSEWHERE = {"rk45": "dopri5", "ode45": "dopri5"}  # what other programs call a word that is known here
_THOUSANDS = {"k": "e3", "K": "e3", "M": "e6"}  # 10k
_SPELT = str.maketrans({"\N{MINUS SIGN}": "-", "d": "e", "D": "e"})  # 1.0D+01, as Fortran writes numbers
_WHOLE = re.compile(r"[+-]?\d{1,400}", re.ASCII)  # Python refuses to read very long ones


class InputError(ValueError):
    """An argument cannot be used. The command line exits with status 2.

    Examples
    --------
    >>> import explorer as ex
    >>> try:
    ...     ex.Disk.parse("unifrom")
    ... except ex.InputError as error:
    ...     print(str(error)[:26])
    disk 'unifrom' is not know
    """


class RunError(RuntimeError):
    """A run failed or a check did not hold. The command line exits with status 1.

    Examples
    --------
    >>> import explorer as ex
    >>> issubclass(ex.Interrupted, ex.RunError)
    True
    """


class CoarseTimesWarning(UserWarning):
    """The times are too far apart to draw a curve: the contact point turns a long way between two of them.

    Examples
    --------
    >>> import warnings, explorer as ex
    >>> states = ex.constants_to_states(ex.Disk.uniform(), 1.0, 1e-6, 1.0)
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     motion = ex.simulate(states, t_eval=[1.0, 2.0])
    >>> [warning.category.__name__ for warning in caught]
    ['CoarseTimesWarning']
    """


class Interrupted(RunError):
    """The user or the system stopped a run between two chunks. The command line exits with status 130.

    Examples
    --------
    >>> import explorer as ex
    >>> try:
    ...     raise ex.Interrupted("stopped between two chunks")
    ... except ex.RunError as error:
    ...     print(error)
    stopped between two chunks
    """


def note(text: str, quiet: bool) -> None:
    """Print a line on stderr, unless the user asked for quiet."""
    if not quiet:
        print(printable(text), file=sys.stderr, flush=True)


def printable(text: str) -> str:
    """The text with characters escaped that would move a terminal's cursor or turn the direction of writing."""
    return "".join(c if c.isprintable() or c in "\n\t" else ascii(c)[1:-1] for c in text)


def warn(message: str, kind: type[Warning] = UserWarning) -> None:
    """Warn at the line that called nearflat, however many of our functions lie between."""
    level, frame = 1, sys._getframe()
    while frame.f_back and frame.f_globals.get("__name__", "").partition(".")[0] == "explorer":
        level, frame = level + 1, frame.f_back
    warnings.warn(message, kind, stacklevel=level)


def shorten(text: str, most: int) -> str:
    """The text, without its middle where it is longer than `most`."""
    return text if len(text) <= most else f"{text[: most - 3 - most // 2]}...{text[-(most // 2) :]}"


def shown(value: Any) -> str:
    """A value as an error shows it: what it is where it is long, never more than a line."""
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple) and shape:
        return f"{type(value).__name__} of shape {shape} {getattr(value, 'dtype', '')}".rstrip()
    if isinstance(value, list | tuple | dict | set | bytes) and len(value) > SHOWN:
        return f"{type(value).__name__} of {len(value)}"
    return shorten(" ".join(repr(value).split()), SHOWN)


def said(name: str, value: Any) -> str:
    """An argument with its value as the user wrote it."""
    return f"{name} = {shorten(value, SHOWN) if type(value) is str else shown(value)}"


def number(name: str, value: Any, low: float = -math.inf, high: float = math.inf) -> float:
    """Read a finite number.

    Parameters
    ----------
    name : str
        What the argument is called where the user wrote it, such as "accuracy" or "t_end".
    value : number or str
        What the user gave; text as in "1e-6".
    low, high : float
        The smallest and the largest number that is accepted.

    Raises
    ------
    InputError
        If `value` is no finite number from `low` to `high`. The message names all three.
    """
    read = double_of(value)
    if read is None:
        raise InputError(f"{said(name, value)} is not a number; {_of_commas(value)}give {_numbers(low, high)}")
    if not (math.isfinite(read) and low <= read <= high):
        raise InputError(f"{said(name, value)} must be {_numbers(low, high)}")
    return read


def plain_number(value: Any) -> Any:
    """A scalar of numpy, or an array of one entry, as a number of Python; None where it is masked."""
    if not hasattr(value, "item") or getattr(value, "size", 1) != 1:
        return value
    masked = hasattr(value, "filled") and bool(value.mask)
    return None if masked else value.item()


def double_of(value: Any) -> float | None:
    """A number, or text that is one, as a double, infinite beyond them; None where it is no real number."""
    if isinstance(value, str):
        text = value.rstrip().translate(_SPELT)
        try:
            return float(text[:-1] + _THOUSANDS[text[-1]] if text[-1:] in _THOUSANDS else text)
        except ValueError:
            return None
    plain = plain_number(value)
    if isinstance(plain, bool) or not isinstance(plain, Real | Decimal):
        return None
    try:
        return float(plain)
    except OverflowError:  # an integer or a fraction
        return math.inf


def positive(name: str, value: Any, high: float = math.inf) -> float:
    """Read a finite number above 0, `high` at most. Raises InputError."""
    read = number(name, value)
    if not 0.0 < read <= high:
        raise InputError(f"{said(name, value)} must be a finite number above 0{_between(-math.inf, high)}")
    return read


def whole(name: str, value: Any, low: int = 0, high: int | None = None) -> int:
    """Read a whole number from `low` to `high`, written in any way: 1000000, "1000000", 1e6, "1e6".

    Raises
    ------
    InputError
        If `value` is not such a number. The message names `value`, `low` and `high`.
    """
    plain = plain_number(value)
    if isinstance(plain, str) and _WHOLE.fullmatch(plain.strip()):
        plain = int(plain)  # exact, also beyond the whole numbers that doubles hold
    if not isinstance(plain, bool) and isinstance(plain, Integral):
        read = int(plain)
    else:
        plain = number(name, value)
        read = int(plain)
    if read != plain or read < low or (high is not None and read > high):
        raise InputError(f"{said(name, value)} must be a whole number{_between(low, high)}")
    return read


def sign(name: str, value: Any) -> int:
    """Read +1 or -1, a face or a side, written as any number is. Raises InputError."""
    read = double_of(value)
    if read not in (1.0, -1.0):
        raise InputError(f"{said(name, value)} must be +1 or -1")
    return int(read)


def jobs_of(name: str, value: Any) -> int:
    """Read a number of workers. Raises InputError."""
    return whole(name, value, 1, MOST_JOBS)


def flag(name: str, value: Any) -> bool:
    """Read True or False. Raises InputError."""
    if not isinstance(value, bool) and type(value).__name__ != "bool":  # numpy has one of its own
        raise InputError(f"{said(name, value)} must be true or false")
    return bool(value)


def one_of(name: str, value: Any, known: Collection[str]) -> str:
    """Read one of the words `known`. Raises InputError with the nearest of them."""
    if not isinstance(value, str) or value not in known:
        raise InputError(f"{name} {shown(value)} is not known; {suggest(value, known)}")
    return str(value)


def words(name: str, value: Any) -> tuple[str, ...]:
    """Read a sequence of words. Raises InputError."""
    alone = isinstance(value, str) or not isinstance(value, Iterable) or getattr(value, "shape", None) == ()
    read = (None,) if alone else tuple(value)
    if not all(isinstance(each, str) for each in read):
        raise InputError(f"{name} = {shown(value)}: give a list of words")
    return tuple(map(str, read))


def word(name: str, value: Any) -> str:
    """Read a name that may stand in the name of a file: up to 80 printable characters. Raises InputError."""
    good = isinstance(value, str) and 0 < len(value) <= 80 and not value.startswith(".") and value == value.strip()
    if not good or not value.isprintable() or set(value) & set('/\\:*?"<>|'):
        raise InputError(
            f"{said(name, value)} cannot be part of a file's name; give up to 80 printable characters, none of "
            '/ \\ : * ? " < > |, without a dot or spaces at the ends'
        )
    return str(value)


def suggest(value: Any, known: Collection[str]) -> str:
    """The end of a message about an unknown word: the word that was probably meant, and all that are known."""
    near = nearest(value, known)
    return (f"did you mean {near!r}? " if near else "") + f"known: {shorten(', '.join(known), 160)}"


def nearest(value: Any, known: Collection[str]) -> str:
    """The word that was probably meant; empty where none is near."""
    if isinstance(value, str):
        lower = value.lower()
        value = next((name for name in known if name.lower() == _ELSEWHERE.get(lower, lower)), value)
    near = get_close_matches(value, known, n=1) if isinstance(value, str) else []
    if isinstance(value, str) and len(value.strip("-")) > 2 and not get_close_matches(value, near, 1, 0.8):
        # The beginning of a name says more than a few of its letters do.
        near = sorted((name for name in known if name.startswith(value)), key=len)[:1] or near
    return near[0] if near else ""


def _of_commas(value: Any) -> str:
    """What a message says of 1,000 or 0,5."""
    if not isinstance(value, str) or "," not in value:
        return ""
    thousands = re.fullmatch(r"[+-]?\d{1,3}(,\d{3})+", value.strip())
    return f"commas are not read{', write ' + value.replace(',', '') if thousands else ''}; "


def _numbers(low: float, high: float) -> str:
    return "a finite number" + _between(low, high)


def _between(low: float, high: float | None) -> str:
    """The end of a sentence about a number that must lie between two others."""
    above, below = low > -math.inf, high is not None and high < math.inf
    if above and below:
        return f" from {low:g} to {high:g}"
    return f", {low:g} or more" if above else f", {high:g} or less" if below else ""
