"""Cases of pictures: each function of `explorer.plot`, with what it draws and with what it does not."""

from functools import cache

import numpy as np
from matplotlib.figure import Figure

import explorer as ex

from .values import nasty

# Keywords that matplotlib takes, and some that it does not.
LOOKS = ("color", "lw", "alpha", "cmap", "label", "zorder", "ms", "nonsense")
_COIN = ex.Disk.uniform()


@cache
def _beside():
    return ex.constants_to_states(_COIN, [0.6, 0.7], 0.05, 1.0)


@cache
def _on_f():
    return ex.both_sides(ex.constants_to_states(ex.Disk.hoop(), 1.0, 0.0, 1.0))


@cache
def _races():
    return ex.run("race-angles", samples=60)


@cache
def _law():
    return ex.run("measure-zero", samples=300, tube=64, disk="hoop").summary


@cache
def _cut():
    return ex.slice_map(_COIN, "phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2", points=5)


# What each draws, by the names of arguments; made when it is asked for.
SENSIBLE = {
    "bifurcations": lambda: {
        "disk": _COIN,
        "path": "line",
        "branches": ex.portrait.bifurcation(_COIN, "line", [0.1, 0.2]),
        "marks": [0.34],
    },
    "blow_up": lambda: {"several": ex.portrait.near_flat(_COIN, [1e-2, -1e-2])},
    "caption_of": lambda: {"figure": Figure()},
    "constants_plane": lambda: {"plane": ex.portrait.flattest_per_cell(_beside(), cells=4)},
    "contact_paths": lambda: {"both": _on_f()},
    "definitions": lambda: {"disk": _COIN},
    "figure_of": lambda: {"draw": Figure()},
    "limit_paths": lambda: {"several": ex.portrait.toward_limits(_COIN, [0.1])},
    "observable_map": lambda: {"found": ex.scan(_beside(), "theta_min"), "name": "theta_min"},
    "one_sided_chi": lambda: {"both": _on_f()},
    "one_sided_distance": lambda: {"summary": ex.run("one-sided", samples=1, disk="hoop").summary},
    "one_sided_phi": lambda: {"both": _on_f()},
    "phase_portrait": lambda: {"potential": ex.portrait.on_line(_COIN, 0.25), "energies": (0.5, 2.0)},
    "portrait_of_sides": lambda: {
        "plus": ex.portrait.on_line(_COIN, 0.25, 0.01),
        "minus": ex.portrait.on_line(_COIN, 0.25, -0.01),
        "energies": (1.0, 2.0),
    },
    "potential_curves": lambda: {"potentials": [ex.portrait.on_line(_COIN, 0.25, 0.01)], "near_flat": True},
    "race_angle_histogram": lambda: {
        "found": ex.passages(_COIN, 1.0, [1e-2, -1e-2], 1.0),
        "bins": 20,
        "range": (-8.0, 8.0),
        "disk": _COIN,
    },
    "race_bodies": lambda: {
        "numbers": ex.portrait.race_numbers(),
        "measured": ex.portrait.measured_gaps([_COIN]),
    },
    "race_collapse": lambda: {"several": ex.portrait.near_flat(_COIN, [1e-2, -1e-2])},
    "race_deviation": lambda: {"races": _races().summary},
    "race_gap": lambda: {"numbers": ex.portrait.race_numbers(), "measured": None},
    "race_histogram": lambda: {"races": _races().summary, "bins": 4, "range": (1e-6, 1e-2)},
    "race_number": lambda: {"numbers": ex.portrait.race_numbers(), "measured": None},
    "race_slice_map": lambda: {"cut": _cut()},
    "rosette_and_resonance": lambda: dict.fromkeys(
        ("generic", "resonant"), ex.portrait.wander_path(_beside()[0], 2)
    ),
    "rotation_map": lambda: {"rotation": ex.portrait.rotation_map(_COIN, 2.0, points=4)},
    "save": lambda: {"figure": Figure(), "path": "no such folder/x.png", "dpi": 50},
    "slice_map": lambda: {"cut": _cut()},
    "stacked": lambda: {"height": 6.0},
    "steady_map": lambda: {"disk": _COIN},
    "steady_plane": lambda: {"disk": _COIN},
    "theta_min_distribution": lambda: {"theta": np.geomspace(1e-5, 1.0, 300), "samples": 400},
    "wander_distance": lambda: {"named": {"generic": ex.portrait.wander_path(_beside()[0], 2)}},
    "wander_path": lambda: {"path": ex.portrait.wander_path(_beside()[0], 2)},
    "wander_radius": lambda: {
        "disk": _COIN,
        "sigma3_bar": np.array([0.6, 0.7]),
        "wander": ex.portrait.wander(_beside()),
        "resonances": {1: 0.65},
    },
    **dict.fromkeys(
        ("constant_convergence", "falling_ladder", "ladder_ratio", "tilt_density"), lambda: {"summary": _law()}
    ),
}
# Their data, or what they write, take long: they are given nothing that they could draw.
UNDRAWN = {
    "bifurcation_portraits": ("found",),
    "rocking_turns": ("bodies",),
    "zoom_on_f": ("zoomed",),
    "animate": ("path", "disk", "frames", "eta_hat"),
    "conservation": ("found",),
    "contact_forces": ("several",),
    "falling_surface": ("surface",),
    "hero": ("shown",),
    "missed_races": ("solved",),
    "work_precision": ("measured",),
}


@cache
def sensible(name):
    """Arguments of a picture that draw something, by name."""
    return SENSIBLE[name]() if name in SENSIBLE else {}


def case(name, rng):
    """Keyword arguments of one call of `plot.NAME`: one or two are often not what it draws."""
    given = dict(sensible(name))
    if name in UNDRAWN:
        return {argument: nasty(rng) for argument in UNDRAWN[name]}
    taken = ex.plot.__dict__[name] if name in ex.plot.__dict__ else getattr(ex.plot, name)
    words = taken.__wrapped__.__annotations__
    if "ax" in words and rng.random() < 0.2:
        given["ax"] = rng.choice((None, Figure().subplots(), nasty(rng)))
    if "look" in words and rng.random() < 0.3:
        given[rng.choice(LOOKS)] = nasty(rng)
    spoilt = rng.choices((0, 1, 2), (0.15, 0.7, 0.15))[0]
    for argument in rng.sample(list(given), min(spoilt, len(given))):
        given[argument] = nasty(rng)
    if rng.random() < 0.05:
        given.pop(next(iter(given)), None)
    return given
