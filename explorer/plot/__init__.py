"""Pictures. Each function takes ax=None and returns the Axes; none shows or touches global settings."""

from explorer.plot.bifurcation_portraits import bifurcation_portraits
from explorer.plot.bodies import race_bodies, race_gap, race_number
from explorer.plot.captions import caption_of, save
from explorer.plot.conservation import conservation
from explorer.plot.contact_forces import contact_forces
from explorer.plot.film import animate
from explorer.plot.general_solvers import missed_races
from explorer.plot.maps import constants_plane, slice_map, theta_min_distribution
from explorer.plot.measure_zero import constant_convergence, falling_ladder, ladder_ratio, tilt_density
from explorer.plot.near_flat import blow_up, limit_paths, race_collapse
from explorer.plot.one_sided import contact_paths, one_sided_chi, one_sided_distance, one_sided_phi
from explorer.plot.own import observable_map, race_angle_histogram
from explorer.plot.potential import phase_portrait, potential_curves
from explorer.plot.race import race_deviation, race_histogram
from explorer.plot.rocking import rocking_turns
from explorer.plot.rotation import rotation_map
from explorer.plot.sides import portrait_of_sides
from explorer.plot.sketch import definitions
from explorer.plot.slices import race_slice_map
from explorer.plot.steady import bifurcations, steady_map, steady_plane
from explorer.plot.strobe import hero
from explorer.plot.style import figure_of, stacked
from explorer.plot.surface import falling_surface, zoom_on_f
from explorer.plot.trade import work_precision
from explorer.plot.wander import rosette_and_resonance, wander_distance, wander_path, wander_radius

__all__ = [
    "animate",
    "bifurcation_portraits",
    "bifurcations",
    "blow_up",
    "caption_of",
    "conservation",
    "constant_convergence",
    "constants_plane",
    "contact_forces",
    "contact_paths",
    "definitions",
    "falling_ladder",
    "falling_surface",
    "figure_of",
    "hero",
    "ladder_ratio",
    "limit_paths",
    "missed_races",
    "observable_map",
    "one_sided_chi",
    "one_sided_distance",
    "one_sided_phi",
    "phase_portrait",
    "portrait_of_sides",
    "potential_curves",
    "race_angle_histogram",
    "race_bodies",
    "race_collapse",
    "race_deviation",
    "race_gap",
    "race_histogram",
    "race_number",
    "race_slice_map",
    "rocking_turns",
    "rosette_and_resonance",
    "rotation_map",
    "save",
    "slice_map",
    "stacked",
    "steady_map",
    "steady_plane",
    "theta_min_distribution",
    "tilt_density",
    "wander_distance",
    "wander_path",
    "wander_radius",
    "work_precision",
    "zoom_on_f",
]
