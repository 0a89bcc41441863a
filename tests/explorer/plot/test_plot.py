"""All pictures: each draws where it is told to, names its axes, and can be read."""

import re

import matplotlib
import numpy as np
import pytest
from conftest import BODIES
from matplotlib.artist import Artist
from matplotlib.colors import is_color_like, to_hex
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.text import Text

import explorer as ex
from explorer import plot
from explorer.plot.style import BEYOND, SIGN_COLOURS

UNIFORM = BODIES["uniform"]


OF_THE_LAW = ("falling_ladder", "ladder_ratio", "constant_convergence", "tilt_density")


pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def pictures(tmp_path_factory, traded):
    """What each picture draws, all of it from public calls."""
    races = ex.run("race-angles", samples=500).summary
    states = ex.phi_to_states(UNIFORM, *np.random.default_rng(0).uniform(-1.0, 1.0, (4, 500)))
    both = ex.both_sides(ex.constants_to_states(BODIES["hoop"], 1.0, 0.0, 1.0))
    law = ex.run("measure-zero", samples=2000, tube=1024, disk="hoop", out=tmp_path_factory.mktemp("law") / "run")
    beside = ex.constants_to_states(UNIFORM, 0.7, 0.01, 1.0)
    walk = ex.portrait.wander_path(beside, 2)
    cut = ex.slice_map(UNIFORM, "phi=-1.35:1.35,phidot=0.05,sigma3=0.15,sigma4=-0.8:0.8", points=41)
    upright = ex.slice_map(UNIFORM, "phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2", points=41)
    numbers, line = ex.portrait.race_numbers(), ex.portrait.on_line(UNIFORM, 0.25)
    branches = ex.portrait.bifurcation(UNIFORM, "line", [0.1, 0.2, 0.3, 0.4])
    return {
        "race_histogram": (races,),
        "race_deviation": (races,),
        "constants_plane": (ex.portrait.flattest_per_cell(states),),
        "theta_min_distribution": (ex.scan(states, "theta_min")["theta_min"], 500),
        "slice_map": (cut,),
        "rotation_map": (ex.portrait.rotation_map(UNIFORM, 2.0, points=10),),
        "race_collapse": (ex.portrait.near_flat(UNIFORM, [1e-2, -1e-2]),),
        "observable_map": (cut,),
        "race_angle_histogram": (ex.passages(UNIFORM, 1.0, [1e-2, -1e-2], 1.0),),
        "race_number": (numbers,),
        "race_gap": (numbers, ex.portrait.measured_gaps([UNIFORM])),
        "rocking_turns": ([ex.portrait.rocking(UNIFORM)],),
        "wander_path": (walk,),
        "wander_distance": ({"generic": walk},),
        "wander_radius": (UNIFORM, np.array([0.7]), ex.portrait.wander(beside)),
        "race_slice_map": (upright,),
        "one_sided_distance": (ex.run("one-sided", samples=1, disk="hoop").summary,),
        "one_sided_phi": (both,),
        "one_sided_chi": (both,),
        "contact_paths": (both,),
        "phase_portrait": (line,),
        "potential_curves": ([line, ex.portrait.on_line(UNIFORM, 0.25, 0.01)],),
        "steady_plane": (UNIFORM,),
        "steady_map": (UNIFORM,),
        "bifurcations": (UNIFORM, "line", branches, (0.34,)),
        "work_precision": (traded.parts[0],),
        **dict.fromkeys(OF_THE_LAW, (law.summary,)),
    }


# Those that make a whole figure or a film are looked at where their data are tested.
WHOLE = (
    "animate",
    "bifurcation_portraits",
    "blow_up",
    "conservation",
    "contact_forces",
    "definitions",
    "falling_surface",
    "hero",
    "limit_paths",
    "missed_races",
    "portrait_of_sides",
    "race_bodies",
    "rosette_and_resonance",
    "zoom_on_f",
)
# Those of them that are quickly made are held to what others are held to.
SLOW = ("animate", "conservation", "contact_forces", "hero", "missed_races")
OF_A_FIGURE = [name for name in WHOLE if name not in SLOW]
TOOLS = ("caption_of", "figure_of", "save", "stacked")
NAMES = [name for name in plot.__all__ if name not in (*WHOLE, *TOOLS)]
# A hyphen before a digit is no minus sign; between dollars matplotlib makes one of it.
HYPHEN = re.compile(r"(?<![\w$])-\s?\d")
DIRECTED = set("<>^v")
NO_POINT = ("None", None, "", "_", "|")  # nothing, or the end of an interval


