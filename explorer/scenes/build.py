"""From a scene's name and options, as people give them, to the scene itself."""

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from explorer import models
from explorer.disk import Disk
from explorer.errors import InputError
from explorer.sampling import Box, Range, parse_range, parse_ranges
from explorer.scenes.base import Scene
from explorer.scenes.beside import check_box, default_box
from explorer.scenes.falling_set import Slice
from explorer.scenes.registry import scene_class

MOST_SAMPLES = 10**12
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
        "seed": _whole("--seed", seed, 0, 2**128 - 1),
        "accuracy": _number("--accuracy", accuracy),
        "method": method,
    }
    models.plan(kind.observables, values["accuracy"], method)
    first = values["disks"][0]
    readers = {
        "samples": lambda value: _whole("--samples", value, 1, MOST_SAMPLES),
        "chunk_size": lambda value: _whole("chunk_size", value, 1, 10**8),
        "box": lambda value: _box(name, first, value),
        "max_energy": lambda value: _number("--max-energy", value),
        "eta_hat": lambda value: _range("--eta-hat", value),
        "slices": _slices,
        "grid": lambda value: _whole("--grid", value, 2, 4000),
    }
    values.update({key: readers[key](value) for key, value in given.items()})
    return kind(**values)


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


def _whole(option: str, value: Any, low: int, high: int) -> int:
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
    if name == "falling-set":
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
    from explorer.disk import read_toml

    content = read_toml(path, "SCENE")
    if "scene" not in content:
        raise InputError(f'{path}: names no scene; write scene = "race-angles" or another at its top')
    if not isinstance(content["scene"], str):
        raise InputError(f"{path}: scene = {content['scene']!r} is not a name")
    return {key.replace("-", "_"): value for key, value in content.items()}
