"""What the phase space looks like: the data of pictures. Each is drawn by a function of `explorer.plot`.

Names are loaded on first use: scenes take one file of this room or another, and commands start faster.
"""

from typing import TYPE_CHECKING

from explorer.lazy import make_lazy

if TYPE_CHECKING:
    from explorer.portrait.bifurcation_portraits import bifurcation_portraits as bifurcation_portraits
    from explorer.portrait.bodies import flat_body as flat_body
    from explorer.portrait.bodies import measured_gaps as measured_gaps
    from explorer.portrait.bodies import race_numbers as race_numbers
    from explorer.portrait.conservation import conservation as conservation
    from explorer.portrait.contact_forces import contact_forces as contact_forces
    from explorer.portrait.falling_surface import falling_surface as falling_surface
    from explorer.portrait.falling_surface import zoom as zoom
    from explorer.portrait.film import film as film
    from explorer.portrait.general_solvers import general_solvers as general_solvers
    from explorer.portrait.near_flat import near_flat as near_flat
    from explorer.portrait.near_flat import toward_limits as toward_limits
    from explorer.portrait.potentials import at_constants as at_constants
    from explorer.portrait.potentials import on_line as on_line
    from explorer.portrait.races import race_law as race_law
    from explorer.portrait.races import race_ridges as race_ridges
    from explorer.portrait.rocking import rocking as rocking
    from explorer.portrait.rotation import rotation_map as rotation_map
    from explorer.portrait.slices import flattest_per_cell as flattest_per_cell
    from explorer.portrait.steady import bifurcation as bifurcation
    from explorer.portrait.steady import path_values as path_values
    from explorer.portrait.wander import resonance as resonance
    from explorer.portrait.wander import wander as wander
    from explorer.portrait.wander import wander_path as wander_path

__all__ = make_lazy(__name__)
