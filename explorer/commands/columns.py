"""`nearflat columns`: what the columns of results and of stored runs mean, and what the statuses do."""

import argparse
import json
from dataclasses import asdict

from explorer import compiled
from explorer.commands.common import add_json
from explorer.phase.columns import COLUMNS, column
from explorer.scenes.registry import SCENES, scene_class


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of `nearflat columns`."""
    command.add_argument(
        "scene", nargs="?", metavar="SCENE", help=f"only what this scene stores: {', '.join(SCENES)} (default all)"
    )
    add_json(command)


def _lines(name: str) -> str:
    """What is printed of a column."""
    known = column(name)
    at = f"eq. {known.equation}" if known.equation.startswith("(") else known.equation
    kind = "name" if name == "status" else "number"
    details = ", ".join(filter(None, (known.unit or kind, at)))
    return f"{name} [{details}]\n    {known.meaning}"


def call(options: argparse.Namespace) -> int:
    """Print the columns of a scene, or all of them, and the statuses."""
    kind = None if options.scene is None else scene_class(options.scene)
    names = COLUMNS if kind is None else kind.columns
    given = () if kind is None else kind.columns_of_given
    statuses = {
        code.name.lower(): {"code": int(code), "sentence": code.sentence, "remedy": code.remedy}
        for code in compiled.status.Status
    }
    if options.json:
        described = {name: asdict(column(name)) for name in names}
        more = {name: asdict(column(name)) for name in given}
        beside = {} if kind is None else {"columns_with_given_states": more}
        print(json.dumps({"columns": described, **beside, "statuses": statuses}))
        return 0
    print("Columns: name, unit (of the disk; natural units where m = r = g = 1), equation of the paper, meaning\n")
    print(*map(_lines, names), sep="\n")
    if given:
        print(
            "\nThese as well where states are given, or drawn in all of the phase space; `row` only with --states,"
        )
        print("and beside it your own columns, as given_NAME where the name is taken:\n")
        print(*map(_lines, given), sep="\n")
    print("\nStatuses: name, number, what happened, what to do\n")
    for name, known_as in statuses.items():
        print(f"{name} ({known_as['code']})\n    {known_as['sentence']} {known_as['remedy']}")
    return 0
