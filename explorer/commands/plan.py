"""`nearflat plan`: which model and method a scene would use, and why."""

import argparse
import json
from pathlib import Path
from typing import Any

from explorer.commands.common import add_json
from explorer.runs.settings import asked
from explorer.scenes.registry import SCENES, read_scene_file


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of `nearflat plan`."""
    command.add_argument("scene", metavar="SCENE", help=f"{', '.join(SCENES)}, or a TOML file that names a scene")
    command.add_argument("--accuracy", metavar="TOL", help="as for run")
    command.add_argument("--method", metavar="NAME", help="as for run")
    add_json(command)


def call(options: argparse.Namespace) -> int:
    given: dict[str, Any] = {"scene": options.scene}
    if options.scene.endswith(".toml"):
        given = read_scene_file(Path(options.scene))
    given |= {
        name: getattr(options, name) for name in ("accuracy", "method") if getattr(options, name) is not None
    }
    scene = asked(given.pop("scene"), given, options.command_line).scene
    chosen = scene.plan
    answer = {
        "scene": scene.name,
        "observables": list(scene.observables),
        "accuracy": chosen.accuracy,
        "model": chosen.rung,
        "method": chosen.method,
        "reason": chosen.reason,
        "cost": chosen.cost,
    }
    if options.json:
        print(json.dumps(answer))
    else:
        for key, value in answer.items():
            print(f"{key:12} {', '.join(value) if isinstance(value, list) else value}")
    return 0
