"""From a scene's name and options, as people give them, to the scene itself."""

import dataclasses
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from explorer.errors import InputError, read_toml
from explorer.measure.density import Density
from explorer.measure.sampling import Box, Range, parse_range, parse_ranges
from explorer.motion import plan as models
from explorer.phase.disk import Disk
from explorer.portrait.slices import Slice
from explorer.scenes.base import KEEP, SampledScene, Scene
from explorer.scenes.beside import check_box, default_box
from explorer.scenes.measure_zero import SAMPLING
from explorer.scenes.registry import scene_class
from explorer.scenes.state_file import StateFile

MOST_SAMPLES = 10**12
# Of compiled code and libraries, measured; and the bounds of a chunk (samples).
BASE_MEMORY = 450e6
SHARERS = 4
SMALLEST_CHUNK, LARGEST_CHUNK = 1 << 12, 1 << 20
_SEVERAL_DISKS = ("one-sided",)


def build_scene(
    name: str, *, disk: Any = None, seed: Any = 0, accuracy: Any = 1e-6, method: str = "auto", **options: Any
) -> Scene:
    """A validated scene. Options that are None keep the scene's default. Raises InputError."""
    kind = scene_class(name)
    fields = {field.name for field in dataclasses.fields(kind)}
    given = {key: value for key, value in options.items() if value is not None}
    for key in given:
        if key not in fields:
            raise InputError(f"--{key.replace('_', '-')}: {name} takes no such option")
    values: dict[str, Any] = {
        "disks": _disks(name, disk),
        "seed": whole("--seed", seed, 0, 2**128 - 1),
        "accuracy": _number("--accuracy", accuracy),
        "method": method,
    }
    models.plan(kind.observables, values["accuracy"], method)
    first = values["disks"][0]
    readers = {
        "samples": lambda value: whole("--samples", value, 1, MOST_SAMPLES),
        "chunk_size": lambda value: whole("chunk_size", value, 1, 10**8),
        "box": lambda value: _box(name, first, value),
        "max_energy": lambda value: _number("--max-energy", value),
        "eta_hat": lambda value: _range("--eta-hat", value),
        "slices": _slices,
        "keep": lambda value: _one_of("--keep", value, KEEP),
        "states": _states,
        "energy": Density.parse_energy,
        "gaussian": _text,
        "density": lambda value: value,
        "ladder": lambda value: _range("--ladder", value),
        "tube": lambda value: whole("--tube", value, 2, 10**9),
        "sampling": lambda value: _one_of("--sampling", value, SAMPLING),
        "grid": lambda value: whole("--grid", value, 2, 4000),
    }
    readers.update(kind.readers)
    values.update({key: readers[key](value) for key, value in given.items()})
    if "states" in values:
        _check_states(values)
    if issubclass(kind, SampledScene) and "samples" in values:
        values.setdefault("chunk_size", kind.default_chunk(values["samples"]))
    return kind(**values)


def _text(value: Any) -> str:
    """Gaussians as text; a mapping, as run.json has it, is written so."""
    if isinstance(value, dict):
        return ",".join(f"{name}={mean!r}:{deviation!r}" for name, (mean, deviation) in value.items())
    return str(value)


def _check_states(values: dict[str, Any]) -> None:
    for key in ("box", "max_energy"):
        if key in values:
            raise InputError(f"--{key.replace('_', '-')}: the states come from --states; leave it out")
    rows = values["states"].rows
    if values.setdefault("samples", rows) > rows:
        raise InputError(f"--samples {values['samples']}: --states holds {rows}; leave --samples out")


def _one_of(option: str, value: Any, known: tuple[str, ...]) -> str:
    if value not in known:
        raise InputError(f"{option} {value!r} is not known; choose {' or '.join(known)}")
    return value


def scene_from_options(options: dict[str, Any]) -> Scene:
    """The scene whose `options()` these are, from run.json. Raises InputError."""
    given = {key: value for key, value in options.items() if value is not None and key != "theta_min"}
    name = given.pop("scene")
    given["disk"] = [Disk(**numbers) for numbers in given.pop("disks")]
    if "box" in given:
        ends = {"phi": (0.0, 0.0), "sigma4": (0.0, 0.0)} | given["box"]
        given["box"] = Box(**{key: tuple(span) for key, span in ends.items()})
    if isinstance(given.get("density"), dict):
        raise InputError(
            "this run has a density that was given in Python; go on with run(..., density=..., resume=True) there"
        )
    if "slices" in given:
        several = [{key: tuple(span) for key, span in stored.items()} for stored in given["slices"]]
        given["slices"] = tuple(Slice(tuple(ranges.items())) for ranges in several)
    if "states" in given:
        stored = given["states"]
        given["states"] = StateFile.open(Path(stored["file"]))
        if given["states"].sha256 != stored["sha256"]:
            raise InputError(f"{stored['file']}: is not the file of states that the run began with")
    return build_scene(name, **given)


