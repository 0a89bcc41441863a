"""`nearflat plan`: which model and method a scene would use, and why."""

import argparse
import json
from pathlib import Path

from explorer.commands.common import add_json
from explorer.motion.plan import plan
from explorer.scenes.options import ACCURACY
from explorer.scenes.registry import SCENES, read_scene_file, scene_class


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of `nearflat plan`."""
    command.add_argument("scene", metavar="SCENE", help=f"{', '.join(SCENES)}, or a TOML file that names a scene")
    command.add_argument("--accuracy", metavar="TOL", help="as for run")
    command.add_argument("--method", metavar="NAME", help="as for run")
    add_json(command)


def call(options: argparse.Namespace) -> int:
    name, given = options.scene, {}
    if name.endswith(".toml"):
        given = read_scene_file(Path(name))
        name = given["scene"]
    kind = scene_class(name)
    accuracy = ACCURACY.read(ACCURACY.flag, options.accuracy or given.get("accuracy", kind.accuracy))
    chosen = plan(kind.observables, accuracy, options.method or given.get("method", kind.method))
    answer = {
        "scene": name,
        "observables": list(kind.observables),
        "accuracy": accuracy,
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
