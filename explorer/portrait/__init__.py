"""What the phase space looks like: the data of pictures. Each is drawn by a function of `explorer.plot`.

Names are loaded on first use: scenes take one file of this room or another, and commands start faster.
"""

import sys
from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from explorer.portrait.bifurcation_portraits import bifurcation_portraits
    from explorer.portrait.bodies import flat_body, measured_gaps, race_numbers
    from explorer.portrait.conservation import conservation
    from explorer.portrait.contact_forces import contact_forces
    from explorer.portrait.falling_surface import falling_surface, zoom
    from explorer.portrait.film import film
    from explorer.portrait.general_solvers import general_solvers
    from explorer.portrait.near_flat import near_flat, toward_limits
    from explorer.portrait.potentials import at_constants, on_line
    from explorer.portrait.races import race_law, race_ridges
    from explorer.portrait.rocking import rocking
    from explorer.portrait.rotation import rotation_map
    from explorer.portrait.slices import flattest_per_cell
    from explorer.portrait.steady import bifurcation, path_values
    from explorer.portrait.wander import resonance, wander, wander_path

# Every name with the file it comes from; some files have the name of their function.
_HOMES = {
    "at_constants": "potentials",
    "bifurcation": "steady",
    "bifurcation_portraits": "bifurcation_portraits",
    "conservation": "conservation",
    "contact_forces": "contact_forces",
    "falling_surface": "falling_surface",
    "film": "film",
    "flat_body": "bodies",
    "flattest_per_cell": "slices",
    "general_solvers": "general_solvers",
    "measured_gaps": "bodies",
    "near_flat": "near_flat",
    "on_line": "potentials",
    "path_values": "steady",
    "race_law": "races",
    "race_numbers": "bodies",
    "race_ridges": "races",
    "resonance": "wander",
    "rocking": "rocking",
    "rotation_map": "rotation",
    "toward_limits": "near_flat",
    "wander": "wander",
    "wander_path": "wander",
    "zoom": "falling_surface",
}

__all__ = [
    "at_constants",
    "bifurcation",
    "bifurcation_portraits",
    "conservation",
    "contact_forces",
    "falling_surface",
    "film",
    "flat_body",
    "flattest_per_cell",
    "general_solvers",
    "measured_gaps",
    "near_flat",
    "on_line",
    "path_values",
    "race_law",
    "race_numbers",
    "race_ridges",
    "resonance",
    "rocking",
    "rotation_map",
    "toward_limits",
    "wander",
    "wander_path",
    "zoom",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    return value


def __dir__() -> list[str]:
    """The public names, without the files of this room."""
    return __all__


class _Room(ModuleType):
    """This room, where no file takes the place of the function of its name when it is imported."""

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in _HOMES or not isinstance(value, ModuleType):
            super().__setattr__(name, value)

    def __reduce__(self) -> tuple[Callable[[str], ModuleType], tuple[str]]:
        """Packed by its name, like any module, for code of a user that travels to other processes."""
        return import_module, (self.__name__,)


sys.modules[__name__].__class__ = _Room
