"""The command `nearflat`: parse, call one function, print.

Exit status: 0 done, 1 the run failed, 2 bad arguments, 130 interrupted. Results go to stdout,
progress and errors to stderr. Nothing heavy is imported before a command is known.
"""

import argparse
import json
import os
import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

from explorer.commands import pages as cli_paper
from explorer.commands import view as cli_view
from explorer.commands.runs import add_commands, add_json, add_workers, show
from explorer.errors import InputError, Interrupted, RunError

_SCENES = "falling-set, measure-zero, one-sided, portrait, race-angles, or a TOML file that names a scene"

# Scene options in the order of --help: flag, keyword, metavar, help.
_OPTIONS = (
    ("--samples", "samples", "N", "number of samples (1e6 is accepted)"),
    ("--seed", "seed", "S", "seed of the random streams (default 0)"),
    ("--box", "box", "BOX", 'where states are drawn: "phi=0,phidot=-2:2,sigma3=-2:2,sigma4=-2:2"'),
    ("--max-energy", "max_energy", "E", "falling-set: only states with energy up to E"),
    (
        "--eta-hat",
        "eta_hat",
        "LOW:HIGH",
        "distance beside the falling set, both signs: 1e-6:1e-2; portrait: one number, 0 is on the line",
    ),
    ("--sigma3-bar", "sigma3_bar", "X", "portrait: constant of motion (default 0.25 natural units)"),
    ("--sigma4-bar", "sigma4_bar", "X", "portrait: the other constant, instead of --eta-hat"),
    ("--energies", "energies", "LOW:HIGH", "portrait: energies of the levels"),
    (
        "--keep",
        "keep",
        "WHICH",
        "samples to store: near F (near, the default), all or none; counts are complete",
    ),
    ("--memory", "memory", "SIZE", "budget, as 1GB; decides the size of chunks and is part of what the run is"),
    ("--states", "states", "FILE", "falling-set: Parquet file with columns phi, phidot, sigma3, sigma4"),
    ("--accuracy", "accuracy", "TOL", "absolute error of angles, relative of times and tilts (default 1e-6)"),
    ("--method", "method", "NAME", "auto, quadrature, rk4, rk8, dopri5 or dop853 (default auto)"),
    (
        "--energy",
        "energy",
        "LOW:HIGH",
        "measure-zero: only states of an energy in this range; :HIGH, LOW: too",
    ),
    ("--gaussian", "gaussian", "BELLS", 'measure-zero: "phidot=MEAN:DEVIATION,..." instead of uniform in the box'),
    ("--ladder", "ladder", "LOW:HIGH", "measure-zero: tilts delta in rad, by decades (default 1e-15:1e-1)"),
    ("--tube", "tube", "N", "measure-zero: draws per delta and side in tubes beside F (default 262144)"),
    ("--sampling", "sampling", "HOW", "measure-zero: random or sobol, for the tubes (default random)"),
    ("--grid", "grid", "N", "falling-set: points per axis of a slice (default 401)"),
)


class _Parser(argparse.ArgumentParser):
    """Errors in one or two lines, without the whole usage; -1e-3 is a number, not an option."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._negative_number_matcher = re.compile(r"^-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")

    def error(self, message: str) -> NoReturn:
        print(f"{self.prog}: {message}\nTry '{self.prog} --help'.", file=sys.stderr)
        raise SystemExit(2)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns its exit status."""
    options = _parser().parse_args(arguments)
    if options.arithmetic is not None:
        # Read when the kernels are first loaded, here and in worker processes.
        os.environ["NEARFLAT_ARITHMETIC"] = options.arithmetic
    try:
        return options.call(options)
    except (InputError, ImportError) as error:
        return _complain(options, error, 2)
    except Interrupted as error:
        return _complain(options, error, 130)
    except RunError as error:
        return _complain(options, error, 1)
    except KeyboardInterrupt:
        hint = "; finished chunks are kept: nearflat resume DIR goes on" if options.command == "run" else ""
        return _complain(options, f"interrupted{hint}", 130)


