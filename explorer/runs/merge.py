"""Several runs of one question as one."""

from itertools import pairwise

from explorer.errors import InputError, RunError, shown
from explorer.runs import folder as folders
from explorer.runs.chunks import Part
from explorer.runs.run import Run

# In what runs of one question may differ: who was drawn, how many, and how they were cut into chunks.
_FREE = ("seed", "samples", "chunk_size")


def merge(*runs: Run) -> Run:
    """Put runs of the same question with different seeds together.

    Their counts are added up as if they were one run, whose samples are those of all. Nothing is copied: the runs
    stay where they are. The order does not matter.

    Parameters
    ----------
    *runs : Run
        Finished runs of one scene. Their options may differ in `seed` (`rng`), `samples` and `chunk_size` only.

    Returns
    -------
    Run

    Raises
    ------
    InputError
        For runs of different questions, and for runs with the same seed, which share their samples.
    RunError
        Where a run is not finished.

    Examples
    --------
    >>> import explorer as ex
    >>> both = ex.merge(*(ex.run("race-angles", samples=1000, rng=seed) for seed in (1, 2)))
    >>> both.summary["samples"], both.summary["seed"], both.summary["wrong_way"]
    (2000, [1, 2], 0)
    """
    for run in runs:
        if not isinstance(run, Run):
            raise InputError(f'merge: {shown(run)} is no run; give what ex.run(...) or ex.open("folder") returns')
    parts = sorted((part for run in runs for part in run.parts), key=lambda part: part.scene.seed)
    if len(parts) < 2:
        raise InputError("merge: takes two runs or more; give them one after the other")
    for part in parts[1:]:
        _check_same_question(parts[0], part)
    for part, other in pairwise(parts):
        if part.scene.seed == other.scene.seed:
            raise InputError(
                f"merge: {part} and {other} both have seed {part.scene.seed}, so one repeats samples of the "
                "other; give runs with different seeds, or resume one of them with more samples"
            )
    for part in parts:
        part.complete()
    return Run(parts)


def _check_same_question(first: Part, other: Part) -> None:
    """Raise InputError unless the options agree that decide what is asked."""
    if first.scene.options().get("states") is not None:
        raise InputError(f"merge: {first} has the states of a file; give one run with the states of all files")
    one, two = first.scene.options(), other.scene.options()
    differing = [key for key in {**one, **two} if key not in _FREE and one.get(key) != two.get(key)]
    if differing:
        key = differing[0]
        raise InputError(
            f"merge: {first} has {key} = {one.get(key)}, {other} has {key} = {two.get(key)}; only runs of "
            "the same question can be added up"
        )
    first.scene.together([other.scene])
    if _kernels(first) != _kernels(other):
        raise RunError(f"merge: other kernels computed {other} than {first}; run one of them anew")


def _kernels(part: Part) -> object:
    """What computed a run."""
    if part.folder is None:
        return folders.identity(part.scene)["kernels"]
    return folders.read_record(part.folder)["identity"]["kernels"]
