"""Runs: what a user holds, and how a scene becomes one, from its folder to its pictures."""

import time
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from explorer import compiled
from explorer.errors import (
    InputError,
    Interrupted,
    RunError,
    in_words,
    note,
    one_of,
    shorten,
    shown,
    words,
)
from explorer.phase.paths import path_of
from explorer.phase.results import to_arrow
from explorer.runs import folder as folders
from explorer.runs import inspect, pictures, store
from explorer.runs.chunks import Columns, Part, summary_of, tables, whole_scene
from explorer.runs.interrupt import graceful
from explorer.runs.lock import only_one
from explorer.runs.probes import require_room
from explorer.runs.progress import Progress
from explorer.runs.workers import Task, Workers
from explorer.scenes.base import NoStateError, Scene, Table

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def _read_parts(name: str, value: Any) -> tuple[Part, ...]:
    if not isinstance(value, Sequence) or not value or not all(isinstance(part, Part) for part in value):
        raise InputError(f"{name} = {shown(value)}: run(...), open(folder) and merge(...) make runs")
    return tuple(value)


class Run:
    """A run of a scene: its numbers, its samples and its pictures.

    `run`, `open` and `merge` give one. It is stored in a folder, or held in memory where it is small.

    Attributes
    ----------
    scene : Scene
        The question, with all its options.
    folder : Path or None
        Where the run is stored; None for one in memory and for several that are merged.

    Examples
    --------
    >>> import explorer as ex
    >>> races = ex.run("race-angles", disk="hoop", samples=1000)
    >>> races.summary["wrong_way"]
    0
    >>> float(races.arrow(["theta_min"])["theta_min"].to_numpy().max().round(4))
    0.0098
    >>> races.figure("histogram").axes[0].get_xscale()
    'symlog'
    """

    scene: Scene
    folder: Path | None

    def __init__(self, parts: Sequence[Part]) -> None:
        self._parts = _read_parts("parts", parts)
        self.scene = whole_scene(self._parts)
        self.folder = self._parts[0].folder if len(self._parts) == 1 else None
        self._known: tuple[Any, dict[str, Any]] | None = None
        self._summary: dict[str, Any] | None = None

    @property
    def parts(self) -> tuple[Part, ...]:
        """The runs that were merged; one, unless `merge` made it."""
        return self._parts

    @property
    def options(self) -> dict[str, Any]:
        """Scene and options: `run(**options)` asks the same question again."""
        return self.scene.options()

    @property
    def summary(self) -> dict[str, Any]:
        """The numbers of the run. Raises RunError where chunks are missing or damaged."""
        if self._summary is None and self._known is None and self.folder is not None:
            self._summary = inspect.stored_summary(self.folder, self.scene)
        return self._summary or self._total()[1]

    @property
    def status(self) -> inspect.Progressed:
        """How far the run is: chunks and samples done, counts of each status, what is missing."""
        return inspect.progressed(self._parts, self.scene)

    @property
    def pictures(self) -> list[str]:
        """The names of the pictures that `figure` draws."""
        total, summary = self._total()
        return [name for name, _ in self.scene.figures(summary, total)]

    def tables(self, columns: Columns = None) -> Iterator[Table]:
        """The kept samples chunk by chunk, in order, as arrays by name. Raises RunError where one is missing."""
        return tables(self._parts, None if columns is None else self._read(columns))

    def arrow(self, columns: Columns = None) -> "pa.Table":
        """The kept samples as an Arrow table; each field says its meaning, unit and equation in its metadata.

        columns: names, all by default. Raises InputError for a column that the run does not have.
        """
        import pyarrow as pa  # loaded only by those who ask for a table

        parts = map(to_arrow, self._checked(columns))
        try:
            # A user's own column of whole numbers may lack one in another chunk, and is of doubles there.
            return pa.concat_tables(parts, promote_options="permissive").unify_dictionaries()
        except pa.ArrowException as error:
            fault = shorten(" ".join(str(error).split()), 120)
            raise RunError(f"columns of chunks do not go together ({fault}); look at: verify()") from None

    def frame(self, columns: Columns = None) -> "pd.DataFrame":
        """The kept samples as a pandas DataFrame, status by name.

        columns: names, all by default. Raises InputError for a column that the run does not have.
        """
        return self.arrow(columns).to_pandas()

    def _checked(self, columns: Columns) -> Iterator[Table]:
        """The tables of those columns, in the order asked."""
        names = self._read(columns)
        return ({name: table[name] for name in names} for table in tables(self._parts, names))

    def _read(self, columns: Columns) -> list[str]:
        """Names of columns, all of them by default. Raises InputError for one that the run does not have."""
        known = [*next(tables(self._parts))]
        names = [*words("columns", columns)] if columns is not None else known
        return [one_of("column", name, known) for name in names] or known

    def figure(self, name: str, ax: "Axes | None" = None, **options: Any) -> "Figure":
        """One picture of the run.

        name: one of `pictures`. ax: where to draw; by default on a new figure. options: keywords of the function
        of `plot` that draws it, such as bins for "histogram". Raises InputError for an unknown name.
        """
        total, summary = self._total()
        return pictures.draw(self.scene.figures(summary, total), name, ax, options)

    def verify(self) -> list[str]:
        """Everything that is wrong with the run, a line each; an empty list where all is well."""
        return [in_words(fault) for part in self._parts for fault in inspect.faults(part)]

    def resume(self, jobs: int = 2, progress: bool | None = None) -> "Run":
        """Compute what is missing or damaged, and draw the pictures that are missing; returns the run itself."""
        if len(self._parts) > 1:
            raise InputError("resume: several runs were merged here; resume each of them")
        if self.folder is not None:
            execute(self.scene, self.folder, Manner(Workers(jobs), quiet=progress is False))
            self._known = self._summary = None
        return self

    def _total(self) -> tuple[Any, dict[str, Any]]:
        if self._known is None:
            self._known = summary_of(self._parts)
        return self._known

    def _lines(self) -> list[str]:
        """What the description says, a line each."""
        where = f"stored in {self.folder}" if self.folder else "in memory"
        far = self.status
        lines = [f"Run of {self.scene.name}, {len(self._parts)} merged" if len(self._parts) > 1 else ""]
        lines = [lines[0] or f"Run of {self.scene.name}, {where}"]
        if far.chunks_done < far.chunks:
            return [*lines, f"{far.chunks_done} of {far.chunks} chunks; resume() computes the others"]
        return [*lines, *map(in_words, self.scene.headline(self.summary))]

    def __repr__(self) -> str:
        return "\n  ".join(self._lines())

    def _repr_html_(self) -> str:
        import html

        first, *others = map(html.escape, self._lines())
        return f"<b>{first}</b><ul>{''.join(f'<li>{line}</li>' for line in others)}</ul>"


