"""`nearflat cite` and `ex.cite`: what to cite, as BibTeX."""

import argparse

from explorer.commands import Answer
from explorer.version import installed_version

PAPER = {
    "author": "Cushman, R. and Duistermaat, J. J.",
    "title": "Nearly flat falling motions of the rolling disk",
    "journal": "Regular and Chaotic Dynamics",
    "volume": "11",
    "number": "1",
    "pages": "31--60",
    "year": "2006",
}


def cite() -> str:
    """BibTeX entries of this software, with its version, and of the paper whose motions it computes.

    Returns
    -------
    str
        Two entries, `nearflat` and `CushmanDuistermaat2006`.

    Examples
    --------
    >>> import explorer as ex
    >>> print(ex.cite().partition("\\n")[0])
    @software{nearflat,
    """
    return "\n\n".join(_entry(*each) for each in _entries())


def _entries() -> tuple[tuple[str, str, dict[str, str]], ...]:
    software = {
        "author": "{The nearflat authors}",
        "title": "nearflat: Monte Carlo phase-space explorer of the rolling disk that nearly falls flat",
        "version": installed_version() or "not installed",
    }
    return ("software", "nearflat", software), ("article", "CushmanDuistermaat2006", PAPER)


def _entry(kind: str, key: str, fields: dict[str, str]) -> str:
    lines = "".join(f"  {name} = {{{value}}},\n" for name, value in fields.items())
    return f"@{kind}{{{key},\n{lines}}}"


def call(options: argparse.Namespace) -> Answer:
    """Say the entries."""
    return Answer({key: fields for _, key, fields in _entries()}, cite())
