"""The scenes by name."""

from difflib import get_close_matches
from typing import TYPE_CHECKING

from explorer.errors import InputError

if TYPE_CHECKING:
    from explorer.scenes.base import Scene

SCENES = {
    "falling-set": ("explorer.scenes.falling_set", "FallingSet"),
    "measure-zero": ("explorer.scenes.measure_zero", "MeasureZero"),
    "one-sided": ("explorer.scenes.one_sided", "OneSided"),
    "portrait": ("explorer.scenes.portrait", "Portrait"),
    "race-angles": ("explorer.scenes.race_angles", "RaceAngles"),
}


def scene_class(name: str) -> "type[Scene]":
    """The class of a scene. Raises InputError with the nearest name."""
    if not isinstance(name, str) or name not in SCENES:
        near = get_close_matches(str(name), SCENES, n=1, cutoff=0.0)
        raise InputError(f"unknown scene {name!r}; did you mean {near[0]!r}? known: {', '.join(SCENES)}")
    module, attribute = SCENES[name]
    return getattr(__import__(module, fromlist=[attribute]), attribute)
