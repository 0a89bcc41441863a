"""What users are told, and the readers of what users write.

Every message names the argument, the value and the remedy, in at most 300 characters. It is written in the words
of the command line and says the same in the words of Python, unless the command line is at work. Public functions,
the command line and files from users have their arguments read here: a reader returns the value with its proper
type, raises InputError for what it cannot use, and never changes what it was given.

Numbers are those of Python and numpy, and text in plain digits; never a bool, bytes, a date or a complex number.
Readers of arrays, states and disks, which need numpy, are in `phase.arguments`, `phase.states` and `phase.disk`.
"""

import contextlib
import math
import os
import re
import stat
import sys
import tomllib
import warnings
from collections.abc import Collection, Iterable, Iterator
from decimal import Decimal
from difflib import get_close_matches
from itertools import islice
from numbers import Integral, Real
from pathlib import Path
from typing import Any

MOST_JOBS = 1024  # threads or processes: more only take memory
MOST_WORDS = 1000
_LONGEST = 300  # characters of a message
_SHOWN = 60  # characters of a value in it
_LARGEST_TOML = 1 << 20  # bytes
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(inf|infinity|nan)", re.ASCII | re.IGNORECASE)
_WHOLE = re.compile(r"[+-]?\d{1,400}", re.ASCII)
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

    Its message has at most 300 characters; of a longer one the middle is left out.

    Examples
    --------
    >>> import explorer as ex
    >>> try:
    ...     ex.Disk.parse("unifrom")
    ... except ex.InputError as error:
    ...     print(str(error)[:26])
    disk 'unifrom' is not know
    """

    def __str__(self) -> str:
        return shorten(super().__str__(), _LONGEST)


class RunError(_Told, RuntimeError):
    """A run failed or a check did not hold. The command line exits with status 1.

    Examples
    --------
    >>> import explorer as ex
    >>> issubclass(ex.Interrupted, ex.RunError)
    True
    """


class CoarseTimesWarning(UserWarning):
    """The times asked for are too far apart for a curve: the contact point turns a long way between two of them.

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
        print(in_words(text), file=sys.stderr, flush=True)


