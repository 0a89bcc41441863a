"""All pictures: each draws where it is told to, names its axes, and claims nothing that was not done."""

import matplotlib
import numpy as np
import pytest
from conftest import BODIES, computed
from matplotlib.figure import Figure
from matplotlib.text import Text

import explorer as ex
from explorer import plot
from explorer.commands.trade import trade
from explorer.phase.states import constants_to_states
from explorer.portrait.bodies import race_numbers
from explorer.portrait.both_sides import both_sides
from explorer.portrait.near_flat import near_flat
from explorer.portrait.potential import on_line
from explorer.portrait.rocking import rocking
from explorer.portrait.rotation import rotation_map
from explorer.portrait.slices import Slice, slice_map
from explorer.portrait.steady import bifurcation
from explorer.portrait.wander import wander, wander_path
from explorer.scenes.registry import build_scene

UNIFORM = BODIES["uniform"]


def made(name, **options):
    scene = build_scene(name, **options)
    total = computed(scene)
    return scene, total, scene.summarise(total)


def measure_zero(folder):
    options = {"samples": 2000, "tube": 1024, "disk": "hoop"}
    return ex.run("measure-zero", out=folder / "run", **options).summary


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    race, races, race_summary = made("race-angles", samples=500)
    falling, states, _ = made("falling-set", samples=500)
    _, _, sides = made("one-sided", samples=1, disk="hoop")
    both = both_sides(constants_to_states(BODIES["hoop"], 1.0, 0.0, 1.0))
    law = measure_zero(tmp_path_factory.mktemp("law"))
    beside = ex.constants_to_states(UNIFORM, 0.7, 0.01, 1.0)
    walk = wander_path(beside, 2)
    cut = slice_map(UNIFORM, Slice.defaults(UNIFORM)[1], points=41)
    return {
        "race_histogram": (race_summary,),
        "race_deviation": (race.disk, races.cells, 1.8),
        "constants_plane": (falling.plane(states.plane),),
        "theta_min_distribution": (states.theta_min, 500),
        "slice_map": (cut,),
        "rotation_map": (rotation_map(UNIFORM, 2.0, points=10),),
        "race_collapse": (near_flat(UNIFORM, [1e-2, -1e-2]),),
        "observable_map": (cut,),
        "race_angle_histogram": ({"race_angle": [7.0, -7.0], "side": [1, -1]},),
        "race_number": (race_numbers(),),
        "race_gap": (race_numbers(),),
        "rocking_turns": ([rocking(UNIFORM)],),
        "wander_path": (walk,),
        "wander_distance": ({"generic": walk},),
        "wander_radius": (UNIFORM, np.array([0.7]), wander(beside)),
        "race_slice_map": (slice_map(UNIFORM, Slice.defaults(UNIFORM)[0], points=41),),
        "one_sided_distance": (sides,),
        "one_sided_phi": (both,),
        "one_sided_chi": (both,),
        "contact_paths": (both,),
        "phase_portrait": (on_line(UNIFORM, 0.25),),
        "potential_curves": ([on_line(UNIFORM, 0.25, eta) for eta in (0.0, 0.01)],),
        "steady_plane": (UNIFORM,),
        "steady_map": (UNIFORM,),
        "bifurcations": (UNIFORM, "line", bifurcation(UNIFORM, "line", [0.1, 0.2, 0.3, 0.4]), (0.34,)),
        "work_precision": (trade(UNIFORM, 1024),),
        **dict.fromkeys(("falling_ladder", "ladder_ratio", "constant_convergence", "tilt_density"), (law,)),
    }


# Those that make a whole figure or a film are looked at where their data are tested.
WHOLE = (
    "animate",
    "blow_up",
    "definitions",
    "falling_surface",
    "figure_of",
    "hero",
    "limit_paths",
    "missed_races",
    "race_bodies",
    "rosette_and_resonance",
    "stacked",
    "zoom_on_f",
)
NAMES = [name for name in plot.__all__ if name not in WHOLE]


@pytest.mark.parametrize("name", NAMES)
def test_each_picture_draws_on_the_axes_given_labels_them_and_changes_nothing_global(name, pictures):
    before = dict(matplotlib.rcParams)
    ax = Figure().subplots()
    got = getattr(plot, name)(*pictures[name], ax=ax)
    assert got is ax
    assert ax.get_xlabel()
    assert ax.get_ylabel()
    assert dict(matplotlib.rcParams) == before
    ax.figure.canvas.draw()


@pytest.mark.rendered
@pytest.mark.parametrize("name", NAMES)
def test_each_picture_can_make_its_own_figure(name, pictures, tmp_path):
    figure = plot.figure_of(getattr(plot, name), *pictures[name])
    figure.savefig(tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 5000


@pytest.mark.parametrize("name", NAMES)
def test_no_picture_of_what_was_not_integrated_says_so(name, pictures):
    """All tilts here come by quadrature; how motions in time were followed, no picture says."""
    figure = plot.figure_of(getattr(plot, name), *pictures[name])
    assert not [text for text in figure.findobj(Text) if "integrated" in text.get_text()]
