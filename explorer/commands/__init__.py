"""The command line: one file for each family of commands."""

from typing import Any, NamedTuple


class Answer(NamedTuple):
    """What a command prints: an object where --json asks for one, else a text; and its exit status."""

    record: Any
    text: str
    status: int = 0
