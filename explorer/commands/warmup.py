"""`nearflat warmup`: compile before the first question is asked."""

import argparse
from collections.abc import Sequence

from explorer.compiled import warmup
from explorer.errors import note


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """The command has no options of its own."""


def call(options: argparse.Namespace) -> int:
    fresh = warmup(say=lambda text: note(text, options.quiet))
    print(f"{fresh} kernels compiled; all are ready." if fresh else "All kernels were ready.")
    return 0
