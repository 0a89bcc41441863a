"""`nearflat demo`: the main job, small: sample a million states, map F, compare the limits, histogram the race."""

import argparse
import json
import shlex
import shutil
from dataclasses import asdict
from pathlib import Path
from typing import Any

from explorer import compiled
from explorer.commands.common import add_json
from explorer.commands.gallery import picture_lines
from explorer.commands.made_by import FILE, command_of, leave_made_by
from explorer.errors import InputError, note
from explorer.motion.plan import method_in_words
from explorer.phase.paths import path_of
from explorer.runs.run import Manner, Run, execute
from explorer.runs.side_by_side import SideBySide, exact_of, side_by_side
from explorer.runs.store import write_json
from explorer.runs.workers import Workers
from explorer.scenes.base import SampledScene, Scene
from explorer.scenes.registry import build_scene

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


def demo(out: Path | str = _OUT, *, jobs: int = 2, seed: int = 0, quiet: bool = True) -> list[Run]:
    """Run the three scenes into folders below `out`, which an earlier demo may already fill.

    Raises InputError where `out` holds something else.
    """
    workers = Workers(jobs)
    folder = path_of("--out", out)
    command = shlex.join(
        [
            *_COMMAND.split(),
            *(["--out", str(out)] if str(out) != _OUT else []),
            *(["--seed", str(seed)] if seed else []),
        ]
    )
    made = [(build_scene(name, seed=seed, **options), title) for name, options, title in _STEPS]
    scenes = [(scene, title_of(scene, title)) for scene, title in made]
    _clear(folder)
    compiled.warmup(_kernels([scene for scene, _ in scenes]), lambda text: note(text, quiet))
    runs: list[Run] = []
    compared: dict[str, SideBySide] = {}
    for scene, title in scenes:
        note(f"\n{title}", quiet)
        run = execute(scene, folder / scene.name, Manner(workers, "error", quiet, ("png",)))
        for line in scene.headline(run.summary):
            note(f"  {line}", quiet)
        if scene.name in _BESIDE and isinstance(scene, SampledScene):
            column, relative = _BESIDE[scene.name]
            compared[scene.name] = side_by_side(scene, column, relative=relative, jobs=workers.jobs)
            for line in compared[scene.name].lines():
                note(f"  {line}", quiet)
        if not (folder / FILE).exists():
            leave_made_by(folder, command)
        runs.append(run)
    write_json(folder / COMPARED, {name: asdict(both) for name, both in compared.items()})
    (folder / "README.md").write_text(
        _page(folder, command, runs, [title for _, title in scenes], compared), encoding="utf-8"
    )
    return runs


def _kernels(scenes: list[Scene]) -> tuple[str, ...]:
    """All that the runs, their pictures and their comparisons call, so that everything is compiled at once."""
    exact = [exact_of(scene) for scene in scenes if scene.name in _BESIDE and isinstance(scene, SampledScene)]
    names = [name for scene in (*scenes, *exact) for name in scene.kernels]
    return *names, *(name for scene in scenes for name in scene.kernels_of_figures)


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


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of `nearflat demo`."""
    command.add_argument("--out", default=_OUT, metavar="DIR", help=f"folder (default {_OUT})")
    command.add_argument("--jobs", default=2, metavar="N", help="threads (default 2)")
    command.add_argument("--seed", default=0, metavar="S", help="seed of the random streams (default 0)")
    add_json(command)


def call(options: argparse.Namespace) -> int:
    runs = demo(options.out, jobs=options.jobs, seed=options.seed, quiet=options.quiet)
    if options.json:
        print(json.dumps({run.scene.name: run.summary for run in runs}))
    else:
        print(f"Pictures and numbers are in {options.out}; start with {Path(options.out) / 'README.md'}.")
    return 0
