"""`nearflat demo`: the main job, small: sample a million states, map F, compare the limits, histogram the race."""

import argparse
from pathlib import Path
from typing import Any

from explorer import compiled
from explorer.commands import Answer
from explorer.errors import note
from explorer.motion.bounces import bounce_kernels
from explorer.motion.compare import compare
from explorer.motion.plan import plan
from explorer.paths import own_folder
from explorer.runs.run import execute
from explorer.runs.settings import Settings
from explorer.scenes.falling_set import FallingSet
from explorer.scenes.options import FOLDER, Options, option, seeded, workers
from explorer.scenes.scene import scene_class

PAGE, STATES = "README.md", 1_000_000
# The main job: Runge-Kutta kernels, the fastest of them where a little accuracy is asked. Pictures of races look
# at 1e-7 rad.
_STEPS: tuple[tuple[str, dict[str, Any], str], ...] = (
    (
        "falling-set",
        {"samples": STATES, "method": "rk8", "accuracy": 1e-3},
        "Where does the disk fall? A million states, integrated with rk8.",
    ),
    ("one-sided", {}, "What happens close to the falling set? Two sides, two limit motions."),
    (
        "race-angles",
        {"samples": 200_000, "method": "rk8", "accuracy": 1e-8},
        "How far does the contact point race round the rim? Passages integrated with rk8.",
    ),
)
_COMPARED = ("quadrature", "rk8"), "A million states followed to their next approach to flat, by two methods."


class Demo(Options):
    """Where the demo goes, and how."""

    # git does not look there: a demo leaves a checkout as it was
    out: Path = option(FOLDER, "folder", default=Path("results/demo"))
    jobs: int = workers("threads")
    seed: int = seeded()


add_arguments = Demo.add_to


def call(options: argparse.Namespace) -> Answer:
    """Run the three scenes into folders below `out`, which an earlier demo may already fill.

    Raises InputError where it holds something else.
    """
    from explorer.commands.pages import write_page

    given, quiet = Demo.of(Demo.said(options)), options.quiet
    out = own_folder("out", given.out)
    scenes = [scene_class(name).of({"seed": given.seed, **options}) for name, options, _ in _STEPS]
    methods, compared = _COMPARED
    called = [bounce_kernels(plan(("race_angle",), 1e-3, method)) for method in methods]
    kernels = [name for names in (*called, *(scene.kernels for scene in scenes)) for name in names]
    compiled.warmup(kernels, lambda text: note(text, quiet))  # all at once
    summaries, parts = dict[str, Any](), list[tuple[str, list[str], list[Path]]]()
    how = {"jobs": given.jobs, "format": "png", "exist": "replace", "progress": not quiet}
    for scene, (name, _, title) in zip(scenes, _STEPS, strict=True):
        note(f"\n{title}", quiet)
        run = execute(scene, Settings.of({**how, "out": out / name}))
        summaries[name], lines = run.summary, run.headline
        note("\n".join(f"  {line}" for line in lines), quiet)
        parts.append((title, [f"- {line}" for line in lines], sorted((out / name / "figures").glob("*.png"))))
    note(f"\n{compared}", quiet)
    found = compare(FallingSet.of({}).first_states(STATES, given.seed), methods, accuracy=1e-3, jobs=given.jobs)
    note(str(found), quiet)
    parts.append((compared, ["```text", str(found), "```"], []))
    made_by = f"`{options.command_line}`. The numbers are in each `summary.json`."
    write_page(out, "What `nearflat demo` found", made_by, parts)
    return Answer(summaries, f"Pictures and numbers are in {out}; start with {out / PAGE}.")
