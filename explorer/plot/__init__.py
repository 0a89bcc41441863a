"""Pictures. Each function takes ax=None and returns the Axes; none shows or touches global settings.

Names are loaded on first use: a run draws pictures of one or two kinds.
"""

from typing import TYPE_CHECKING

from explorer.lazy import make_lazy

if TYPE_CHECKING:
    from explorer.plot.bifurcation_portraits import bifurcation_portraits as bifurcation_portraits
    from explorer.plot.bodies import race_bodies as race_bodies
    from explorer.plot.bodies import race_gap as race_gap
    from explorer.plot.bodies import race_number as race_number
    from explorer.plot.captions import caption_of as caption_of
    from explorer.plot.captions import save as save
    from explorer.plot.conservation import conservation as conservation
    from explorer.plot.contact_forces import contact_forces as contact_forces
    from explorer.plot.film import animate as animate
    from explorer.plot.general_solvers import missed_races as missed_races
    from explorer.plot.maps import constants_plane as constants_plane
    from explorer.plot.maps import slice_map as slice_map
    from explorer.plot.maps import theta_min_distribution as theta_min_distribution
    from explorer.plot.measure_zero import constant_convergence as constant_convergence
    from explorer.plot.measure_zero import falling_ladder as falling_ladder
    from explorer.plot.measure_zero import ladder_ratio as ladder_ratio
    from explorer.plot.measure_zero import tilt_density as tilt_density
    from explorer.plot.near_flat import blow_up as blow_up
    from explorer.plot.near_flat import limit_paths as limit_paths
    from explorer.plot.near_flat import race_collapse as race_collapse
    from explorer.plot.one_sided import contact_paths as contact_paths
    from explorer.plot.one_sided import one_sided_chi as one_sided_chi
    from explorer.plot.one_sided import one_sided_distance as one_sided_distance
    from explorer.plot.one_sided import one_sided_phi as one_sided_phi
    from explorer.plot.own import observable_map as observable_map
    from explorer.plot.own import race_angle_histogram as race_angle_histogram
    from explorer.plot.potential import phase_portrait as phase_portrait
    from explorer.plot.potential import potential_curves as potential_curves
    from explorer.plot.race import race_deviation as race_deviation
    from explorer.plot.race import race_histogram as race_histogram
    from explorer.plot.rocking import rocking_turns as rocking_turns
    from explorer.plot.rotation import rotation_map as rotation_map
    from explorer.plot.sides import portrait_of_sides as portrait_of_sides
    from explorer.plot.sketch import definitions as definitions
    from explorer.plot.slices import race_slice_map as race_slice_map
    from explorer.plot.steady import bifurcations as bifurcations
    from explorer.plot.steady import steady_map as steady_map
    from explorer.plot.steady import steady_plane as steady_plane
    from explorer.plot.strobe import hero as hero
    from explorer.plot.style import figure_of as figure_of
    from explorer.plot.style import stacked as stacked
    from explorer.plot.surface import falling_surface as falling_surface
    from explorer.plot.surface import zoom_on_f as zoom_on_f
    from explorer.plot.trade import work_precision as work_precision
    from explorer.plot.wander import rosette_and_resonance as rosette_and_resonance
    from explorer.plot.wander import wander_distance as wander_distance
    from explorer.plot.wander import wander_path as wander_path
    from explorer.plot.wander import wander_radius as wander_radius

__all__ = make_lazy(__name__)
