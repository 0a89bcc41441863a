"""Runs: what a user holds, and how a scene becomes one, from its folder to its pictures."""

import contextlib
import html
import sys
import threading
import time
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tqdm import tqdm

from explorer import compiled
from explorer.errors import InputError, Interrupted, RunError, flag, note, one_of, printable, shorten, words
from explorer.measure.tallies import ByName
from explorer.paths import command_line, on_disk, path_of
from explorer.phase.results import Columns
from explorer.runs import folder as folders
from explorer.runs import store
from explorer.runs.estimate import require_room
from explorer.runs.interrupt import stopping
from explorer.runs.settings import FORMATS, Making, Settings, samples_of
from explorer.runs.workers import compute_all
from explorer.scenes.options import plain
from explorer.scenes.scene import Picture, Scene

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Names = Sequence[str] | None
_FIRST_LINE = 5.0  # seconds until a log file says how far a run is
_LINE = "{desc}: {percentage:.0f} %, {n_fmt} of {total_fmt} samples, {rate_fmt}, {remaining} left{postfix}"


@dataclass(frozen=True)
class Progressed:
    """How far a run is: chunks and samples done, of all; counts of each status; what of it is missing.

    missing: some of "chunks", "summary" and "figures", which were asked for and not all drawn.
    """

    scene: str
    chunks: int
    chunks_done: int
    samples_done: int
    status: dict[str, int]
    finished: str | None
    seconds_for_chunks: float | None
    missing: tuple[str, ...] = ()


