"""What several commands share: their options, and how a finished run is shown."""

import argparse
import json
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from explorer.runs.run import Run


def add_json(command: argparse.ArgumentParser) -> None:
    """Add the option of every command that prints a result."""
    command.add_argument("--json", action="store_true", help="print one JSON object on stdout and nothing else")


def show(run: "Run", as_json: bool) -> int:
    """Print a finished run; returns the exit status."""
    if as_json:
        print(json.dumps(run.summary))
        return 0
    for line in run.scene.headline(run.summary):
        print(line)
    drawn = run.folder is not None and any((run.folder / "figures").glob("*"))
    print(f"{'Samples, numbers and pictures' if drawn else 'Samples and numbers'} are in {run.folder}.")
    return 0
