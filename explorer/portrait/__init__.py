"""What the phase space looks like: the data of pictures. Each is drawn by a function of `explorer.plot`."""

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


def __dir__() -> list[str]:
    """The public names, without the files of this room."""
    return __all__
