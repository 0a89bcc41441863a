"""`nearflat columns`: what the columns of results and of stored runs mean, and what the statuses do."""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import asdict

from explorer import compiled
from explorer.commands import Answer
from explorer.phase.columns import COLUMNS, Column, column
from explorer.scenes.scene import NAMES, scene_class

_HEADS = {
    "columns": "Columns: name, unit (of the disk; natural where m = r = g = 1), equation of the paper, meaning",
    "columns_with_given_states": """
These as well where states are given, or drawn in all of the phase space; `row` only with --states,
and beside it your own columns, as given_NAME where the name is taken:""",
}


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of `nearflat columns`."""
    command.add_argument(
        "scene", nargs="?", metavar="SCENE", help=f"only what this scene stores: {', '.join(NAMES)} (default all)"
    )


def call(options: argparse.Namespace) -> Answer:
    """Say what the columns of a scene, or all of them, and the statuses mean."""
    kind = None if options.scene is None else scene_class(options.scene)
    parts = {"columns": COLUMNS if kind is None else _described(kind.columns)}
    if kind is not None:
        parts["columns_with_given_states"] = _described(kind.columns_of_given)
    statuses = {
        code.name.lower(): {"code": int(code), "sentence": code.sentence, "remedy": code.remedy}
        for code in compiled.status.Status
    }
    lines = []
    for part, columns in parts.items():
        lines += [_HEADS[part], "", *(_line(*each) for each in columns.items())] if columns else []
    lines += ["\nStatuses: name, number, what happened, what to do\n"]
    lines += [
        f"{name} ({each['code']})\n    {each['sentence']} {each['remedy']}" for name, each in statuses.items()
    ]
    record = {part: {name: asdict(each) for name, each in columns.items()} for part, columns in parts.items()}
    return Answer({**record, "statuses": statuses}, "\n".join(lines))


def _line(name: str, known: Column) -> str:
    """What is printed of a column."""
    at = f"eq. {known.equation}" if known.equation.startswith("(") else known.equation
    kind = "name" if name == "status" else "number"
    return f"{name} [{', '.join(filter(None, (known.unit or kind, at)))}]\n    {known.meaning}"


def _described(columns: Sequence[str] | Mapping[str, Column]) -> Mapping[str, Column]:
    """What columns mean; a user's scene says it itself."""
    return columns if isinstance(columns, Mapping) else {name: column(name) for name in columns}
