"""The commands `nearflat paper` and `nearflat portrait`."""

import argparse
import json
from collections.abc import Callable
from typing import Any

from explorer.cli_runs import add_json


def add_commands(commands: Any, add: Callable[..., argparse.ArgumentParser]) -> None:
    """Add both commands. add: as explorer.cli._add."""
    command = add(
        commands,
        "paper",
        _paper,
        "Check every statement of the paper, draw its figures, list its misprints; exit status 1 if a row fails.",
        "nearflat paper --only LEMMA-5",
    )
    command.add_argument("--only", metavar="NAME", help="one statement, by name or number; writes nothing")
    command.add_argument("--out", default="results/paper", metavar="DIR", help="default results/paper")
    command.add_argument("--jobs", type=int, default=2, metavar="N", help="threads (default 2)")
    add_json(command)


def _paper(options: argparse.Namespace) -> int:
    from explorer.paper.report import headline, paper

    rows = paper(options.out, only=options.only, jobs=options.jobs, quiet=options.quiet)
    if options.json:
        passed = sum(row.passed for row in rows)
        found = {"holding": passed, "failing": len(rows) - passed, "rows": [row.describe() for row in rows]}
        print(json.dumps(found))
    else:
        if options.only is not None:
            for row in rows:
                print(f"{row.statement.number} {row.statement.name}: {row.statement.text}")
                for finding in row.findings:
                    print(f"  {finding.computed}: off by {finding.error:.1e}, allowed {finding.tolerance:.1e}")
        for line in headline(rows):
            print(line)
    return 0 if all(row.passed for row in rows) else 1
