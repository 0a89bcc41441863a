import matplotlib
import numpy as np
import pytest
from conftest import BODIES, computed
from matplotlib.figure import Figure

import explorer as ex
from explorer import plot
from explorer.commands.trade import trade
from explorer.measure.log_counts import merged
from explorer.portrait.bodies import race_numbers
from explorer.portrait.both_sides import both_sides
from explorer.portrait.bounce import turn_per_bounce
from explorer.portrait.potential import on_line
from explorer.portrait.slices import Slice, map_slice, race_slice
from explorer.portrait.steady import bifurcation
from explorer.portrait.wander import wander, wander_path
from explorer.scenes.options import build_scene

UNIFORM = BODIES["uniform"]


def made(name, **options):
    scene = build_scene(name, **options)
    chunks = computed(scene)
    return scene, chunks, scene.summarise(chunks)


def measure_zero(folder):
    options = {"samples": 2000, "tube": 1024, "disk": "hoop"}
    return ex.run("measure-zero", out=folder / "run", **options).summary


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    race, races, race_summary = made("race-angles", samples=500)
    falling, states, _ = made("falling-set", samples=500)
    _, _, sides = made("one-sided", samples=1, disk="hoop")
    both = both_sides(BODIES["hoop"], (1.0, 1.0, 1))
    law = measure_zero(tmp_path_factory.mktemp("law"))
    beside = ex.constants_to_states(UNIFORM, 0.7, 0.01, 1.0)
    walk = wander_path(beside, 2)
    cut = map_slice(UNIFORM, Slice.defaults(UNIFORM)[1], 41)
    return {
        "race_histogram": (race_summary,),
        "race_deviation": (race.disk, {(i, j): n for t in races.tallies() for i, j, n in t["cells"]}, 1.8),
        "constants_plane": (falling.plane(falling._total(states).plane),),
        "theta_min_distribution": (merged(states, "theta_min"), 500),
        "slice_map": (cut,),
        "race_number": (race_numbers(),),
        "race_gap": (race_numbers(),),
        "bounce_turns": ([turn_per_bounce(UNIFORM)],),
        "wander_path": (walk,),
        "wander_distance": ({"generic": walk},),
        "wander_radius": (np.array([0.7]), wander(beside)),
        "race_slice_map": (race_slice(UNIFORM, Slice.defaults(UNIFORM)[0], 41),),
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
WHOLE = ("animate", "figure_of", "race_bodies", "rosette_and_resonance", "stacked")
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


@pytest.mark.parametrize("name", NAMES)
def test_each_picture_can_make_its_own_figure(name, pictures, tmp_path):
    figure = plot.figure_of(getattr(plot, name), *pictures[name])
    figure.savefig(tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 5000


def test_kappa_pi_is_drawn_in_the_histogram(pictures):
    ax = plot.race_histogram(*pictures["race_histogram"])
    drawn = [line.get_xdata()[0] for line in ax.lines]
    assert drawn == [UNIFORM.race_limit, -UNIFORM.race_limit]


def test_the_exact_lines_are_drawn_over_the_map_of_samples(pictures):
    ax = plot.constants_plane(*pictures["constants_plane"])
    slopes = [np.diff(line.get_ydata())[0] / np.diff(line.get_xdata())[0] for line in ax.lines]
    assert slopes == pytest.approx([0.7285923160189477, -0.7285923160189477])


def test_the_ladder_lies_on_its_line_and_off_the_others(pictures):
    """Data of the artists: the line C delta, two laws that it is not, and the estimates of the summary."""
    (summary,) = pictures["falling_ladder"]
    ax = plot.falling_ladder(summary)
    delta = np.array([row["delta"] for row in summary["ladder"]])
    line, square, plateau = (np.asarray(artist.get_ydata()) for artist in ax.lines[:3])
    np.testing.assert_allclose(line, summary["constant_predicted"] * delta)
    # Where it would be more than certain the law of dimension two is not drawn.
    assert (square[-10:] < 0.2 * line[-10:]).all()
    assert plateau[-1] == pytest.approx(1e-6, rel=1e-6)
    tubes = ax.containers[0].lines[0]
    np.testing.assert_allclose(tubes.get_ydata(), [row["estimate"] for row in summary["ladder"]])
    np.testing.assert_allclose(tubes.get_ydata()[3:], line[3:], rtol=0.1)


def test_the_convergence_ends_at_the_constant_of_the_summary(pictures):
    (summary,) = pictures["constant_convergence"]
    ax = plot.constant_convergence(summary)
    last = ax.containers[0].lines[0].get_ydata()[-1]
    assert last == pytest.approx(summary["constant"]["value"] / summary["constant_predicted"] - 1.0)