class Manner(NamedTuple):
    """How a run is made, and what it says and leaves beside its numbers.

    exist: what becomes of a run that is in the folder: "resume", "replace" or "error". formats: of the pictures,
    by default those that the run had; none are drawn where it is empty. command: the command line that asked for
    the run, for run.json.
    """

    workers: Workers
    exist: str = "resume"
    quiet: bool = True
    formats: tuple[str, ...] | None = None
    command: str | None = None


def execute(scene: Scene, out: Path | str | None, manner: Manner) -> Run:
    """Compute a scene into a folder, or into memory where `out` is None.

    Raises InputError before anything is written, RunError after. The numbers depend on the scene alone, never on
    workers or an interruption. The first Ctrl-C or SIGTERM lets running chunks finish; then Interrupted is raised,
    which says how to continue.
    """
    if out is None:
        part = Part(scene)
        compiled.warmup(scene.kernels, lambda text: note(text, manner.quiet))
        progress = Progress(scene.chunks(), scene.name, manner.quiet)
        _compute(part, list(range(scene.chunks())), manner, progress)
        progress.close()
        run = Run([part])
        run._total()
        return run
    folder = Path(out)
    highest = folders.highest_made(folder)
    new = folders.open_folder(folder, scene, manner.exist) or manner.exist == "replace"
    with only_one(folder):
        try:
            if manner.exist == "replace":
                folders.clear(folder)
            return _fill(Part(scene, folder), folder, manner)
        except InputError as error:
            # Only a run can tell that some input leads nowhere. What it has computed by then is kept, if anything.
            if new and (isinstance(error, NoStateError) or not any((folder / "chunks").glob("*.parquet"))):
                folders.take_back(folder, highest)
                raise
            raise RunError(f"{error} ({folder} holds what was computed)") from error