def shorten(text: str, most: int) -> str:
    """The text, without its middle where it is longer than `most`; nothing in it acts on a terminal."""
    plain = "".join(c if c.isprintable() or c == "\n" else repr(c)[1:-1] for c in text[: 20 * most])
    if len(text) <= 20 * most and len(plain) <= most:
        return plain
    end = text[-most // 2 :] if len(text) > 20 * most else plain[-most // 2 :]
    end = "".join(c if c.isprintable() else " " for c in end)
    return f"{plain[: most - 3 - len(end)]}...{end}"


def shown(value: Any) -> str:
    """A value as an error shows it: what it is where it is long, never more than a line."""
    try:
        if getattr(value, "ndim", 0) and isinstance(getattr(value, "shape", None), tuple):  # no module or class
            return f"{type(value).__name__} of shape {value.shape} {getattr(value, 'dtype', '')}".rstrip()
        if isinstance(value, list | tuple | dict | set | bytes | bytearray) and len(value) > _SHOWN:
            return f"{type(value).__name__} of {len(value)}"
        if isinstance(value, int) and abs(value) >= 10**_SHOWN:
            return f"an integer of some {int(value.bit_length() * math.log10(2.0)) + 1} digits"
        return shorten(" ".join(repr(value).split()), _SHOWN)
    except Exception:  # whatever a foreign object does when it is asked for its text
        return f"an object of type {type(value).__name__}"


def said(name: str, value: Any) -> str:
    """An argument with its value as the user wrote it: "--samples 0", "samples = 0" or "--disk: m = 0"."""
    name = in_words(name)
    text = shorten(value, _SHOWN) if isinstance(value, str) else shown(value)
    bare = name.startswith("--") and ":" not in name
    return f"{name} {text}" if bare else f"{name} = {text}"


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
    read = value if type(value) is float else double_of(plain_number(value))
    if read is None:
        raise InputError(f"{said(name, value)} is not a number; {_of_commas(value)}give {_numbers(low, high)}")
    if not (math.isfinite(read) and low <= read <= high):
        raise InputError(f"{said(name, value)} must be {_numbers(low, high)}")
    return read


def plain_number(value: Any) -> Any:
    """A scalar of numpy, or an array of one element, as a number of Python; a date as it is."""
    try:
        if getattr(getattr(value, "dtype", None), "kind", "f") in "mM" or getattr(value, "mask", False) is True:
            return None
        return value.item() if hasattr(value, "item") and not isinstance(value, type) else value
    except Exception:  # more than one element, a module, or a foreign object's own way to fail
        return None


def double_of(value: Any) -> float | None:
    """A number of Python as a double; None where it is no real number, or a long double that is no double."""
    if isinstance(value, str):
        return float(value) if len(value) < 1000 and _NUMBER.fullmatch(value.strip()) else None
    if isinstance(value, bool) or not isinstance(value, Real | Decimal):
        return None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # numpy's, where a long double exceeds doubles
            read = float(value)
    except (ValueError, ArithmeticError):
        return math.inf  # an integer or a fraction beyond doubles
    cut = type(value).__name__ == "longdouble" and read == read and read != value
    return None if cut else read


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
    plain = plain_number(value)
    if not isinstance(plain, bool) and isinstance(plain, Integral):
        read = int(plain)
    elif isinstance(plain, str) and _WHOLE.fullmatch(plain.strip()):
        read = int(plain)  # exact, also beyond the whole numbers that doubles hold
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
    read = double_of(plain_number(value))
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
    return value


def words(name: str, value: Any) -> tuple[str, ...]:
    """Read a sequence of words. Raises InputError."""
    if isinstance(value, str) or not isinstance(value, Iterable) or getattr(value, "ndim", 1) != 1:
        raise InputError(f"{name} = {shown(value)}: give a list of words")
    several = tuple(islice(value, MOST_WORDS + 1))
    if len(several) > MOST_WORDS or not all(isinstance(each, str) for each in several):
        raise InputError(f"{name} = {shown(value)}: give a list of at most {MOST_WORDS} words")
    return several


def word(name: str, value: Any) -> str:
    """Read a name that may stand in the name of a file: up to 80 printable characters. Raises InputError."""
    if not isinstance(value, str) or not 0 < len(value) <= 80 or value.startswith(".") or value != value.strip():
        raise InputError(f"{said(name, value)} is no name; give up to 80 letters, digits or signs")
    if not value.isprintable() or set(value) & set('/\\:*?"<>|'):
        raise InputError(
            f"{said(name, value)} is no name: it stands in names of files; leave out its special signs"
        )
    return value


def path_of(name: str, value: Any) -> Path:
    """Read a path: text or a Path that a file system could hold. Raises InputError."""
    if not isinstance(value, str | os.PathLike):
        raise InputError(f"{said(name, value)} is no path; give text or a Path")
    text = os.fspath(value)
    if not isinstance(text, str) or not text or "\0" in text:
        raise InputError(f"{said(name, value)} is no path; give text that is not empty and has no NUL")
    parts = Path(text).parts
    if len(text) > 4000 or any(len(part.encode(errors="replace")) > 255 for part in parts):
        raise InputError(f"{name} {shorten(text, _SHOWN)} is too long for a path; give a shorter one")
    return Path(text)


def regular_file(name: str, path: Path, largest: float = math.inf) -> Path:
    """Check that a path is a plain file of so many bytes at most, before it is opened. Raises InputError."""
    try:
        found = path.stat()
    except (OSError, ValueError) as error:
        fault = getattr(error, "strerror", None) or str(error)
        raise InputError(f"{name} {shorten(str(path), 120)}: cannot be read ({fault})") from None
    if not stat.S_ISREG(found.st_mode):
        raise InputError(f"{name} {shorten(str(path), 120)}: cannot be read (is no file of its own)")
    if found.st_size > largest:
        most = f"{largest:,.0f} is the most that is read"
        raise InputError(f"{name} {shorten(str(path), 120)}: has {found.st_size:,} bytes; {most}")
    return path


def suggest(value: Any, known: Collection[str]) -> str:
    """The end of a message about an unknown word: the word that was probably meant, and all that are known."""
    near = get_close_matches(value[:100], known, n=1) if isinstance(value, str) else []
    if isinstance(value, str) and len(value.strip("-")) > 2 and not get_close_matches(value[:100], near, 1, 0.8):
        # The beginning of a name says more than a few of its letters do.
        near = sorted((name for name in known if name.startswith(value)), key=len)[:1] or near
    return (f"did you mean {near[0]!r}? " if near else "") + f"known: {shorten(', '.join(known), 160)}"


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
        raise InputError(f"{name} {shown(value)} is not a range; give {form}")
    try:
        low, high = (
            bound if unbounded and (end is None or end in ("", bound)) else number(name, end)
            for end, bound in zip(ends, (-math.inf, math.inf), strict=True)
        )
    except (InputError, ArithmeticError):  # a NaN of Decimal that signals
        raise InputError(f"{name} {shown(value)} is not a range; give {form} with finite numbers") from None
    if low > high:
        raise InputError(f"{name} {low:g}:{high:g} is empty; give {form}, the smaller number first")
    return low, high


def read_toml(path: Path, option: str) -> dict[str, Any]:
    """The content of a TOML file of at most 1 MB. Raises InputError naming the option and the file."""
    regular_file(option, path_of(option, path), _LARGEST_TOML)
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{option} {path}: cannot be read ({error.strerror})") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"{option} {path}: not valid TOML ({error})") from None


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
