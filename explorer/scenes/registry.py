"""The scenes by name, those of users among them."""

import sys
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar

from explorer.errors import InputError, one_of, shown
from explorer.phase.paths import read_toml
from explorer.scenes.scene import Scene

_HOMES = {
    "falling-set": ("falling_set", "FallingSet"),
    "measure-zero": ("measure_zero", "MeasureZero"),
    "one-sided": ("one_sided", "OneSided"),
    "portrait": ("portrait", "Portrait"),
    "race-angles": ("race_angles", "RaceAngles"),
}
NAMES = tuple(_HOMES)
_own: dict[str, type[Scene]] = {}
K = TypeVar("K", bound=type[Scene])


def register(scene: K) -> K:
    """Make a scene of your own known by its name, for `run` and for runs that are opened. Usable as a decorator.

    It then has what the scenes of nearflat have: chunks, resuming, workers of every kind, counts, a summary, help.
    `nearflat run my.py:Coins` does without it.

    Parameters
    ----------
    scene : type
        A class derived from `explorer.scenes.scene.SampledScene`, whose docstring says the question; it offers
        `draw` and `observe`, and mostly `count` and `summarise`. Another class of the same name takes its place.

    Returns
    -------
    type
        The same class.

    Raises
    ------
    InputError
        Where it is no such class, or has the name of a scene of nearflat.

    Examples
    --------
    >>> import explorer as ex
    >>> from explorer.scenes.scene import Counts, SampledScene
    >>> class CoinCounts(Counts):
    ...     heads: int
    >>> @ex.register
    ... class Coins(SampledScene):
    ...     "How often does a coin show heads?"
    ...     tally = CoinCounts
    ...     def draw(self, random, count):
    ...         return {"heads": random.random(count) < 0.5}
    ...     def observe(self, drawn):
    ...         return {**drawn, "status": 0 * drawn["heads"].astype("i1")}
    ...     def count(self, tally, table):
    ...         tally.heads += int(table["heads"].sum())
    ...     def summarise(self, tally):
    ...         return {"share": tally.heads / self.samples}
    >>> round(ex.run("coins", samples=100_000).summary["share"], 2)
    0.5
    """
    if not (isinstance(scene, type) and issubclass(scene, Scene)):
        raise InputError(f"scene = {shown(scene)} is no scene; derive one from explorer.scenes.scene.SampledScene")
    if scene.name in _HOMES and not scene.__module__.startswith("explorer."):
        raise InputError(f"scene = {scene.__name__}: {scene.name!r} is a scene of nearflat; give another name")
    if scene.name not in _HOMES:
        _own[scene.name] = scene
    return scene


def scene_class(name: Any) -> type[Scene]:
    """The class of a scene, by its name, by "FILE.py:CLASS", or itself. Raises InputError with what is known."""
    if isinstance(name, type):
        return register(name)
    if isinstance(name, str) and ".py:" in name:
        return register(_in_file(name))
    try:
        known = one_of("scene", name, [*_HOMES, *_own])
    except InputError as error:
        raise InputError(
            f"{error}. A scene of your own: nearflat run my.py:Scene, or ex.register(Scene)"
        ) from None
    if known in _own:
        return _own[known]
    home, kind = _HOMES[known]
    found: type[Scene] = getattr(import_module(f"explorer.scenes.{home}"), kind)
    return found


def _in_file(where: str) -> type[Scene]:
    """The class that "my.py:Scene" names; its folder becomes one that workers import from, too."""
    path, _, name = where.rpartition(":")
    file = Path(path).resolve()
    if not file.is_file():
        raise InputError(f"scene {where}: there is no file {path}")
    if str(file.parent) not in sys.path:
        sys.path.insert(0, str(file.parent))
    module = import_module(file.stem)
    if Path(str(module.__file__)).resolve() != file:
        raise InputError(f"scene {where}: {file.stem} is the name of another module; rename the file")
    own = {each: kind for each, kind in vars(module).items() if isinstance(kind, type) and issubclass(kind, Scene)}
    if name not in own:
        known = ", ".join(each for each, kind in own.items() if kind.__module__ == module.__name__)
        raise InputError(f"scene {where}: {name} is no scene there; known: {known}")
    return own[name]


def file_of(kind: type[Scene]) -> str | None:
    """ "FILE.py:CLASS" of a user's scene that another process can load in that way; None where there is none."""
    module = sys.modules.get(kind.__module__)
    file = getattr(module, "__file__", None)
    if kind.__module__.startswith("explorer.") or kind.__module__ == "__main__" or file is None:
        return None
    return f"{Path(file).resolve()}:{kind.__qualname__}"


def scene_of(options: dict[str, Any]) -> Scene:
    """The scene whose `options` these are. Raises InputError."""
    return scene_class(options["scene"]).of({key: value for key, value in options.items() if key != "scene"})


def read_scene_file(path: Path) -> dict[str, Any]:
    """Options from a TOML file that names a `scene`. Raises InputError."""
    content = read_toml(path, "SCENE")
    if not isinstance(content.get("scene"), str):
        raise InputError(f'{path}: names no scene; write scene = "race-angles" or another at its top')
    return {key.replace("-", "_"): value for key, value in content.items()}
