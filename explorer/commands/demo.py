"""`nearflat demo`: the main job, small: sample a million states, map F, compare the limits, histogram the race."""

import argparse
import json
import shlex
import shutil
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from explorer import compiled
from explorer.commands.common import add_json, given_to
from explorer.commands.gallery import picture_lines
from explorer.commands.made_by import FILE, command_of, leave_made_by
from explorer.errors import InputError, note
from explorer.motion.plan import method_in_words
from explorer.phase.paths import path_of
from explorer.runs.run import Run, execute
from explorer.runs.settings import asked
from explorer.runs.side_by_side import SideBySide, exact_of, side_by_side
from explorer.runs.store import write_json
from explorer.scenes.options import Options, Reader, option, whole_from
from explorer.scenes.registry import scene_class
from explorer.scenes.scene import SampledScene, Scene

COMPARED = "side-by-side.json"
_COMMAND = "nearflat demo"
_OUT = "results/demo"  # git does not look there: a demo leaves a checkout as it was
# The main job: Runge-Kutta kernels, the fastest of them where a little accuracy is asked. Pictures of races look
# at 1e-7 rad.
_INTEGRATED: dict[str, Any] = {"method": "rk8", "accuracy": 1e-3}
_LOOKED_AT: dict[str, Any] = {"method": "rk8", "accuracy": 1e-8}
_STEPS: tuple[tuple[str, dict[str, Any], str], ...] = (
    ("falling-set", {"samples": 1_000_000, **_INTEGRATED}, "Where does the disk fall? A million states, {how}."),
    ("one-sided", {}, "What happens just beside the falling set? Two sides, two limit motions."),
    (
        "race-angles",
        {"samples": 200_000, **_LOOKED_AT},
        "How far does the contact point race round the rim? Passages {how}.",
    ),
)
# What is computed a second time by the exact layer, and whether its difference is relative.
_BESIDE = {"falling-set": ("theta_min", True), "race-angles": ("race_angle", False)}


class Demo(Options):
    """Where the demo goes, and how."""

    out: Path = option(Reader(path_of, "DIR", "Path | str"), "folder", default=Path(_OUT))
    jobs: int = option(whole_from(1, 1024), "threads", default=2)
    seed: int = option(whole_from(0, 2**128 - 1, "S"), "seed of the random streams", default=0)

    @property
    def command(self) -> str:
        """What makes the same again."""
        said = [f"--out={self.out}"] if self.out != Path(_OUT) else []
        return shlex.join([*_COMMAND.split(), *said, *([f"--seed={self.seed}"] if self.seed else [])])


def demo(given: Demo, quiet: bool = True) -> list[Run]:
    """Run the three scenes into folders below `out`, which an earlier demo may already fill.

    Raises InputError where it holds something else.
    """
    made = [(scene_class(name).of({"seed": given.seed, **options}), title) for name, options, title in _STEPS]
    scenes = [(scene, title_of(scene, title)) for scene, title in made]
    _clear(given.out)
    compiled.warmup(_kernels([scene for scene, _ in scenes]), lambda text: note(text, quiet))
    runs: list[Run] = []
    compared: dict[str, SideBySide] = {}
    for scene, title in scenes:
        note(f"\n{title}", quiet)
        how = {
            "out": given.out / scene.name,
            "jobs": given.jobs,
            "format": "png",
            "progress": False if quiet else None,
        }
        run = execute(asked(scene, how, exist="error"))
        for line in scene.headline(run.summary):
            note(f"  {line}", quiet)
        if scene.name in _BESIDE and isinstance(scene, SampledScene):
            column, relative = _BESIDE[scene.name]
            compared[scene.name] = side_by_side(scene, column, relative=relative, jobs=given.jobs)
            for line in compared[scene.name].lines():
                note(f"  {line}", quiet)
        if not (given.out / FILE).exists():
            leave_made_by(given.out, given.command)
        runs.append(run)
    write_json(given.out / COMPARED, {name: asdict(both) for name, both in compared.items()})
    page = _page(given.out, given.command, runs, [title for _, title in scenes], compared)
    (given.out / "README.md").write_text(page, encoding="utf-8")
    return runs


def _kernels(scenes: list[Scene]) -> tuple[str, ...]:
    """All that the runs and their comparisons call, so that it is compiled at once."""
    exact = [exact_of(scene) for scene in scenes if scene.name in _BESIDE and isinstance(scene, SampledScene)]
    return tuple(name for scene in (*scenes, *exact) for name in scene.kernels)


def title_of(scene: Scene, title: str) -> str:
    """A title with what the scene's plan does in place of {how}."""
    return title.format(how=method_in_words(scene.plan.method))


def _clear(folder: Path) -> None:
    """Remove what an earlier demo left, and nothing else."""
    if not folder.exists() or (folder.is_dir() and not any(folder.iterdir())):
        return
    if not command_of(folder).startswith(_COMMAND):
        raise InputError(f"--out {folder}: is not empty and holds no earlier demo; give another folder")
    try:
        for name, _, _ in _STEPS:
            if (folder / name).exists():
                shutil.rmtree(folder / name)
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be cleared ({error.strerror})") from None


def _page(folder: Path, command: str, runs: list[Run], titles: list[str], compared: dict[str, SideBySide]) -> str:
    lines = [
        "# What `nearflat demo` found",
        "",
        f"Made by `{command}`. The numbers are in each `summary.json` and in `{COMPARED}`.",
    ]
    for run, title in zip(runs, titles, strict=True):
        lines += ["", f"## {title}", ""]
        lines += [f"- {line}" for line in run.scene.headline(run.summary)]
        if run.scene.name in compared:
            lines += [f"- {line}" for line in compared[run.scene.name].lines()]
        for path in sorted((folder / run.scene.name / "figures").glob("*.png")):
            lines += ["", *picture_lines(path, folder)]
    return "\n".join(lines) + "\n"


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of `nearflat demo`."""
    Demo.add_to(command)
    add_json(command)


def call(options: argparse.Namespace) -> int:
    """Run it, and say where it is."""
    given = Demo.of(given_to(Demo, options))
    runs = demo(given, options.quiet)
    if options.json:
        print(json.dumps({run.scene.name: run.summary for run in runs}))
    else:
        print(f"Pictures and numbers are in {given.out}; start with {given.out / 'README.md'}.")
    return 0
