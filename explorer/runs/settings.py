"""What users may say about a run beside its question: where it goes, who computes it, what it leaves."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any, NamedTuple, TypedDict

import numpy as np

from explorer.errors import InputError, flag, jobs_of, note, one_of, shown, whole
from explorer.phase.paths import path_of
from explorer.runs import pictures
from explorer.runs.folder import default_folder
from explorer.runs.run import Manner
from explorer.runs.workers import BACKENDS, Workers
from explorer.scenes.base import SampledScene, Scene, chunk_size_for, read_memory
from explorer.scenes.options import Option, options_of
from explorer.scenes.registry import SCENES, build_scene, scene_class

EXIST = ("resume", "replace", "error")
# What a run in memory may draw: some hundred megabytes where all rows are kept.
MOST_IN_MEMORY = 1_000_000


def _text(flag: str, value: Any) -> str:
    if not isinstance(value, str):
        raise InputError(f"{flag} {shown(value)} is no text; give the address of a scheduler")
    return value


def read_rng(name: str, value: Any) -> int:
    """A seed from an int, or from a SeedSequence or Generator of numpy, which give 128 bits. Raises InputError."""
    if isinstance(value, np.random.SeedSequence):
        plain = not value.spawn_key and isinstance(value.entropy, int) and value.entropy < 2**128
        words = [value.entropy] if plain else value.generate_state(4).tolist()
    elif isinstance(value, np.random.Generator):
        words = value.integers(0, 2**32, 4, dtype=np.uint32).tolist()
    else:
        try:
            return whole(name, value, high=2**128 - 1)
        except InputError as error:
            raise InputError(f"{error}; or a SeedSequence or Generator of numpy") from None
    return int(sum(int(word) << (32 * place) for place, word in enumerate(words)))


class Settings(TypedDict, total=False):
    """Keywords of `run` that change no number, and `rng`."""

    out: Annotated[
        Path | str | None,
        Option(
            "--out",
            path_of,
            "DIR",
            "folder of the run",
            default=f"results/SCENE-DISK-SEED; from Python, up to {MOST_IN_MEMORY:,} samples stay in memory",
        ),
    ]
    exist: Annotated[
        str,
        Option(
            "exist",
            partial(one_of, known=EXIST),
            "WHAT",
            'what becomes of a run that the folder holds: "resume" computes what is missing, and nothing where it '
            'is finished; "replace" starts anew; "error" refuses',
            default='"resume"',
        ),
    ]
    jobs: Annotated[int, Option("--jobs", jobs_of, "N", "workers; they change no number", default="2")]
    backend: Annotated[
        str,
        Option(
            "--backend", partial(one_of, known=BACKENDS), "NAME", "threads, processes or dask", default="threads"
        ),
    ]
    scheduler: Annotated[
        str | None,
        Option("--scheduler", _text, "ADDRESS", "address of a dask scheduler", "one of its own"),
    ]
    memory: Annotated[
        str | float | None,
        Option(
            "--memory",
            read_memory,
            "SIZE",
            "budget such as 1GB; sets the chunk size, which is stored with the run",
        ),
    ]
    figures: Annotated[bool, Option("figures", flag, "", "whether pictures are drawn into the folder", "True")]
    format: Annotated[
        str | Sequence[str],
        Option("--format", pictures.read_formats, "KINDS", "formats of the pictures: png, svg, pdf", "png,svg"),
    ]
    progress: Annotated[
        bool | None,
        Option(
            "progress",
            flag,
            "",
            "False prints nothing; else a bar on a terminal or in a notebook, elsewhere a line every few seconds",
        ),
    ]
    rng: Annotated[
        int | np.random.SeedSequence | np.random.Generator,
        Option("rng", read_rng, "", "the random numbers: another name of `seed`, which takes what numpy takes"),
    ]


SETTINGS = options_of(Settings)


class Asked(NamedTuple):
    """A run that was asked for: its scene, its folder if it has one, and how it is made."""

    scene: Scene
    out: Path | None
    manner: Manner


def asked(name: Any, given: Mapping[str, Any], command: str | None = None, exist: str = "resume") -> Asked:
    """The run that scene and keywords ask for, of Python, of the command line or of a TOML file.

    command: the command line, where there is one; then the run always has a folder. exist: what becomes of a run
    in the folder, unless it is said. Raises InputError.
    """
    rest, said = dict(given), dict[str, Any]()
    for option in SETTINGS:
        value = rest.pop(option.word, None)
        if value is not None:
            said[option.word] = option.read(option.flag, value)
    quiet = said.get("progress") is False
    if "rng" in said:
        if rest.get("seed") is not None:
            raise InputError(f"rng and seed = {rest['seed']} say the same; leave one of them out")
        rest["seed"] = said["rng"]
    workers = Workers(said.get("jobs", 2), said.get("backend", "threads"), said.get("scheduler"))
    scene = name if isinstance(name, Scene) else _scene(name, rest, given.get("memory"), workers.jobs, quiet)
    out = said.get("out")
    if out is None and (command is not None or not _fits_in_memory(scene)):
        out = default_folder(scene)
        note(f"a run above {MOST_IN_MEMORY:,} samples is stored: it is in {out}", quiet or command is not None)
    formats = said.get("format") if said.get("figures", True) else ()
    return Asked(scene, out, Manner(workers, said.get("exist", exist), quiet, formats, command))


def _fits_in_memory(scene: Scene) -> bool:
    chunks = scene.chunks()
    return chunks <= MOST_IN_MEMORY and sum(map(scene.length, range(chunks))) <= MOST_IN_MEMORY


def _scene(name: Any, options: Mapping[str, Any], memory: Any, jobs: int, quiet: bool) -> Scene:
    """The scene of a run, with chunks that fit into a budget where one is given."""
    if memory is None:
        return build_scene(name, **options)
    kind = scene_class(name)
    if not issubclass(kind, SampledScene):
        names = ", ".join(each for each, other in SCENES.items() if issubclass(other, SampledScene))
        raise InputError(f"--memory {memory}: sets the chunks of {names}, {kind.name} has none; leave it out")
    if options.get("chunk_size") is not None:
        raise InputError(f"--memory {memory}: sets chunk_size, which is given too; leave one of them out")
    size = chunk_size_for(kind, memory, jobs)
    note(f"--memory {memory}: chunks of {size:,} samples", quiet)
    return build_scene(name, **{**options, "chunk_size": size})
