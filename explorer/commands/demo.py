"""`nearflat demo`: the main job, small: sample a million states, map F, compare the limits, histogram the race."""

import argparse
from pathlib import Path
from typing import Any

from explorer import compiled
from explorer.commands import Answer
from explorer.errors import MOST_JOBS, InputError, note
from explorer.motion.plan import method_in_words
from explorer.runs.run import execute
from explorer.runs.settings import Settings
from explorer.runs.side_by_side import exact_of, in_words, side_by_side
from explorer.runs.store import write_json
from explorer.scenes.options import FOLDER, Options, option, whole_from
from explorer.scenes.scene import SampledScene, scene_class

PAGE, COMPARED = "README.md", "side-by-side.json"
# The main job: Runge-Kutta kernels, the fastest of them where a little accuracy is asked. Pictures of races look
# at 1e-7 rad.
_INTEGRATED: dict[str, Any] = {"method": "rk8", "accuracy": 1e-3}
_LOOKED_AT: dict[str, Any] = {"method": "rk8", "accuracy": 1e-8}
_STEPS: tuple[tuple[str, dict[str, Any], str], ...] = (
    ("falling-set", {"samples": 1_000_000, **_INTEGRATED}, "Where does the disk fall? A million states, {how}."),
    ("one-sided", {}, "What happens close to the falling set? Two sides, two limit motions."),
    (
        "race-angles",
        {"samples": 200_000, **_LOOKED_AT},
        "How far does the contact point race round the rim? Passages {how}.",
    ),
)
_BESIDE = {"falling-set": "theta_min", "race-angles": "race_angle"}  # what the exact layer computes, too


class Demo(Options):
    """Where the demo goes, and how."""

    # git does not look there: a demo leaves a checkout as it was
    out: Path = option(FOLDER, "folder", default=Path("results/demo"))
    jobs: int = option(whole_from(1, MOST_JOBS), "threads", default=2)
    seed: int = option(whole_from(0, 2**128 - 1, "S"), "seed of the random streams", default=0)


add_arguments = Demo.add_to


def call(options: argparse.Namespace) -> Answer:
    """Run the three scenes into folders below `out`, which an earlier demo may already fill.

    Raises InputError where it holds something else.
    """
    from explorer.commands.pages import write_page

    given, quiet = Demo.of(Demo.said(options)), options.quiet
    out, own = given.out, {*(name for name, _, _ in _STEPS), COMPARED, PAGE}
    if out.exists() and not (out.is_dir() and {path.name for path in out.iterdir()} <= own):
        raise InputError(f"out {out}: is not empty and holds no earlier demo; give another folder")
    scenes = [scene_class(name).of({"seed": given.seed, **options}) for name, options, _ in _STEPS]
    exact = [exact_of(scene) for scene in scenes if isinstance(scene, SampledScene)]
    kernels = [name for scene in (*scenes, *exact) for name in scene.kernels]  # so that all is compiled at once
    compiled.warmup(kernels, lambda text: note(text, quiet))
    summaries, compared = dict[str, Any](), dict[str, dict[str, Any]]()
    parts = list[tuple[str, list[str], list[Path]]]()
    how = {"jobs": given.jobs, "format": "png", "exist": "replace", "progress": not quiet}
    for scene, (name, _, title) in zip(scenes, _STEPS, strict=True):
        title = title.format(how=method_in_words(scene.plan.method))
        note(f"\n{title}", quiet)
        run = execute(scene, Settings.of({**how, "out": out / name}))
        summaries[name], lines = run.summary, run.headline
        if isinstance(scene, SampledScene):
            compared[name] = side_by_side(scene, _BESIDE[name], jobs=given.jobs)
            lines += in_words(compared[name])
        note("\n".join(f"  {line}" for line in lines), quiet)
        parts.append((title, [f"- {line}" for line in lines], sorted((out / name / "figures").glob("*.png"))))
    write_json(out / COMPARED, compared)
    made_by = f"`{options.command_line}`. The numbers are in each `summary.json` and in `{COMPARED}`."
    write_page(out, "What `nearflat demo` found", made_by, parts)
    return Answer(summaries, f"Pictures and numbers are in {out}; start with {out / PAGE}.")
