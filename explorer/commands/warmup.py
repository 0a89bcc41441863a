"""`nearflat warmup`: compile before the first question is asked."""

import argparse

from explorer.commands import Answer
from explorer.compiled import warmup
from explorer.errors import note


def call(options: argparse.Namespace) -> Answer:
    """Compile all, and say how many there were."""
    fresh = warmup(say=lambda text: note(text, options.quiet))
    return Answer(
        {"compiled": fresh}, f"{fresh} kernels compiled; all are ready." if fresh else "All kernels were ready."
    )
