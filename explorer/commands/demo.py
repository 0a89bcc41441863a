"""The main job, small: sample a million states, map F, compare the limits, histogram the race."""

import shutil
from pathlib import Path
from typing import Any

from explorer.errors import InputError, note
from explorer.motion.plan import method_in_words, plan
from explorer.runs import store
from explorer.runs.run import Run, execute
from explorer.runs.workers import Workers
from explorer.scenes.base import Scene
from explorer.scenes.options import build_scene

_MARK = "demo.json"
_STEPS: tuple[tuple[str, dict[str, Any], str], ...] = (
    ("falling-set", {"samples": 1_000_000}, "Where does the disk fall? A million states, {how}."),
    ("one-sided", {}, "What happens just beside the falling set? Two sides, two limit motions."),
    ("race-angles", {"samples": 200_000}, "How far does the contact point race round the rim?"),
)


def demo(out: Path | str = "results/demo", *, jobs: int = 2, seed: int = 0, quiet: bool = True) -> list[Run]:
    """Run the three scenes into folders below `out`, which an earlier demo may already fill.

    Raises InputError where `out` holds something else.
    """
    workers = Workers(jobs)
    folder = Path(out)
    made = [(build_scene(name, seed=seed, **options), title) for name, options, title in _STEPS]
    scenes = [(scene, title_of(scene, title)) for scene, title in made]
    _clear(folder)
    runs = []
    for scene, title in scenes:
        note(f"\n{title}", quiet)
        run = execute(scene, folder / scene.name, workers=workers, quiet=quiet)
        for line in scene.headline(run.summary):
            note(f"  {line}", quiet)
        if not (folder / _MARK).exists():
            store.write_json(folder / _MARK, {"made_by": "nearflat demo"})
        runs.append(run)
    (folder / "README.md").write_text(_page(runs, [title for _, title in scenes]), encoding="utf-8")
    return runs


def title_of(scene: Scene, title: str) -> str:
    """A title with what the scene's plan does in place of {how}."""
    return title.format(how=method_in_words(plan(scene.observables, scene.accuracy, scene.method).method))


def _clear(folder: Path) -> None:
    """Remove what an earlier demo left, and nothing else."""
    if not folder.exists() or (folder.is_dir() and not any(folder.iterdir())):
        return
    if not (folder / _MARK).exists():
        raise InputError(f"--out {folder}: is not empty and holds no earlier demo; give another folder")
    try:
        for name, _, _ in _STEPS:
            if (folder / name).exists():
                shutil.rmtree(folder / name)
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be cleared ({error.strerror})") from None


def _page(runs: list[Run], titles: list[str]) -> str:
    lines = [
        "# What `nearflat demo` found",
        "",
        "Made by `nearflat demo`. The numbers are in each `summary.json`.",
    ]
    for run, title in zip(runs, titles, strict=True):
        lines += ["", f"## {title}", ""]
        lines += [f"- {line}" for line in run.scene.headline(run.summary)]
        lines.append("")
        lines += [
            f"![{path.stem}]({run.scene.name}/figures/{path.name})"
            for path in sorted((run.folder / "figures").glob("*.png"))
        ]
    return "\n".join(lines) + "\n"


def summary_of(runs: list[Run]) -> dict[str, Any]:
    """All summaries, for --json."""
    return {run.scene.name: run.summary for run in runs}
