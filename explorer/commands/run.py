"""`nearflat run`: a scene on many initial states, stored in a folder."""

import argparse
from collections.abc import Sequence

from explorer.commands.common import add_json, add_question, given_by, show
from explorer.runs.run import execute
from explorer.runs.settings import asked


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of the scene that is named, and of its run."""
    add_question(command, words)
    add_json(command)


def call(options: argparse.Namespace) -> int:
    """Run the scene."""
    name, given = given_by(options)
    return show(execute(asked(name, given, options.command_line, exist="error")), options.json)
