"""Pictures. Each function takes ax=None and returns the Axes; none shows or touches global settings."""

from explorer.plot.falling import constants_plane, slice_map, theta_min_distribution
from explorer.plot.measure_zero import constant_convergence, falling_ladder, ladder_ratio, tilt_density
from explorer.plot.one_sided import contact_paths, one_sided_chi, one_sided_distance, one_sided_phi
from explorer.plot.race import race_deviation, race_histogram
from explorer.plot.style import figure_of, stacked
from explorer.plot.trade import work_precision

__all__ = [
    "constant_convergence",
    "constants_plane",
    "contact_paths",
    "falling_ladder",
    "figure_of",
    "ladder_ratio",
    "one_sided_chi",
    "one_sided_distance",
    "one_sided_phi",
    "race_deviation",
    "race_histogram",
    "slice_map",
    "stacked",
    "theta_min_distribution",
    "tilt_density",
    "work_precision",
]