def chunk_size_for(kind: type[SampledScene], memory: Any, jobs: int) -> int:
    """The largest power of two of samples per chunk with which a few chunks at once fit into a budget.

    The same for all `jobs` up to SHARERS, so that the numbers do not depend on them.

    Raises InputError, with what is needed, where not even small chunks do.
    """
    budget, jobs = parse_memory(memory), max(jobs, SHARERS)
    least = BASE_MEMORY + jobs * SMALLEST_CHUNK * kind.bytes_per_sample
    if budget < least:
        raise InputError(
            f"--memory {memory}: {kind.name} with up to {jobs} jobs needs at least {least / 1e6:.0f}MB; give more"
        )
    fits = int((budget - BASE_MEMORY) / (jobs * kind.bytes_per_sample))
    return min(1 << (fits.bit_length() - 1), LARGEST_CHUNK)


def parse_memory(text: Any) -> float:
    """Bytes from "1GB", "500MB" or a number. Raises InputError."""
    match = re.fullmatch(r"\s*([0-9.eE+]+)\s*([KMGT]?)(?:i?B)?\s*", str(text), re.IGNORECASE)
    try:
        size = float(match[1]) * 1000.0 ** " KMGT".index(match[2].upper() or " ") if match else float(text)
        if not 0.0 < size < 1e18:
            raise ValueError(text)
        return size
    except (TypeError, ValueError):
        raise InputError(f"--memory {text!r} is no amount; write 1GB or 500MB") from None


def _states(value: Any) -> StateFile:
    return value if isinstance(value, StateFile) else StateFile.open(Path(str(value)))


def _disks(name: str, disk: Any) -> tuple[Disk, ...]:
    if disk is None:
        disk = ["uniform", "hoop", "matching"] if name in _SEVERAL_DISKS else ["uniform"]
    if not isinstance(disk, str | Disk | list | tuple):
        raise InputError(f"--disk {disk!r} is not a disk; give a Disk, a name, or a list of them")
    several = [disk] if isinstance(disk, str | Disk) else list(disk)
    if not several or (len(several) > 1 and name not in _SEVERAL_DISKS):
        raise InputError(f"--disk: {name} takes one disk, {len(several)} were given")
    return tuple(d if isinstance(d, Disk) else Disk.parse(str(d)) for d in several)


def _number(option: str, value: Any) -> float:
    if isinstance(value, bool):
        raise InputError(f"{option} {value} is not a number")
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{option} {value!r} is not a number") from None
    if not math.isfinite(number):
        raise InputError(f"{option} {value} must be a finite number")
    return number


def whole(option: str, value: Any, low: int, high: int) -> int:
    """A whole number written any way: 1000000, 1e6."""
    if isinstance(value, int) and not isinstance(value, bool):
        number: float | int = value
    elif isinstance(value, str) and value.strip().lstrip("+-").isdigit():
        number = int(value)
    else:
        number = _number(option, value)
    if number != int(number) or not low <= number <= high:
        raise InputError(f"{option} {value} must be a whole number from {low} to {high:g}")
    return int(number)


def _box(name: str, disk: Disk, value: Any) -> Box:
    if isinstance(value, Box):
        return value
    if name in ("falling-set", "measure-zero"):
        return Box.parse(str(value), Box.default(disk))
    box = Box.parse(str(value), default_box(disk))
    check_box(box, tuple(parse_ranges(str(value), "--box")), name)
    return box


def _range(option: str, value: Any) -> Range:
    if isinstance(value, str):
        return parse_range(value, option)
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise InputError(f"{option} {value!r} is not a range; give LOW:HIGH or a pair of numbers")
    return _number(option, value[0]), _number(option, value[1])


def _slices(value: str | Slice | Sequence[str | Slice]) -> tuple[Slice, ...]:
    several = [value] if isinstance(value, str | Slice) else value
    if not isinstance(several, list | tuple) or not all(isinstance(s, str | Slice) for s in several):
        raise InputError(f"--slice {value!r} is not a slice or a list of slices")
    return tuple(s if isinstance(s, Slice) else Slice.parse(s) for s in several)


def read_scene_file(path: Path) -> dict[str, Any]:
    """Options from a TOML file that names a `scene`. Raises InputError."""
    content = read_toml(path, "SCENE")
    if "scene" not in content:
        raise InputError(f'{path}: names no scene; write scene = "race-angles" or another at its top')
    if not isinstance(content["scene"], str):
        raise InputError(f"{path}: scene = {content['scene']!r} is not a name")
    return {key.replace("-", "_"): value for key, value in content.items()}