class Run:
    """A run of a scene: its numbers, its samples and its pictures.

    `run`, `open` and `merge` return one. It is stored in a folder, or kept in memory if it is small.

    Attributes
    ----------
    scene : Scene
        The question, with all its options. If the run is stored, the scene is loaded only when it is needed, and
        one of a user only as `open` says.
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
    >>> races.figure("histogram").axes[0].get_xlabel()
    'race angle (rad)'
    """

    def __init__(
        self,
        scene: Scene | None = None,
        chunks: Sequence[store.Chunk] = (),
        folder: Path | None = None,
        parts: "Sequence[Run]" = (),
        trust: bool = False,
    ) -> None:
        self.folder, self._held, self._parts, self._trust = folder, chunks, parts, trust
        if scene is not None:
            self.scene = scene

    @cached_property
    def scene(self) -> Scene:
        return folders.stored_scene(self.folder, self.identity, self._trust)

    @property
    def _due(self) -> int:
        """How many chunks it has when it is finished."""
        return self.scene.chunks if self.folder is None else self.identity["chunks"]

    @property
    def parts(self) -> "tuple[Run, ...]":
        """The runs that were merged; the run itself, unless `merge` made it."""
        return tuple(self._parts) or (self,)

    @property
    def options(self) -> dict[str, Any]:
        """Scene and options: `run(**options)` asks the same question again."""
        return dict(self.identity["options"])

    @property
    def identity(self) -> dict[str, Any]:
        """All that decides the numbers of the run: its options, and digests of the code."""
        return folders.identity(self.scene) if self.folder is None else folders.read_record(self.folder)

    @property
    def chunks(self) -> list[store.Chunk]:
        """The stored chunks: all files that have the name of one; they may be damaged."""
        if self.folder is None:
            return list(self._held)
        return store.chunks_in(self.folder, folders.digest_of_identity(self.identity))

    def complete(self) -> list[store.Chunk]:
        """All chunks, in order. Raises RunError if one is missing, or if two have the same number.

        Examples
        --------
        >>> import explorer as ex
        >>> len(ex.run("race-angles", samples=100, chunk_size=64, progress=False).complete())
        2
        """
        if self._parts:
            return [chunk for part in self._parts for chunk in part.complete()]
        chunks, due = self.chunks, range(self._due)
        if [chunk.number for chunk in chunks] == list(due):
            return chunks
        missing = len({*due} - {chunk.number for chunk in chunks})
        fault = f"{missing} of {len(due)} chunks are missing" if missing else "some chunks are not its own"
        raise RunError(f"{self.folder}: {fault}; continue with: {command_line('resume', self.folder)}")

    @cached_property
    def _total(self) -> tuple[Any, dict[str, Any], set[str]]:
        """All that was counted, for pictures, the numbers, and the kinds of processors that computed them."""
        total, digests, kinds = self.scene.tally(), list[str](), set[str]()
        for part in self.parts:
            for said in map(store.Chunk.note, part.complete()):
                total += self.scene.tally.of_state(said["tally"])
                digests.append(said["digest"])
                kinds |= {said["arithmetic"]} if "arithmetic" in said else set()
        numbers = {**self.options, **plain(self.scene.summarise(total))}
        store.as_json(numbers)  # fails here where it is no JSON
        numbers["digest"] = store.sha256("".join(digests))
        if self._parts:
            numbers["seed"] = [part.scene.seed for part in self._parts]
        return total, numbers, kinds

    @property
    def summary(self) -> dict[str, Any]:
        """The numbers of the run. Raises RunError where chunks are missing or damaged."""
        return self._total[1]

    @property
    def headline(self) -> list[str]:
        """The numbers in a few lines of text."""
        return self.scene.headline(self.summary)

    @property
    def status(self) -> Progressed:
        """How far the run is: chunks and samples done, counts of each status, what is missing."""
        due, done, counts = 0, 0, ByName[int]()
        for part in self.parts:
            due += (own := part._due)
            for chunk in {chunk.number: chunk for chunk in part.chunks if chunk.number < own}.values():
                with contextlib.suppress(RunError):  # `verify` says what is wrong with it
                    counts += chunk.note()["tally"]["status"]
                    done += 1
        record = folders.read_record(self.folder) if self.folder else {}
        lacking = {
            "chunks": done < due,
            "figures": record.get("formats") and "finished" not in record,
            "summary": self.folder and not (self.folder / "summary.json").is_file(),
        }
        return Progressed(
            str(self.parts[0].identity["options"]["scene"]),
            due,
            done,
            sum(counts.values()),
            dict(counts),
            record.get("finished"),
            record.get("seconds_for_chunks"),
            tuple(name for name, is_so in lacking.items() if is_so),
        )

    @property
    def pictures(self) -> list[str]:
        """The names of the pictures that `figure` draws.

        Examples
        --------
        >>> import explorer as ex
        >>> races = ex.run("race-angles", samples=1000)
        >>> races.pictures
        ['histogram', 'deviation']
        """
        return list(self._pictures())

    def _pictures(self) -> dict[str, Picture]:
        total, summary, _ = self._total
        return dict(self.scene.figures(summary, total))

    def figure(self, name: str, ax: "Axes | None" = None, **options: Any) -> "Figure":
        """One picture of the run.

        name: one of `pictures`. ax: where to draw; by default on a new figure. options: keywords of the function
        of the picture that draws it, such as bins for "histogram". Raises InputError for an unknown name.

        Examples
        --------
        >>> import explorer as ex
        >>> races = ex.run("race-angles", samples=1000)
        >>> races.figure("histogram", bins=40).savefig("races.pdf")  # doctest: +SKIP
        """
        from explorer.pictures.register import whole_figure

        known = self._pictures()
        picture = known[one_of("figure", name, known)]
        return whole_figure(picture(**options) if ax is None else picture(ax=ax, **options))

    def tables(self, columns: Names = None) -> Iterator[Columns]:
        """The kept samples chunk by chunk, in order, as arrays by name. Raises RunError where one is missing.

        Examples
        --------
        >>> import explorer as ex
        >>> races = ex.run("race-angles", samples=1000)
        >>> [table["race_angle"].size for table in races.tables(["race_angle"])]
        [1000]
        """
        return map(store.table_of, self._rows(columns))

    def _rows(self, columns: Names) -> "Iterator[pa.Table]":
        """Some columns of all chunks, in order."""
        chunks = self.complete()
        known = chunks[0].columns()
        asked = () if columns is None else words("columns", columns)
        names = [one_of("column", name, known) for name in asked] or known
        return (chunk.arrow(names) for chunk in chunks)

    def arrow(self, columns: Names = None) -> "pa.Table":
        """The kept samples as an Arrow table; each field says its meaning, unit and equation in its metadata.

        columns: names, all by default. Raises InputError for a column that the run does not have.

        Examples
        --------
        >>> import explorer as ex
        >>> races = ex.run("race-angles", samples=1000)
        >>> races.arrow(["eta_hat", "race_angle"]).column_names
        ['eta_hat', 'race_angle']
        """
        import pyarrow as pa  # loaded only by those who ask for a table

        # A user's own column of whole numbers may lack one in another chunk, and is of doubles there.
        return pa.concat_tables(self._rows(columns), promote_options="permissive").unify_dictionaries()

    def frame(self, columns: Names = None) -> "pd.DataFrame":
        """The kept samples as a pandas DataFrame, status by name.

        columns: names, all by default. Raises InputError for a column that the run does not have.

        Examples
        --------
        >>> import explorer as ex
        >>> races = ex.run("race-angles", samples=1000)
        >>> races.frame(["eta_hat", "race_angle"]).shape
        (1000, 2)
        """
        return self.arrow(columns).to_pandas()

    def verify(self) -> list[str]:
        """Everything that is wrong with the run, a line each; an empty list where all is well.

        Examples
        --------
        >>> import explorer as ex
        >>> races = ex.run("race-angles", samples=1000)
        >>> races.verify()
        []
        """
        if self._parts:
            return [fault for part in self._parts for fault in part.verify()]
        chunks, due = self.chunks, self._due
        faults = [f"run.json: {each}" for each in self.changed()]
        missing = sorted({*range(due)} - {chunk.number for chunk in chunks})
        named = shorten(", ".join(map(str, missing)), 60)
        faults += [f"{len(missing):,} of {due:,} chunks are missing: {named}"] if missing else []
        looked_at = store.examined(chunks, due)
        faults += [f"{chunk.name}: {fault}" for chunk, fault in looked_at if fault]
        summary = self.folder and self.folder / "summary.json"
        if not faults and summary and summary.is_file():
            with contextlib.suppress(InputError):  # without the file of a user's scene nothing is added up
                if summary.read_bytes() != store.as_json(Run(folder=self.folder, trust=self._trust).summary):
                    faults.append("summary.json: does not belong to these chunks; run `nearflat summary`")
        return faults

    def changed(self) -> list[str]:
        """What has changed since the run was computed, in sentences; then it can be read, but not resumed.

        Examples
        --------
        >>> import explorer as ex
        >>> ex.run("race-angles", samples=1000).changed()
        []
        """
        if self._parts:
            return [each for part in self._parts for each in part.changed()]
        return folders.changed(self.identity) if self.folder else []

    def resume(self, **settings: Any) -> "Run":
        """Compute what is missing or damaged, and draw the pictures that are missing; returns the run itself.

        settings: how to compute, as for `run`: jobs, backend, scheduler, format, figures, progress.

        Examples
        --------
        >>> import explorer as ex
        >>> ex.run("race-angles", samples=100, progress=False).resume(progress=False).status.chunks_done
        1
        """
        if self._parts:
            raise InputError("several runs were merged here; resume each of them")
        shown = settings.pop("progress", True)
        Making.of(settings)  # refuses all other names
        if self.folder is not None:
            execute(self.scene, Settings.of({**settings, "progress": shown, "out": self.folder}))
            vars(self).pop("_total", None)
        return self

    def _lines(self) -> list[str]:
        """What the description says, a line each."""
        where = f"stored in {self.folder}" if self.folder else "in memory"
        far = self.status
        others = [f"{far.chunks_done} of {far.chunks} chunks; resume() computes the others"]
        if far.chunks_done == far.chunks:
            try:
                others = self.changed() or self.headline
            except InputError as error:
                others = [str(error)]
        name = self.parts[0].identity["options"]["scene"]
        return [f"Run of {name}, {f'{len(self._parts)} merged' if self._parts else where}", *others]

    def __repr__(self) -> str:
        return printable("\n  ".join(self._lines()))

    def _repr_html_(self) -> str:
        first, *others = map(html.escape, self._lines())
        return f"<b>{first}</b><ul>{''.join(f'<li>{line}</li>' for line in others)}</ul>"


