"""What users are told, and the readers of what users write.

Every message names the argument, the value and the remedy. It is written in the words of the command line and says
the same in the words of Python, unless the command line is at work. A reader takes a value as it comes from the
command line, a TOML file or Python, and returns it with its proper type; what cannot be used raises InputError.
Text is read as a number, a number of numpy like one of Python, and a bool never counts as a number.
"""

import contextlib
import math
import re
import sys
import tomllib
from collections.abc import Collection, Iterator
from difflib import get_close_matches
from numbers import Integral
from pathlib import Path
from typing import Any

# How a remedy of the command line is written in Python, the longest first.
_PYTHON = (
    (r"nearflat (resume|verify) ([^\s;,)`]+)", r'ex.open("\2").\1()'),
    (r"nearflat summary ([^\s;,)`]+)", r'ex.open("\1").summary'),
    (r"--resume\b", 'exist="resume"'),
    (r"--replace\b", 'exist="replace"'),
    (r"--no-figures\b", "figures=False"),
    (r"(?<![\w/-])--([a-z][a-z0-9]*(?:-[a-z0-9]+)*)", lambda found: found[1].replace("-", "_")),
)
_speaks_python = True


@contextlib.contextmanager
def words_of_the_command() -> Iterator[None]:
    """Within this, messages name flags and commands, as those who type them know them."""
    global _speaks_python
    before, _speaks_python = _speaks_python, False
    try:
        yield
    finally:
        _speaks_python = before


def in_words(message: str) -> str:
    """A message as its reader would write it: "--eta-hat" of the command line is eta_hat in Python."""
    if _speaks_python:
        for written, python in _PYTHON:
            message = re.sub(written, python, message)
    return message


class _Told:
    """An exception whose message speaks the words of its reader; where it was raised does not matter."""

    def __str__(self) -> str:
        return in_words(super().__str__())


class InputError(_Told, ValueError):
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


class RunError(_Told, RuntimeError):
    """A run failed or a check did not hold. The command line exits with status 1.

    Examples
    --------
    >>> import explorer as ex
    >>> issubclass(ex.Interrupted, ex.RunError)
    True
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
        print(in_words(text), file=sys.stderr, flush=True)


def said(name: str, value: Any) -> str:
    """An argument with its value as the user wrote it: "--samples 0" or "samples = 0"."""
    name = in_words(name)
    if name.startswith("--"):
        return f"{name} {value}"
    return f"{name} = {value if isinstance(value, str) else repr(value)}"


def number(name: str, value: Any, low: float = -math.inf, high: float = math.inf) -> float:
    """Read a finite number.

    Parameters
    ----------
    name : str
        What the argument is called where the user wrote it, such as "--accuracy" or "t_end".
    value : number or str
        What the user gave; text as in "1e-6".
    low, high : float
        The smallest and the largest number that is accepted.

    Raises
    ------
    InputError
        Where `value` is no finite number from `low` to `high`. The message names all three.
    """
    try:
        plain = value.item() if hasattr(value, "item") else value  # a scalar of numpy, or an array of one element
        read = math.nan if isinstance(plain, bool) else float(plain)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{said(name, value)} is not a number; give {_numbers(low, high)}") from None
    if not (math.isfinite(read) and low <= read <= high):
        raise InputError(f"{said(name, value)} must be {_numbers(low, high)}")
    return read


def positive(name: str, value: Any) -> float:
    """Read a finite number above 0. Raises InputError."""
    read = number(name, value)
    if read <= 0.0:
        raise InputError(f"{said(name, value)} must be a finite number above 0")
    return read


def whole(name: str, value: Any, low: int = 0, high: int | None = None) -> int:
    """Read a whole number from `low` to `high`, written in any way: 1000000, "1000000", 1e6, "1e6".

    Raises
    ------
    InputError
        Where `value` is not such a number. The message names `value`, `low` and `high`.
    """
    if not isinstance(value, bool) and isinstance(value, Integral):
        read = int(value)
    elif isinstance(value, str) and value.strip().lstrip("+-").isdigit():
        read = int(value)  # exact, also beyond the whole numbers that doubles hold
    else:
        given = number(name, value)
        read = int(given)
        if read != given:
            raise InputError(f"{said(name, value)} must be a whole number{_between(low, high)}")
    if read < low or (high is not None and read > high):
        raise InputError(f"{said(name, value)} must be a whole number{_between(low, high)}")
    return read


def sign(name: str, value: Any) -> int:
    """Read +1 or -1, a face or a side, written as any number is. Raises InputError."""
    read = number(name, value)
    if read not in (1.0, -1.0):
        raise InputError(f"{said(name, value)} must be 1 or -1")
    return int(read)


def flag(name: str, value: Any) -> bool:
    """Read True or False. Raises InputError."""
    if not isinstance(value, bool):
        raise InputError(f"{said(name, value)} must be true or false")
    return value


def one_of(name: str, value: Any, known: Collection[str]) -> str:
    """Read one of the words `known`. Raises InputError with the nearest of them."""
    if not isinstance(value, str) or value not in known:
        raise InputError(f"{name} {value!r} is not known; {suggest(value, known)}")
    return value


def suggest(value: Any, known: Collection[str]) -> str:
    """The end of a message about an unknown word: the word that was probably meant, and all that are known."""
    near = get_close_matches(str(value), known, n=1)
    return (f"did you mean {near[0]!r}? " if near else "") + f"known: {', '.join(known)}"


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
    ends = value.split(":") if isinstance(value, str) else value
    if isinstance(value, str) and len(ends) == 1:
        ends *= 2
    if not isinstance(ends, list | tuple) or len(ends) != 2:
        raise InputError(f"{name} {value!r} is not a range; give {form}")
    try:
        low, high = (
            bound if unbounded and (end is None or end in ("", bound)) else number(name, end)
            for end, bound in zip(ends, (-math.inf, math.inf), strict=True)
        )
    except InputError:
        raise InputError(f"{name} {value!r} is not a range; give {form} with finite numbers") from None
    if low > high:
        raise InputError(f"{name} {low:g}:{high:g} is empty; give {form}, the smaller number first")
    return low, high


def read_toml(path: Path, option: str) -> dict[str, Any]:
    """The content of a TOML file. Raises InputError naming the option and the file."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{option} {path}: cannot be read ({error.strerror})") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{option} {path}: not valid TOML ({error})") from None


def _numbers(low: float, high: float) -> str:
    return "a finite number" + _between(low, high)


def _between(low: float, high: float | None) -> str:
    """The end of a sentence about a number that must lie between two others."""
    above, below = low > -math.inf, high is not None and high < math.inf
    if above and below:
        return f" from {low:g} to {high:g}"
    return f", {low:g} or more" if above else f", {high:g} or less" if below else ""
