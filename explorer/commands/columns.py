"""`nearflat columns`: what the columns of results and of stored runs mean, and what the statuses do."""

import argparse
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict

from explorer import compiled
from explorer.commands.common import add_json
from explorer.phase.columns import COLUMNS, Column, column
from explorer.scenes.registry import NAMES, scene_class


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of `nearflat columns`."""
    command.add_argument(
        "scene", nargs="?", metavar="SCENE", help=f"only what this scene stores: {', '.join(NAMES)} (default all)"
    )
    add_json(command)


def _lines(name: str, known: Column) -> str:
    """What is printed of a column."""
    at = f"eq. {known.equation}" if known.equation.startswith("(") else known.equation
    kind = "name" if name == "status" else "number"
    details = ", ".join(filter(None, (known.unit or kind, at)))
    return f"{name} [{details}]\n    {known.meaning}"


def call(options: argparse.Namespace) -> int:
    """Print the columns of a scene, or all of them, and the statuses."""
    kind = None if options.scene is None else scene_class(options.scene)
    known = COLUMNS if kind is None else _described(kind.columns)
    more = {} if kind is None else _described(kind.columns_of_given)
    statuses = {
        code.name.lower(): {"code": int(code), "sentence": code.sentence, "remedy": code.remedy}
        for code in compiled.status.Status
    }
    if options.json:
        columns = {"columns": {name: asdict(each) for name, each in known.items()}}
        beside = (
            {} if kind is None else {"columns_with_given_states": {n: asdict(each) for n, each in more.items()}}
        )
        print(json.dumps({**columns, **beside, "statuses": statuses}))
        return 0
    print("Columns: name, unit (of the disk; natural units where m = r = g = 1), equation of the paper, meaning\n")
    print(*(_lines(*each) for each in known.items()), sep="\n")
    if more:
        print(
            "\nThese as well where states are given, or drawn in all of the phase space; `row` only with --states,"
        )
        print("and beside it your own columns, as given_NAME where the name is taken:\n")
        print(*(_lines(*each) for each in more.items()), sep="\n")
    print("\nStatuses: name, number, what happened, what to do\n")
    for name, status in statuses.items():
        print(f"{name} ({status['code']})\n    {status['sentence']} {status['remedy']}")
    return 0


def _described(columns: Sequence[str] | Mapping[str, Column]) -> dict[str, Column]:
    """What columns mean; a user's scene says it itself."""
    return dict(columns) if isinstance(columns, Mapping) else {name: column(name) for name in columns}
