"""Pictures. Each function takes ax=None and returns the Axes; none shows or touches global settings."""

from explorer.plot.falling import constants_plane, slice_map, theta_min_distribution
from explorer.plot.measure_zero import constant_convergence, falling_ladder, ladder_ratio, tilt_density
from explorer.plot.one_sided import contact_paths, one_sided_chi, one_sided_distance, one_sided_phi
from explorer.plot.portrait import bifurcations, phase_portrait, potential_curves, steady_map, steady_plane
from explorer.plot.race import race_deviation, race_histogram
from explorer.plot.style import figure_of, stacked
from explorer.plot.trade import work_precision

__all__ = [
    "bifurcations",
    "constant_convergence",
    "constants_plane",
    "contact_paths",
    "falling_ladder",
    "figure_of",
    "ladder_ratio",
    "one_sided_chi",
    "one_sided_distance",
    "one_sided_phi",
    "phase_portrait",
    "potential_curves",
    "race_deviation",
    "race_histogram",
    "slice_map",
    "stacked",
    "steady_map",
    "steady_plane",
    "theta_min_distribution",
    "tilt_density",
    "work_precision",
]
