"""What users are told, and the readers of what users write.

Every message names the argument, the value and the remedy, in at most 300 characters. It is written in the words
of the command line and says the same in the words of Python, unless the command line is at work. Public functions,
the command line and files from users have their arguments read here: a reader returns the value with its proper
type, raises InputError for what it cannot use, and never changes what it was given.

Numbers are those of Python and numpy, and text in plain digits; never a bool, bytes, a date or a complex number.
Readers of arrays, states and disks, which need numpy, are in `phase.arguments`, `phase.states` and `phase.disk`,
those of files in `phase.paths`.
"""

import contextlib
import math
import re
import sys
import warnings
from collections.abc import Callable, Collection, Iterable, Iterator
from decimal import Decimal
from difflib import get_close_matches
from functools import wraps
from itertools import islice
from numbers import Integral, Real
from typing import Any, Concatenate, ParamSpec, TypeVar, cast

P = ParamSpec("P")
R = TypeVar("R")
MOST_JOBS = 1024  # threads or processes: more only take memory
MOST_WORDS = 1000
_PLAIN = (type(None), bool, int, float, complex, str, bytes)  # they have no methods of a user
_LONGEST = 300  # characters of a message
SHOWN = 60  # characters of a value in it
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
        # Half of a letter, which no stream can write, is shown by its number.
        return in_words(super().__str__()).encode(errors="backslashreplace").decode()


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
        if isinstance(value, list | tuple | dict | set | bytes | bytearray) and len(value) > SHOWN:
            return f"{type(value).__name__} of {len(value)}"
        if isinstance(value, int) and abs(value) >= 10**SHOWN:
            return f"an integer of some {int(value.bit_length() * math.log10(2.0)) + 1} digits"
        return shorten(" ".join(repr(value).split()), SHOWN)
    except Exception:  # whatever a foreign object does when it is asked for its text
        return f"an object of type {type(value).__name__}"


def said(name: str, value: Any) -> str:
    """An argument with its value as the user wrote it: "--samples 0", "samples = 0" or "--disk: m = 0"."""
    name = in_words(name)
    text = shorten(value, SHOWN) if type(value) is str else shown(value)
    bare = name.startswith("--") and ":" not in name
    return f"{name} {text}" if bare else f"{name} = {text}"


def reader(read: Callable[Concatenate[str, Any, P], R]) -> Callable[Concatenate[str, Any, P], R]:
    """Let a reader, called as read(name, value, ...), say as InputError that the value fails when it is looked at.

    Objects of users and of other packages have methods of their own for all that a reader may ask, also for what
    they are: any of them may raise. What fails on a plain number or text is a mistake of this program.
    """

    @wraps(read)
    def safely(name: str, value: Any, *more: P.args, **named: P.kwargs) -> R:
        try:
            return read(name, value, *more, **named)
        except Exception as error:
            if is_ours(error) or type(value) in _PLAIN:
                raise
            deep = isinstance(error, RecursionError)
            why = "is nested too deeply, or holds itself" if deep else f"fails when it is read ({_kind_of(error)})"
            raise InputError(f"{said(name, value)} {why}; give plain numbers or text") from error

    return cast(Callable[Concatenate[str, Any, P], R], safely)


def is_ours(error: BaseException) -> bool:
    """Whether an exception is a message of this program, and not one that an object of a user raised."""
    place = error.__traceback__
    while place is not None and place.tb_next is not None:
        place = place.tb_next
    raised = place.tb_frame.f_globals.get("__name__") if place is not None else None
    return isinstance(error, InputError | RunError) and str(raised).partition(".")[0] == __name__.partition(".")[0]


def is_a(value: Any, kind: Any) -> bool:
    """As isinstance, also of an object that fails when it is asked for its class."""
    try:
        return isinstance(value, kind)
    except Exception:  # a proxy of what has gone, for instance
        return False


def text_of(value: Any) -> str | None:
    """Text as a plain str, whatever class of its own it has; None for anything else."""
    return str.__str__(value) if is_a(value, str) else None


