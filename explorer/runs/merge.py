"""Several runs of one question as one."""

from explorer.errors import InputError, RunError, shown
from explorer.runs.run import Run


def merge(*runs: Run) -> Run:
    """Put runs of the same question with different seeds together.

    Their counts are added up as if they were one run, whose samples are those of all. Nothing is copied: the runs
    stay where they are. The order does not matter.

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
    made = Run(parts[0].scene.together([part.scene for part in parts[1:]]), parts=parts)
    for part in parts:
        part.complete()
        for what in ("kernels", "code"):
            if part.identity[what] != parts[0].identity[what]:
                raise RunError(f"merge: other {what} computed {part.place} than {parts[0].place}; run one anew")
    return made
