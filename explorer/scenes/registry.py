"""The scenes by name, those of users among them, and scenes from what users write.

A scene of a user is known once `register` was called with it, or where an installed package names it as an entry
point of the group "nearflat.scenes": then it is known in every process.
"""

import inspect
import re
from collections.abc import Mapping
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any, TypeVar

from explorer.errors import InputError, one_of, shown
from explorer.phase.paths import read_toml
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


_OURS = frozenset(SCENES)
_GROUP = "nearflat.scenes"
_unloadable: dict[str, Exception] = {}
K = TypeVar("K", bound=type[Scene])


def register(scene: K) -> K:
    """Make a scene of your own known by its name, for `run` and for runs that are opened. Usable as a decorator.

    It then has what the scenes of nearflat have: chunks, resuming, workers of every kind, counts, a summary, help.
    An installed package may name it as an entry point of the group "nearflat.scenes" instead, which makes it known
    to the command line too.

    Parameters
    ----------
    scene : type
        A frozen dataclass derived from `explorer.scenes.base.SampledScene` or `Scene`, whose docstring says the
        question; it needs a `name`, `compute` and `summarise`. Another class of the same name takes its place.

    Returns
    -------
    type
        The same class.

    Raises
    ------
    InputError
        Where it is no such class, lacks something, or has the name of a scene of nearflat.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> import explorer as ex
    >>> from explorer.measure.sampling import chunk_stream
    >>> from explorer.scenes.base import SampledScene
    >>> @ex.register
    ... @dataclass(frozen=True, kw_only=True)
    ... class Coins(SampledScene):
    ...     "How often does a coin show heads?"
    ...     name = "coins"
    ...     def compute(self, index):
    ...         heads = chunk_stream(self.seed, index).random(self.length(index)) < 0.5
    ...         return {"heads": heads, "status": 0 * heads.astype("i1")}
    ...     def tally(self, index, table):
    ...         return {**super().tally(index, table), "heads": int(table["heads"].sum())}
    ...     def summarise(self, total):
    ...         return {"share": sum(tally["heads"] for tally in total) / self.samples}
    >>> round(ex.run("coins", samples=100_000).summary["share"], 2)
    0.5
    """
    if not (isinstance(scene, type) and issubclass(scene, Scene)):
        raise InputError(f"scene = {shown(scene)} is no scene; derive one from explorer.scenes.base.SampledScene")
    name = getattr(scene, "name", None)
    if not isinstance(name, str) or not re.fullmatch(r"[a-z][a-z0-9-]*", name):
        raise InputError(f'scene = {scene.__name__}: name = {name!r}; give a name such as "fall-times"')
    if name in _OURS and SCENES[name] is not scene:
        raise InputError(f"scene = {scene.__name__}: name = {name!r} is a scene of nearflat; give another name")
    if inspect.isabstract(scene):
        lacking = ", ".join(sorted(scene.__abstractmethods__))
        raise InputError(f"scene = {scene.__name__}: lacks {lacking}; write these methods")
    SCENES[name] = scene
    return scene


def scene_class(name: Any) -> type[Scene]:
    """The class of a scene, by its name or itself. Raises InputError with the nearest name."""
    if isinstance(name, type) and issubclass(name, Scene):
        return register(name) if name.name not in SCENES else name
    if isinstance(name, str) and name in _unloadable:
        raise InputError(f"scene {name!r}: the package that offers it cannot be loaded ({_unloadable[name]!r})")
    try:
        return SCENES[one_of("scene", name, SCENES)]
    except InputError as error:
        raise InputError(f"{error}. A scene of your own is known after ex.register(scene)") from None


def build_scene(name: Any, /, **options: Any) -> Scene:
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
        raise InputError(f"{path}: scene = {shown(content['scene'])} is not a name")
    return {key.replace("-", "_"): value for key, value in content.items()}


def _load_installed() -> None:
    """Register the scenes that installed packages offer; one that cannot be loaded harms no other."""
    for entry in entry_points(group=_GROUP):
        try:
            register(entry.load())
        except Exception as error:  # whatever it is, `scene_class` says it when it is asked
            _unloadable[entry.name] = error


_load_installed()
