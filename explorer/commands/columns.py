"""`nearflat columns`: what the columns of results and of stored runs mean, and what the statuses do."""

import argparse
import json

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


def call(options: argparse.Namespace) -> int:
    """Print the columns of a scene, or all of them, and the statuses."""
    names = COLUMNS if options.scene is None else scene_class(options.scene).columns
    statuses = {
        code.name.lower(): {"code": int(code), "sentence": code.sentence, "remedy": code.remedy}
        for code in compiled.status.Status
    }
    if options.json:
        print(json.dumps({"columns": {name: column(name).describe() for name in names}, "statuses": statuses}))
        return 0
    print("Columns: name, unit (of the disk; natural units where m = r = g = 1), equation of the paper, meaning\n")
    for name in names:
        known = column(name)
        at = f"eq. {known.equation}" if known.equation.startswith("(") else known.equation
        details = ", ".join(filter(None, (known.unit or "number", at)))
        print(f"{name} [{details}]\n    {known.meaning}")
    print("\nStatuses: name, number, what happened, what to do\n")
    for name, known_as in statuses.items():
        print(f"{name} ({known_as['code']})\n    {known_as['sentence']} {known_as['remedy']}")
    return 0
