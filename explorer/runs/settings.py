"""What users may say about a run beside its question: where it goes, who computes it, what it leaves."""

from collections.abc import Mapping
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any, ClassVar

from explorer.errors import InputError, one_of, words
from explorer.paths import command_line
from explorer.scenes.options import FOLDER, TEXT, TRUTH, Options, Reader, option, options_of, word_of, workers
from explorer.scenes.scene import Scene, scene_class

FORMATS, KNOWN_FORMATS = ("png", "svg"), ("png", "svg", "pdf")
# What a run in memory may draw: some hundred megabytes where all rows are kept.
MOST_IN_MEMORY = 1_000_000
MOST_CHUNKS = 1_000_000  # of a run: their numbers have six digits, so that files sorted by name are in order
# Of records and of the command line, beside those of options
_WORDS = ("scene", "help", "json", "quiet", "resume", "replace", "command", "command_line", "call")


def read_formats(name: str, value: Any) -> tuple[str, ...]:
    """Read formats of pictures: "png,svg", or a list of names. Raises InputError."""
    names = value.split(",") if isinstance(value, str) else words(name, value)
    return tuple(dict.fromkeys(one_of(name, each.strip().lower(), KNOWN_FORMATS) for each in names))


class Making(Options):
    """How the run is computed and stored, without effect on its numbers."""

    name: ClassVar[str] = "resume"  # which takes these alone

    jobs: int = workers("number of workers; results do not depend on it")
    backend: str = option(word_of("threads", "processes", "dask"), "kind of workers", default="threads")
    scheduler: str | None = option(
        TEXT._replace(metavar="ADDRESS"), "address of a dask scheduler", words="a scheduler that the run starts"
    )
    overfill: bool = option(TRUTH, "begin even if the disk has too little room", default=False)
    figures: bool = option(TRUTH, "draw pictures into the folder", default=True)
    format: tuple[str, ...] | None = option(
        Reader(read_formats, "KINDS", "str | Sequence[str]"),
        "formats of the pictures: png, svg, pdf",
        words="png,svg",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.scheduler is not None and self.backend != "dask":
            raise InputError(f"scheduler {self.scheduler}: is for backend dask; give both")
        if self.backend == "dask" and find_spec("distributed") is None:
            raise InputError("backend dask: needs the extra 'cluster': pip install 'nearflat[cluster]'")


class Settings(Making):
    """Where a run goes."""

    command: str | None = None  # the command line that asked for it, if one did
    out: Path | None = option(
        FOLDER,
        "folder of the run",
        words=f"results/SCENE-DISK-SEED; from Python, up to {MOST_IN_MEMORY:,} samples stay in memory",
    )
    exist: str = option(
        word_of("resume", "replace", "error")._replace(metavar=None),
        'what to do if the folder already holds a run: "resume" computes what is missing, "replace" computes '
        'everything anew, "error" refuses',
        default="resume",
    )
    progress: bool = option(
        TRUTH._replace(metavar=None),
        "False prints nothing; otherwise a bar, or lines in a log file, appear if the run takes over some seconds",
        default=True,
    )

    @property
    def onward(self) -> str:
        """How to go on with a run that was stopped."""
        if self.out is None:
            return "nothing is kept unless out names a folder"
        by = ["--backend", "dask"] if self.backend == "dask" else []
        to = ["--scheduler", self.scheduler] if self.scheduler else []
        return f"continue with: {command_line('resume', self.out, *by, *to)}"


def asked(name: Any, given: Mapping[str, Any], command: str | None = None) -> tuple[Scene, Settings]:
    """The run that scene and keywords ask for, of Python, of the command line or of a TOML file.

    name: as `scene_class` takes it. command: the command line, where there is one; then the run always has a
    folder. Raises InputError.
    """
    said = {name: value for name, value in given.items() if value is not None}
    known = {each.name for each in options_of(Settings)}
    settings = Settings.of({name: said.pop(name) for name in [*said] if name in known})
    kind = scene_class(name)
    taken = {*_WORDS, *known} & {each.name for each in options_of(kind)}
    if taken:
        raise InputError(
            f"scene {kind.__name__}: {min(taken)} is the name of a setting of runs; give your option another name"
        )
    scene = kind.of(said)
    if scene.chunks > MOST_CHUNKS:
        size = 1 << (scene.options.get("samples", 0) // MOST_CHUNKS).bit_length()
        remedy = f"chunk_size {size} or more" if hasattr(scene, "chunk_size") else "fewer samples"
        raise InputError(f"samples: make {scene.chunks:,} chunks, at most {MOST_CHUNKS:,} are held; give {remedy}")
    if settings.out is None and (command is not None or samples_of(scene) > MOST_IN_MEMORY):
        settings = replace(settings, out=Path(f"results/{scene.name}-{scene.label}-{scene.seed}"))
    return scene, replace(settings, command=command)


def samples_of(scene: Scene) -> int:
    """How many samples all chunks of a scene stand for."""
    return sum(map(scene.length, range(scene.chunks)))
