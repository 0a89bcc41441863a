"""What goes wrong, for people: every message names the argument, the value and the remedy."""

import sys


class InputError(ValueError):
    """An argument cannot be used. The command line exits with status 2."""


class RunError(RuntimeError):
    """A run failed or a check did not hold. The command line exits with status 1."""


class Interrupted(RunError):
    """A person or the system stopped a run between two chunks. The command line exits with status 130."""


def note(text: str, quiet: bool) -> None:
    """A line for people, on stderr."""
    if not quiet:
        print(text, file=sys.stderr, flush=True)
