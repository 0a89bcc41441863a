"""`nearflat paper`: the paper as checks, figures and misprints."""

import argparse
import json
from pathlib import Path

from explorer.commands.common import add_json
from explorer.commands.made_by import leave_made_by
from explorer.errors import whole
from explorer.paper.pages import headline, line_of, paper


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of `nearflat paper`."""
    command.add_argument("--only", metavar="NAME", help="one statement, by name or number; nothing is written")
    command.add_argument("--out", default="results/paper", metavar="DIR", help="default results/paper")
    command.add_argument("--jobs", default="2", metavar="N", help="threads (default 2)")
    add_json(command)


def call(options: argparse.Namespace) -> int:
    rows = paper(options.out, only=options.only, jobs=whole("--jobs", options.jobs, 1), quiet=options.quiet)
    if options.only is None:
        leave_made_by(Path(options.out), "nearflat paper")
    holding = sum(row.passed for row in rows)
    if options.json:
        counts = {"holding": holding, "failing": len(rows) - holding}
        print(json.dumps(counts | {"rows": [row.describe() for row in rows]}))
    else:
        if options.only is not None:
            for row in rows:
                print(f"{row.statement.number} {row.statement.name}: {row.statement.text}")
                for finding in row.findings:
                    print(line_of(finding))
        for line in headline(rows):
            print(line)
    return 0 if holding == len(rows) else 1