def open(folder: Path | str, *, trust: bool = False) -> Run:
    """Open a stored run, finished or not.

    Parameters
    ----------
    folder : path
        Folder of the run, which holds run.json.
    trust : bool
        True if the file of a user's scene that run.json names may be run. Without it no code that a folder names
        is run: samples, counts and checks are read, but not what only the scene can say, its summary and pictures.

    Returns
    -------
    Run

    Raises
    ------
    InputError
        If there is no run, or one of another version. If its scene is not known here, the error comes only when
        the scene is needed; also if it may not be loaded.

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
    folders.read_record(place)
    return Run(folder=place, trust=flag("trust", trust))


def execute(scene: Scene, settings: Settings) -> Run:
    """Compute a run into its folder, or into memory where it has none.

    Raises InputError before anything is written, RunError after. The numbers depend on the scene alone, never on
    workers or an interruption. The first Ctrl-C or SIGTERM lets running chunks finish; then Interrupted is raised,
    which says how to continue. The second raises KeyboardInterrupt at once.
    """
    if settings.out is not None:
        with on_disk(settings.out), folders.opened(settings.out, scene, settings.exist) as (begun, record):
            return _fill(begun, settings, settings.out, record)
    compiled.warmup(scene.kernels, lambda text: note(text, not settings.progress))
    with stopping(settings.onward) as stop:
        held = sorted(_computed(scene, settings, list(range(scene.chunks)), stop), key=lambda chunk: chunk.name)
    run = Run(scene, held)
    _ = run.summary  # which may find that nothing can be said
    return run


def _fill(scene: Scene, settings: Settings, folder: Path, record: dict[str, Any]) -> Run:
    """Compute, store, summarise and draw what is not there. record: what run.json says of a run that was begun."""
    clock = time.monotonic()

    def say(text: str) -> None:
        note(text, not settings.progress)

    require_room(scene, settings, scene.chunks - len(store.files_in(folder / "chunks", store.NAME)))
    known: dict[str, Any] = {"command": None, "formats": FORMATS, "arithmetic": [], "pictures": ()} | record
    how: dict[str, Any] = {
        "started": known.get("started", folders.now()),
        "command": settings.command or known["command"],
        "jobs": settings.jobs,
        "backend": settings.backend,
        "formats": (settings.format or known["formats"] or FORMATS) if settings.figures else [],
        **{name: known[name] for name in ("arithmetic", "pictures")},
    }
    folders.write_record(folder, scene, how)
    missing = folders.missing_chunks(folder, scene, say)
    compiled.warmup(scene.kernels, say)  # takes long; what is stopped now can be resumed
    with stopping(settings.onward) as stop:
        run, summary = Run(scene, folder=folder), folder / "summary.json"
        try:
            deque(_computed(scene, settings, missing, stop) if missing else (), maxlen=0)
            found = store.as_json(run.summary)
        except (InputError, RunError) as error:
            far = run.status
            if not far.status.get("ok") and (isinstance(error, InputError) or far.chunks_done == far.chunks):
                folders.remove(folder)  # nothing comes of it: the command, mended, may use the folder
            raise
        how |= {"chunks_computed": len(missing), "seconds_for_chunks": round(time.monotonic() - clock, 3)}
        if summary.is_file() and summary.read_bytes() != found:
            folders.remove_pictures(folder, known["pictures"])  # of fewer samples
        store.write_json(summary, run.summary)
        how["arithmetic"] = kinds = sorted({*known["arithmetic"], *run._total[2]})
        if len(kinds) > 1:
            say(f"last digits, and the digest, depend on the kind of processor; of this run: {'; '.join(kinds)}")
        if how["formats"]:
            names = {f"{name}.{kind}" for name in run.pictures for kind in how["formats"]}
            missing_pictures = {name for name in names if not (folder / "figures" / name).exists()}
            how["pictures"] = sorted({*known["pictures"], *missing_pictures})
            folders.write_record(folder, scene, how)  # before they are there, so that they are known as ours
            _draw_missing(run, how["formats"], stop, settings.onward)
    folders.write_record(folder, scene, {**how, "finished": folders.now()})
    return run


def _draw_missing(run: Run, formats: Sequence[str], stop: threading.Event, onward: str) -> None:
    """Draw the pictures whose files are not there. Raises Interrupted where one is left once stopped."""
    from explorer.pictures.register import save

    folder = Path(run.folder or ".") / "figures"
    folder.mkdir(exist_ok=True)
    for name in run.pictures:
        missing = [path for kind in formats if not (path := folder / f"{name}.{kind}").is_file()]
        if not missing:
            continue
        if stop.is_set():
            raise Interrupted(f"all samples are stored, pictures are missing; {onward}")
        figure = run.figure(name)
        for path in missing:
            save(figure, begun := path.with_name(f".{path.name}"))
            begun.replace(path)
            # Parts stay where the first file has them: to place them is half the work. With a layout engine of any
            # kind, also "none", matplotlib would draw twice, once to let it place parts.
            figure.set_layout_engine(None)


class _Lines:
    """A log file, as tqdm writes to it: nothing can be drawn over, so each bar is a line of its own."""

    def write(self, text: str) -> None:
        note(text.strip(), quiet=not text.strip())


def _computed(
    scene: Scene, settings: Settings, missing: list[int], stop: threading.Event
) -> Iterator[store.Chunk]:
    """Compute the chunks that are missing, and show how far it is. Raises Interrupted."""
    due, count, counts = samples_of(scene), len(missing), ByName[int]()
    there = due - sum(map(scene.length, missing))
    how: dict[str, Any] = {"desc": scene.name, "unit": " samples", "unit_scale": True, "delay": 2.0}
    redrawn, begun = sys.stderr.isatty() or "ipykernel" in sys.modules, time.monotonic()
    if not redrawn:
        how |= {"file": _Lines(), "bar_format": _LINE, "leave": False, "miniters": 0, "mininterval": _FIRST_LINE}
    shown = tqdm(total=due, initial=there, disable=not settings.progress, **how)
    # An interrupt may keep this frame for long, in a notebook's traceback: what computes chunks ends all the same.
    with shown as bar, contextlib.closing(compute_all(scene, missing, settings, stop)) as made:
        for chunk, status in made:
            count -= 1
            counts = counts + status
            bar.set_postfix({name: n for name, n in counts.items() if name != "ok"}, refresh=False)
            bar.update(sum(status.values()))
            if not redrawn:  # a long run says less often how far it is: a day takes some forty lines
                bar.mininterval = max(_FIRST_LINE, 0.25 * (time.monotonic() - begun))
            yield chunk
    if count and stop.is_set():
        done = scene.chunks - count
        raise Interrupted(f"stopped with {done} of {scene.chunks} chunks done; {settings.onward}")
