"""`nearflat view`: the page with the rolling disk, written to a file."""

import argparse
import json
import webbrowser
from pathlib import Path

from explorer.commands.common import add_json
from explorer.errors import number, sign
from explorer.view.page import view


def add_arguments(command: argparse.ArgumentParser) -> None:
    """What the command takes."""
    command.add_argument("--disk", default="uniform", metavar="DISK", help="as for run (default uniform)")
    for flag, default, help_text in (
        ("--sigma3-bar", "1", "sigma3 at the vertical, in the units of the disk"),
        ("--eta-hat", "0.001", "distance beside the falling set, not 0; its sign is the side"),
        ("--phidot", "1", "speed at the vertical towards the flat state"),
    ):
        command.add_argument(flag, metavar="X", help=f"{help_text} (default {default} sqrt(g/r))")
    command.add_argument("--face", default=1, metavar="X", help="flat state, 1 or -1 (default 1)")
    command.add_argument("--out", default="view.html", metavar="FILE", help="default view.html")
    command.add_argument("--open", action="store_true", help="open the page in the browser")
    add_json(command)


def call(options: argparse.Namespace) -> int:
    """Write the page."""
    sigma3_bar, eta_hat, phidot = (
        None if given is None else number(flag, given)
        for flag, given in (
            ("--sigma3-bar", options.sigma3_bar),
            ("--eta-hat", options.eta_hat),
            ("--phidot", options.phidot),
        )
    )
    page = view(options.disk, sigma3_bar, eta_hat, phidot, sign("--face", options.face))
    where = page.save(Path(options.out))
    size = where.stat().st_size
    if options.json:
        print(json.dumps({"page": str(where), "bytes": size, "disk": page.disk.name}))
    else:
        print(f"{where} ({size / 1000:.0f} kB): open it in any browser.")
    if options.open:
        webbrowser.open(where.resolve().as_uri())
    return 0