def _kind_of(error: BaseException) -> str:
    return shorten(type(error).__name__, SHOWN)


@reader
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
    """A scalar of numpy, or an array of one element, as a number of Python; None for a date and what is masked."""
    try:
        mask = getattr(value, "mask", False)  # of numpy, or an array of them; of pandas a method
        if getattr(getattr(value, "dtype", None), "kind", "f") in "mM" or (not callable(mask) and bool(mask)):
            return None
        return value.item() if hasattr(value, "item") and not isinstance(value, type) else value
    except Exception:  # more than one element, a module, or a foreign object's own way to fail
        return None


def double_of(value: Any) -> float | None:
    """A number of Python as a double; None where it is no real number, or a long double that is no double."""
    if (text := text_of(value)) is not None:
        return float(text) if len(text) < 1000 and _NUMBER.fullmatch(text.strip()) else None
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


@reader
def positive(name: str, value: Any) -> float:
    """Read a finite number above 0. Raises InputError."""
    read = number(name, value)
    if read <= 0.0:
        raise InputError(f"{said(name, value)} must be a finite number above 0")
    return read


@reader
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


@reader
def sign(name: str, value: Any) -> int:
    """Read +1 or -1, a face or a side, written as any number is. Raises InputError."""
    read = double_of(plain_number(value))
    if read not in (1.0, -1.0):
        raise InputError(f"{said(name, value)} must be +1 or -1")
    return int(read)


def jobs_of(name: str, value: Any) -> int:
    """Read a number of workers. Raises InputError."""
    return whole(name, value, 1, MOST_JOBS)


@reader
def flag(name: str, value: Any) -> bool:
    """Read True or False. Raises InputError."""
    if not isinstance(value, bool) and type(value).__name__ != "bool":  # numpy has one of its own
        raise InputError(f"{said(name, value)} must be true or false")
    return bool(value)


@reader
def one_of(name: str, value: Any, known: Collection[str]) -> str:
    """Read one of the words `known`. Raises InputError with the nearest of them."""
    text = text_of(value)
    if text is None or text not in known:
        raise InputError(f"{name} {shown(value)} is not known; {suggest(text, known)}")
    return text


@reader
def words(name: str, value: Any) -> tuple[str, ...]:
    """Read a sequence of words. Raises InputError."""
    if isinstance(value, str) or not isinstance(value, Iterable) or getattr(value, "ndim", 1) != 1:
        raise InputError(f"{name} = {shown(value)}: give a list of words")
    several = tuple(map(text_of, islice(value, MOST_WORDS + 1)))
    read = tuple(each for each in several if each is not None)
    if len(several) > MOST_WORDS or len(read) < len(several):
        raise InputError(f"{name} = {shown(value)}: give a list of at most {MOST_WORDS} words")
    return read


@reader
def word(name: str, value: Any) -> str:
    """Read a name that may stand in the name of a file: up to 80 printable characters. Raises InputError."""
    text = text_of(value)
    if text is None or not 0 < len(text) <= 80 or text.startswith(".") or text != text.strip():
        raise InputError(f"{said(name, value)} is no name; give up to 80 letters, digits or signs")
    if not text.isprintable() or set(text) & set('/\\:*?"<>|'):
        raise InputError(
            f"{said(name, value)} is no name: it stands in names of files; leave out its special signs"
        )
    return text


def suggest(value: Any, known: Collection[str]) -> str:
    """The end of a message about an unknown word: the word that was probably meant, and all that are known."""
    near = nearest(value, known)
    return (f"did you mean {near!r}? " if near else "") + f"known: {shorten(', '.join(known), 160)}"


def nearest(value: Any, known: Collection[str]) -> str:
    """The word that was probably meant; empty where none is near."""
    near = get_close_matches(value[:100], known, n=1) if isinstance(value, str) else []
    if isinstance(value, str) and len(value.strip("-")) > 2 and not get_close_matches(value[:100], near, 1, 0.8):
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
