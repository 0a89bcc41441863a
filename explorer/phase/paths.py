"""Files that users name: paths, what may be read, and what is written."""

import math
import os
import re
import stat
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from explorer.errors import SHOWN, InputError, reader, said, shorten, shown, text_of

_LARGEST_TOML = 1 << 20  # bytes
_MOST_PARTS = 20  # of a key with dots, which tomllib reads in a time that grows as their square
_PART = r"""(?:[\w-]++|"(?:\\.|[^"\\\n]){0,100}+"|'[^'\n]{0,100}+')"""
# Comments and strings, of which those of many lines may look like keys. One without an end goes on to the last
# character, where it is an error anyway: so each is looked at once.
_WORDS = re.compile(
    r"""#[^\n]*+|"{3}(?:\\.|[^\\])*?(?:"{3}|\\?\Z)|'{3}.*?(?:'{3}|\Z)|"(?:\\.|[^"\\\n])*+"?|'[^'\n]*+'?""",
    re.DOTALL,
)
_LONG_KEY = re.compile(rf"(?:^|[\[{{,])[ \t]*+(?:{_PART}[ \t]*+\.[ \t]*+){{{_MOST_PARTS}}}", re.MULTILINE)


@reader
def path_of(name: str, value: Any) -> Path:
    """Read a path: text or a Path that a file system could hold. Raises InputError."""
    if not isinstance(value, str | os.PathLike):
        raise InputError(f"{said(name, value)} is no path; give text or a Path")
    text = text_of(os.fspath(value))
    if not text or "\0" in text:
        raise InputError(f"{said(name, value)} is no path; give text that is not empty and has no NUL")
    if _no_utf8(text):
        raise InputError(f"{said(name, value)} is no path in UTF-8; give it another name")
    if not Path(text).is_absolute():
        here = _here()
        if here is None:
            raise InputError(f"{said(name, value)}: the current folder was removed; work in another one")
        if _no_utf8(here):  # Arrow reads and writes whole paths in UTF-8 only
            raise InputError(f"{said(name, value)}: the current folder is no path in UTF-8; work in another one")
    if len(text) > 4000 or any(len(part.encode()) > 255 for part in Path(text).parts):
        raise InputError(f"{name} {shorten(text, SHOWN)} is too long for a path; give a shorter one")
    return Path(text)


def _no_utf8(text: str) -> bool:
    """Whether there is half of a letter, or a byte of another encoding."""
    return any("\ud800" <= letter <= "\udfff" for letter in text)


def _here() -> str | None:
    """The current folder; None where it is gone, empty where the system does not tell."""
    try:
        return str(Path.cwd())
    except FileNotFoundError:
        return None
    except OSError:
        return ""


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


def read_toml(path: Path, option: str) -> dict[str, Any]:
    """The content of a TOML file of at most 1 MB. Raises InputError naming the option and the file."""
    regular_file(option, path_of(option, path), _LARGEST_TOML)
    try:
        return _parsed(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{option} {path}: cannot be read ({error.strerror})") from None
    except ValueError as error:
        raise InputError(f"{option} {path}: not valid TOML ({error})") from None


def _parsed(text: str) -> dict[str, Any]:
    """The content of TOML. Raises ValueError, in words that say nothing of Python."""
    if _LONG_KEY.search(_WORDS.sub(_without_lines, text)):
        raise ValueError(f"a key has more than {_MOST_PARTS} parts")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    except ValueError:
        raise ValueError("a number has too many digits") from None


def _without_lines(words: re.Match[str]) -> str:
    """A string of one line as it is; an empty one for others and for comments."""
    return '""' if words[0].startswith(('"""', "'''", "#")) else words[0]


@contextmanager
def writing(name: str, value: Any, endings: tuple[str, ...], what: str = "") -> Iterator[Path]:
    """Read the path of a file that is written within this context.

    Parameters
    ----------
    name, value
        The argument, and what the user gave: text or a Path.
    endings : tuple of str
        One of which the name must have, in small or capital letters.
    what : str
        What the file is, where the endings do not say it.

    Raises
    ------
    InputError
        For what is no path, another ending, a folder that is not there, a pipe, device or folder of that name, and
        a file that the system does not take.
    """
    path = path_of(name, value)
    named = f"{name} = {shown(str(path))}"
    if path.suffix.lower() not in endings:
        *others, last = endings
        choice = f"{', '.join(others)} or {last}" if others else last
        raise InputError(f"{named}: {what}give a name that ends in {choice}")
    if not path.parent.is_dir():
        raise InputError(f"{named}: there is no folder {shown(str(path.parent))}; make it first")
    try:
        if path.exists() and not path.is_file():  # a pipe would wait for a reader
            raise InputError(f"{named}: is no plain file; give another name")
        yield path
    except OSError as error:
        raise InputError(f"{named}: cannot be written ({error.strerror or error})") from None
