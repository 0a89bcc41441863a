"""The scenes by name, and scenes from what users write."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from explorer.errors import InputError, one_of, read_toml
from explorer.scenes.base import Scene
from explorer.scenes.falling_set import FallingSet
from explorer.scenes.measure_zero import MeasureZero
from explorer.scenes.one_sided import OneSided
from explorer.scenes.portrait import Portrait
from explorer.scenes.race_angles import RaceAngles

SCENES: dict[str, type[Scene]] = {
    kind.name: kind
    for kind in (
        FallingSet,
        MeasureZero,
        OneSided,
        Portrait,
        RaceAngles,
    )
}


def scene_class(name: Any) -> type[Scene]:
    """The class of a scene. Raises InputError with the nearest name."""
    return SCENES[one_of("scene", name, SCENES)]


def build_scene(name: str, **options: Any) -> Scene:
    """A validated scene. Options that are None keep the scene's default. Raises InputError."""
    return scene_class(name).of(options)


def scene_from_options(options: Mapping[str, Any]) -> Scene:
    """The scene whose `options()` these are. Raises InputError."""
    return build_scene(options["scene"], **{key: value for key, value in options.items() if key != "scene"})


def read_scene_file(path: Path) -> dict[str, Any]:
    """Options from a TOML file that names a `scene`. Raises InputError."""
    content = read_toml(path, "SCENE")
    if "scene" not in content:
        raise InputError(f'{path}: names no scene; write scene = "race-angles" or another at its top')
    if not isinstance(content["scene"], str):
        raise InputError(f"{path}: scene = {content['scene']!r} is not a name")
    return {key.replace("-", "_"): value for key, value in content.items()}