def _complain(options: argparse.Namespace, error: object, status: int) -> int:
    print(f"nearflat {options.command}: {error}", file=sys.stderr)
    return status


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="nearflat",
        description="Explore the phase space of the rolling disk that nearly falls flat.",
        epilog="example: nearflat demo",
    )
    parser.add_argument(
        "--arithmetic",
        choices=("strict", "relaxed"),
        help="relaxed: the compiler may reorder operations; faster, and last digits depend on the machine",
    )
    parser.add_argument("--version", action="version", version=f"nearflat {_version()}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True, parser_class=_Parser)
    _add_demo(commands)
    _add_run(commands)
    add_commands(commands, _add)
    _add_passage(commands)
    _add_plan(commands)
    _add_trade(commands)
    cli_paper.add_commands(commands, _add)
    cli_view.add_commands(commands, _add)
    _add_warmup(commands)
    return parser


def _add(commands: Any, name: str, call: Callable, help_text: str, example: str) -> argparse.ArgumentParser:
    command = commands.add_parser(name, help=help_text, description=help_text, epilog=f"example: {example}")
    command.set_defaults(call=call)
    command.add_argument("--quiet", action="store_true", help="no progress and no notes")
    return command


def _add_demo(commands: Any) -> None:
    command = _add(
        commands,
        "demo",
        _demo,
        "The main job, small: map the falling set, compare the limits, histogram the race.",
        "nearflat demo --jobs 2",
    )
    command.add_argument("--out", default="results/demo", metavar="DIR", help="default results/demo")
    command.add_argument("--jobs", type=int, default=2, metavar="N", help="threads (default 2)")
    command.add_argument("--seed", default=0, metavar="S", help="seed of the random streams (default 0)")
    add_json(command)


def _add_run(commands: Any) -> None:
    command = _add(
        commands,
        "run",
        _run,
        "Run a scene on many initial states and store samples, summary and figures.",
        "nearflat run race-angles --disk hoop --samples 1e5 --eta-hat 1e-6:1e-2 --out results/races",
    )
    command.add_argument("scene", metavar="SCENE", help=_SCENES)
    command.add_argument(
        "--disk",
        action="append",
        metavar="DISK",
        help='uniform, hoop, matching, annulus:INNER_OVER_OUTER, FILE.toml or "m=..,r=..,g=..,I1=..,I3=.."; '
        "one-sided takes several",
    )
    for flag, keyword, metavar, help_text in _OPTIONS:
        command.add_argument(flag, dest=keyword, metavar=metavar, help=help_text)
    command.add_argument(
        "--slice",
        dest="slices",
        action="append",
        metavar="SLICE",
        help='falling-set: a slice to draw, two ranges and two numbers: "phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2"',
    )
    command.add_argument(
        "--well", action="store_const", const=True, help="portrait: insist on a well beside the falling motions"
    )
    add_workers(command)
    command.add_argument("--out", metavar="DIR", help="default results/<scene>-<disk>-<seed>")
    command.add_argument("--resume", action="store_true", help="go on with the run in --out")
    add_json(command)


def _add_passage(commands: Any) -> None:
    command = _add(
        commands,
        "passage",
        _passage,
        "One passage near flat, from vertical to vertical: race angle, times, limits, forces.",
        "nearflat passage --disk uniform --sigma3-bar 1 --eta-hat 1e-6 --phidot 1 --json",
    )
    command.add_argument("--disk", default="uniform", metavar="DISK", help="as for run (default uniform)")
    for flag, help_text in (
        ("--sigma3-bar", "sigma3 at the vertical, in the units of the disk"),
        ("--eta-hat", "distance beside the falling set; 0 is the fall itself"),
        ("--phidot", "speed at the vertical towards the flat state, 0 or more"),
    ):
        command.add_argument(flag, required=True, type=float, metavar="X", help=help_text)
    command.add_argument("--face", type=int, choices=(1, -1), default=1, help="flat state (default 1)")
    command.add_argument("--accuracy", type=float, default=1e-6, metavar="TOL", help="as for run")
    command.add_argument("--method", default="auto", metavar="NAME", help="as for run")
    command.add_argument("--window", type=float, metavar="Q", help="cos phi at which to start and stop")
    add_json(command)


def _add_plan(commands: Any) -> None:
    command = _add(
        commands,
        "plan",
        _plan,
        "Say which model and method `run` would choose for a scene, and why; compute nothing.",
        "nearflat plan race-angles --accuracy 1e-9",
    )
    command.add_argument("scene", metavar="SCENE", help=_SCENES)
    command.add_argument("--accuracy", type=float, metavar="TOL", help="as for run")
    command.add_argument("--method", metavar="NAME", help="as for run")
    add_json(command)


def _add_trade(commands: Any) -> None:
    command = _add(
        commands,
        "trade",
        _trade,
        "Measure error and cost of every method on this machine; `--accuracy` and `--method auto` use it.",
        "nearflat trade --disk hoop",
    )
    command.add_argument("--disk", default="uniform", metavar="DISK", help="as for run")
    command.add_argument("--samples", default=4096, metavar="N", help="passages (default 4096)")
    command.add_argument("--seed", default=0, metavar="S", help="seed (default 0)")
    command.add_argument("--out", default="results/trade", metavar="DIR", help="folder (default results/trade)")
    command.add_argument("--no-store", action="store_true", help="do not keep the result for this machine")
    add_json(command)


def _add_warmup(commands: Any) -> None:
    _add(commands, "warmup", _warmup, "Compile all kernels into the cache.", "nearflat warmup")


def _demo(options: argparse.Namespace) -> int:
    from explorer.commands.demo import demo, summary_of

    runs = demo(options.out, jobs=options.jobs, seed=options.seed, quiet=options.quiet)
    if options.json:
        print(json.dumps(summary_of(runs)))
    else:
        print(f"Pictures and numbers are in {options.out}; start with {Path(options.out) / 'README.md'}.")
    return 0


def _run(options: argparse.Namespace) -> int:
    from explorer.commands.run import run
    from explorer.scenes.options import read_scene_file

    given: dict[str, Any] = {"scene": options.scene}
    if options.scene.endswith(".toml"):
        given = read_scene_file(Path(options.scene))
    typed = {key: getattr(options, key) for _, key, _, _ in _OPTIONS}
    typed |= {"disk": options.disk, "slices": options.slices, "well": options.well, "out": options.out}
    typed |= {"jobs": options.jobs, "backend": options.backend, "scheduler": options.scheduler}
    given |= {key: value for key, value in typed.items() if value is not None}
    given |= {"resume": options.resume or given.get("resume", False), "quiet": options.quiet}
    return show(run(**given), options.json)


def _passage(options: argparse.Namespace) -> int:
    from explorer.commands.passage import passage_report, passage_text

    report = passage_report(
        options.disk,
        options.sigma3_bar,
        options.eta_hat,
        options.phidot,
        options.face,
        method=options.method,
        accuracy=options.accuracy,
        window=options.window,
    )
    print(json.dumps(report) if options.json else passage_text(report))
    for warning in () if options.quiet else report["warnings"]:
        print(f"nearflat passage: {warning}", file=sys.stderr)
    return 0 if report["status"] in ("ok", "falls") else 1


def _plan(options: argparse.Namespace) -> int:
    from explorer.motion.plan import plan
    from explorer.scenes.options import read_scene_file
    from explorer.scenes.registry import scene_class

    name, given = options.scene, {}
    if name.endswith(".toml"):
        given = read_scene_file(Path(name))
        name = given["scene"]
    accuracy = given.get("accuracy", 1e-6) if options.accuracy is None else options.accuracy
    method = given.get("method", "auto") if options.method is None else options.method
    scene = scene_class(name)
    chosen = plan(scene.observables, accuracy, method)
    found = {
        "scene": name,
        "observables": list(scene.observables),
        "accuracy": accuracy,
        "model": chosen.rung,
        "method": chosen.method,
        "reason": chosen.reason,
        "cost": chosen.cost,
    }
    if options.json:
        print(json.dumps(found))
    else:
        for key, value in found.items():
            print(f"{key:12} {', '.join(value) if isinstance(value, list) else value}")
    return 0


def _trade(options: argparse.Namespace) -> int:
    from explorer.commands import trade
    from explorer.errors import note
    from explorer.motion import calibration
    from explorer.phase.disk import Disk
    from explorer.scenes.options import whole

    disk, out = Disk.parse(options.disk), trade.folder_for(Path(options.out))
    samples, seed = whole("--samples", options.samples, 1, 10**6), whole("--seed", options.seed, 0, 2**64)
    rows = trade.trade(disk, samples, seed, lambda text: note(text, options.quiet))
    command = f"nearflat trade --disk {options.disk} --samples {samples} --seed {seed}"
    where = None if options.no_store else calibration.stored_at()
    trade.report(disk, rows, out, command, where)
    if where is not None:
        calibration.store(trade.calibrate(rows))
    if options.json:
        print(json.dumps({"disk": disk.describe(), "rows": [vars(row) for row in rows]}))
        return 0
    print("\n".join(trade.table(rows)))
    print(f"Table and picture are in {options.out}." + (f" Calibration kept in {where}." if where else ""))
    return 0


def _warmup(options: argparse.Namespace) -> int:
    from explorer.compiled import warmup
    from explorer.errors import note

    fresh = warmup(lambda text: note(text, options.quiet))
    print(f"{fresh} kernels compiled; all are ready." if fresh else "All kernels were ready.")
    return 0


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("nearflat")
    except PackageNotFoundError:
        return "(not installed)"


if __name__ == "__main__":
    sys.exit(main())