def _fill(part: Part, folder: Path, manner: Manner) -> Run:
    """Compute, store, summarise and draw what is not there."""
    clock, scene = time.monotonic(), part.scene
    missing = folders.missing_chunks(
        folder, scene, folders.digest_of_identity(scene), lambda text: note(text, manner.quiet)
    )
    begun = len(missing) < scene.chunks()
    require_room(scene, missing, folder, begun, lambda text: note(text, manner.quiet))
    before = folders.begun(folder, manner.command)
    other = folders.add_kind(before) if missing else None
    if other and len(missing) < scene.chunks():
        note(other, manner.quiet)
    names, formats = before.pop("figures", None), before.pop("formats", None) or pictures.FORMATS
    formats = formats if manner.formats is None else manner.formats
    drawn = [] if missing else pictures.there(folder, names, formats)
    how = {**before, "jobs": manner.workers.jobs, "backend": manner.workers.backend, "formats": formats}
    folders.write_record(folder, scene, finished=None, figures=drawn or None, **how)
    # Compiling takes long; what is stopped now can be resumed.
    called = (*scene.kernels, *(scene.kernels_of_figures if formats and not drawn else ()))
    compiled.warmup(called, lambda text: note(text, manner.quiet))
    progress = Progress(scene.chunks(), scene.name, manner.quiet)
    try:
        _compute(part, missing, manner, progress)
        seconds = round(time.monotonic() - clock, 3)
        run = Run([part])
        store.write_json(folder / "summary.json", run._total()[1])
        how["summary_digest"] = store.digest_of_file(folder / "summary.json")
        if formats and not drawn:
            drawn = _draw(run, folder, how, progress)
    finally:
        progress.close()
    done = {"finished": folders.now(), "chunks_computed": len(missing), "seconds_for_chunks": seconds}
    folders.write_record(folder, scene, figures=drawn, **how, **done)
    return run


def _draw(run: Run, folder: Path, how: dict[str, Any], progress: Progress) -> list[str]:
    """Draw all pictures into the folder. Ctrl-C stops at once: all samples are stored by then.

    run.json names their files first: whoever replaces a run that was stopped deletes these, and no others.
    """
    total, summary = run._total()
    try:
        figures = list(run.scene.figures(summary, total))
        files = pictures.files_of((name for name, _ in figures), how["formats"])
        how["pictures"] = list(dict.fromkeys([*how["pictures"], *files]))
        folders.write_record(folder, run.scene, finished=None, figures=None, **how)
        return pictures.save_all(figures, folder / "figures", how["formats"], progress)
    except KeyboardInterrupt:
        then = f"all samples are stored; continue with: nearflat resume {folder}"
        raise Interrupted(f"stopped while pictures were drawn; {then}") from None
    except Exception as error:
        if not pictures.is_of_matplotlib(error):
            raise
        raise RunError(
            f"pictures cannot be drawn ({shorten(str(error), 100)}), samples and numbers are "
            f"stored; change matplotlibrc or MPLBACKEND, then nearflat resume {folder}"
        ) from error


def _compute(part: Part, missing: list[int], manner: Manner, progress: Progress) -> None:
    """Compute the chunks that are missing."""
    scene, folder, done = part.scene, part.folder, 0
    progress.already(scene.chunks() - len(missing))
    made_by = compiled.source_digest(), folders.own_calibration(scene)
    task = Task(scene, folders.digest_of_identity(scene), folder, *made_by)
    with graceful(folder, manner.quiet) as stop:
        with closing(manner.workers.compute(task, missing, stop)) as chunks:
            try:
                for chunk in chunks:
                    done += 1
                    if chunk.held is not None:
                        part.held[chunk.number] = chunk.held
                    progress.advance(chunk.status)
            except KeyboardInterrupt:
                stop.set()
            except OSError:  # nobody reads what the run says; what is being computed is finished first
                stop.set()
                deque(chunks, maxlen=0)
                raise
        if stop.is_set() and done < len(missing):
            there = scene.chunks() - len(missing) + done
            how = f"continue with: nearflat resume {folder}" if folder else "nothing is kept without --out"
            raise Interrupted(f"stopped with {there} of {scene.chunks()} chunks done; {how}")


def open(folder: Path | str) -> Run:
    """Open a stored run, finished or not.

    Parameters
    ----------
    folder : path
        Of a run: the one that holds run.json.

    Returns
    -------
    Run

    Raises
    ------
    InputError
        Where there is no run, or one of a later version or of a scene that is not known here.

    Examples
    --------
    >>> import tempfile
    >>> import explorer as ex
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     made = ex.run("race-angles", samples=1000, out=folder, figures=False)
    ...     again = ex.open(folder)
    ...     print(again.verify(), again.summary == made.summary)
    [] True
    """
    place = path_of("folder", folder)
    return Run([Part(folders.scene_of(place), place)])
