"""Files as strangers may have left them: checked before they are used, and bounded in size and depth.

A file of a run is only opened where it is a plain file of the folder itself, not a link, a pipe, a device or a
folder. Nothing in it is executed: JSON and Parquet hold data only.
"""

import json
import re
import stat
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

LARGEST_JSON = 1 << 26  # bytes; a summary with several histograms has some hundred kilobytes
_ENDS = b"PAR1"  # with which a Parquet file begins and ends
_CONTAINERS = (dict, list)
FILE = "a file"
_WHAT: dict[str, Callable[[int], bool]] = {
    FILE: stat.S_ISREG,
    "a folder": stat.S_ISDIR,
    "a pipe": stat.S_ISFIFO,
    "a socket": stat.S_ISSOCK,
    "a device": lambda mode: stat.S_ISCHR(mode) or stat.S_ISBLK(mode),
}
_DEEPEST = 40  # levels of JSON; what nearflat writes has less than ten


class StrangeError(ValueError):
    """A file is not what a run writes; the message says how."""


def no_link(path: Path) -> Path:
    """`path`, where it is no link, or nothing at all. Raises StrangeError or OSError."""
    if path.is_symlink():
        raise StrangeError("it is a link, and what it leads to may lie outside the folder")
    return path


def what_stands(path: Path) -> str | None:
    """What has this name: FILE, "a folder", "a pipe", "a device", "a socket" or "a link"; None where nothing has.

    Raises OSError.
    """
    try:
        mode = path.lstat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return None
    if stat.S_ISLNK(mode):
        return "a link" if path.exists() else "a link to nothing"
    return next((name for name, test in _WHAT.items() if test(mode)), "no plain file")


def plain_file(path: Path, largest: float = float("inf")) -> Path:
    """`path`, where it is a file of its own with so many bytes at most. Raises StrangeError or OSError."""
    found = no_link(path).lstat()
    if not stat.S_ISREG(found.st_mode):
        raise StrangeError(f"it is {what_stands(path)}, no plain file")
    if found.st_size > largest:
        raise StrangeError(f"it has {found.st_size:,} bytes; {largest:,.0f} is the most that is read")
    return path


def parquet_file(path: Path) -> Path:
    """The file's absolute path, where it looks like Parquet at both ends: zeros of any length are refused at once.

    Arrow would read a relative path with a colon as an address.
    """
    with plain_file(path).open("rb") as stream:
        begins = stream.read(len(_ENDS))
        stream.seek(0, 2)
        stream.seek(max(0, stream.tell() - len(_ENDS)))
        if begins != _ENDS or stream.read() != _ENDS:
            raise StrangeError("it is no Parquet file")
    return path.absolute()


def parse_json(text: str | bytes) -> dict[str, Any]:
    """A JSON object that is not too deep. Raises StrangeError or ValueError."""
    try:
        content = json.loads(text, parse_constant=_no_constant)
    except RecursionError:
        raise StrangeError("it is nested too deeply") from None
    except (json.JSONDecodeError, StrangeError):
        raise
    except UnicodeDecodeError:
        raise StrangeError("it is no text") from None
    except ValueError:  # Python speaks of its own bound here
        raise StrangeError("it holds a number of too many digits") from None
    if not isinstance(content, dict):
        raise StrangeError("it holds no JSON object")
    _check_depth(content)
    return content


def _no_constant(name: str) -> None:
    raise StrangeError(f"it holds {name}, which is no JSON")


def _check_depth(content: Any) -> None:
    """Raise StrangeError where there are containers below _DEEPEST levels of them, a level at a time."""
    level = [content]
    for _ in range(_DEEPEST):
        inside = (value.values() if isinstance(value, dict) else value for value in level)
        level = [each for values in inside for each in values if isinstance(each, _CONTAINERS)]
        if not level:
            return
    raise StrangeError(f"it is nested more than {_DEEPEST} levels deep")


def check_kinds(content: dict[str, Any], kinds: dict[str, type]) -> None:
    """Raise StrangeError where an entry is missing, is of another kind, or is too many."""
    for name, kind in kinds.items():
        value = content.get(name)
        if not isinstance(value, kind) or isinstance(value, bool):
            raise StrangeError(f"its {name} is no {kind.__name__}")
    others = sorted(set(content) - set(kinds))
    if others:
        raise StrangeError(f"it has {others[0][:40]!r}, which is unknown")


def plain_names(value: Any, known: Collection[str] | None = None) -> list[str] | None:
    """Names of files without any path in them, `known` ones where those are given; None where they are not."""
    if not isinstance(value, list) or not all(isinstance(name, str) for name in value):
        return None
    good = all(re.fullmatch(r"[\w.,+-]{1,100}", name) and not name.startswith(".") for name in value)
    return value if good and (known is None or set(value) <= set(known)) else None
