"""Files that users name to be written."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from explorer.errors import InputError, path_of, shown


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
        For what is no path, another ending, a folder that is not there, and a file that the system does not take.
    """
    path = path_of(name, value)
    said = f"{name} = {shown(str(path))}"
    if path.suffix.lower() not in endings:
        *others, last = endings
        choice = f"{', '.join(others)} or {last}" if others else last
        raise InputError(f"{said}: {what}give a name that ends in {choice}")
    if not path.parent.is_dir():
        raise InputError(f"{said}: there is no folder {shown(str(path.parent))}; make it first")
    try:
        yield path
    except OSError as error:
        raise InputError(f"{said}: cannot be written ({error.strerror or error})") from None
