"""Several runs of one question as one."""

from dataclasses import replace
from itertools import pairwise
from typing import Any

from explorer.errors import InputError, shown
from explorer.runs.folder import differing
from explorer.runs.run import Run

# In which runs of one question may differ
_FREE = ("seed", "samples", "chunk_size", "keep")


def merge(*runs: Run) -> Run:
    """Add up runs of the same question with different seeds.

    The counts are added up as if all samples were of one run. Nothing is copied: the runs stay
    where they are. Their order does not matter.

    Parameters
    ----------
    *runs : Run
        Finished runs of one scene. Their options may differ in `seed` (`rng`), `samples`, `chunk_size` and `keep`.

    Returns
    -------
    Run

    Raises
    ------
    InputError
        For runs of different questions, and for runs with the same seed, which share their samples.
    RunError
        If a run is not finished.

    Examples
    --------
    >>> import explorer as ex
    >>> both = ex.merge(*(ex.run("race-angles", samples=1000, rng=seed) for seed in (1, 2)))
    >>> both.summary["samples"], both.summary["seed"], both.summary["wrong_way"]
    (2000, [1, 2], 0)
    """
    for run in runs:
        if not isinstance(run, Run):
            raise InputError(f"{shown(run)} is no run; give runs one after the other: merge(one, two)")
    parts = sorted((part for run in runs for part in run.parts), key=lambda part: part.scene.seed)
    if len(parts) < 2:
        raise InputError(f"{len(parts)} runs were given; merge takes two or more")
    first = parts[0].scene
    if "samples" not in first.options or first.options.get("states") is not None:
        raise InputError(
            f"{first.name} draws no random samples here, so a second run adds nothing; use one of them"
        )
    for one, two in pairwise(parts):
        for key, here, there in differing(one.identity, two.identity):
            if key not in _FREE:
                differ = f"one run has {key} = {shown(here)}, another {shown(there)}"
                raise InputError(f"{differ}; only runs of the same question can be added up")
        if one.scene.seed == two.scene.seed:
            raise InputError(
                f"two runs have seed {one.scene.seed}, so one repeats samples of the other; give runs with "
                "different seeds. For more samples of one seed, run it again in its folder with resume and more "
                "samples"
            )
    for part in parts:
        part.complete()
    more: Any = {"samples": sum(part.scene.options["samples"] for part in parts)}
    return Run(replace(first, **more), parts=parts)