@pytest.mark.parametrize("name", NAMES)
def test_each_picture_draws_on_the_axes_given_labels_them_and_changes_nothing_global(name, pictures):
    before = dict(matplotlib.rcParams)
    ax = Figure().subplots()
    assert getattr(plot, name)(*pictures[name], ax=ax, alpha=0.4321) is ax
    assert ax.get_xlabel()
    assert ax.get_ylabel()
    assert plot.caption_of(ax.figure)
    assert [artist for artist in ax.findobj(Artist) if artist.get_alpha() == 0.4321]  # matplotlib took the keyword
    assert dict(matplotlib.rcParams) == before
    ax.figure.canvas.draw()


@pytest.fixture(scope="module")
def figures(pictures):
    """A picture by its name, on a figure of its own, laid out."""
    whole = {
        "bifurcation_portraits": lambda: (ex.portrait.bifurcation_portraits(UNIFORM, "line"),),
        "blow_up": lambda: (ex.portrait.near_flat(UNIFORM, [1e-2, -1e-2]),),
        "definitions": lambda: (UNIFORM,),
        "falling_surface": lambda: (ex.portrait.falling_surface(UNIFORM),),
        "limit_paths": lambda: (ex.portrait.toward_limits(UNIFORM, [0.1]),),
        "portrait_of_sides": lambda: [ex.portrait.on_line(UNIFORM, 0.25, eta) for eta in (0.01, -0.01)],
        "race_bodies": lambda: (ex.portrait.race_numbers(),),
        "rosette_and_resonance": lambda: 2 * pictures["wander_path"][:1],
        "zoom_on_f": lambda: (ex.portrait.zoom(UNIFORM, [0.3, 3e-5], points=4),),
    }
    assert set(whole) == set(OF_A_FIGURE)

    def laid_out(name):
        figure = plot.figure_of(getattr(plot, name), *(whole[name]() if name in whole else pictures[name]))
        figure.draw_without_rendering()
        return figure

    return laid_out


def dense(points, ax):
    """Points on the line as well as its vertices, evenly on the axes."""
    if len(points) < 2:
        return points
    seen = ax.transData.transform(points)
    place = np.arange(len(seen))
    fine = np.linspace(0, len(seen) - 1, max(200, len(seen)))
    return ax.transData.inverted().transform(
        np.stack([np.interp(fine, place, column) for column in seen.T], axis=1)
    )


def assert_that_the_legend_covers_no_line(ax):
    frame, inside = ax.get_legend().get_window_extent(), ax.bbox.get_points()
    for line in ax.lines:
        if line.get_transform() == ax.transData:
            seen = ax.transData.transform(dense(line.get_xydata(), ax))
            shown = ((seen >= inside[0]) & (seen <= inside[1])).all(axis=1)
            assert not frame.count_contains(seen[shown])


def assert_that_points_beyond_are_marked(ax):
    """And no other marker points anywhere."""
    marks = [line for line in ax.lines if line.get_gid() == BEYOND]
    others = [line for line in ax.lines if line not in marks and line.get_marker() not in NO_POINT]
    assert not [line for line in others if len(line.get_xdata()) == 1 and line.get_marker() in DIRECTED]
    low, high = sorted(ax.get_ylim())
    tiny = 1e-9 * (high - low)
    for line in others:
        if line.get_transform() == ax.transData:
            y = np.asarray(line.get_ydata(), dtype=float)
            beyond = np.isfinite(y) & ((y < low - tiny) | (y > high + tiny))
            assert beyond.sum() <= len(marks)


@pytest.mark.parametrize("name", [*NAMES, *OF_A_FIGURE])
def test_each_figure_can_be_read_and_its_colours_have_one_meaning(name, figures):
    """No hyphen is a minus sign; blue and vermilion are the sides of F, and legends that have them say which."""
    figure, sides = figures(name), {to_hex(colour) for colour in SIGN_COLOURS.values()}
    texts = [re.sub(r"\$[^$]*\$", "", text.get_text()) for text in figure.findobj(Text)]
    assert not [text for text in texts if HYPHEN.search(text)]
    for legend in figure.findobj(Legend):
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
            colour = getattr(handle, "get_color", getattr(handle, "get_facecolor", None))()
            if is_color_like(colour) and to_hex(colour) in sides:
                assert "\\eta" in text.get_text()
    for ax in figure.axes:
        assert_that_points_beyond_are_marked(ax)
        if ax.get_legend():
            assert_that_the_legend_covers_no_line(ax)
