"""All pictures: each draws where it is told to, names its axes, and can be read."""

import re

import matplotlib
import numpy as np
import pytest
from conftest import BODIES, LAY_OUT
from matplotlib.colors import is_color_like, to_hex
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.text import Text

import explorer as ex
from explorer.measure.slices import ConstantsPlane
from explorer.pictures.register import caption_of
from explorer.pictures.style import BEYOND, SIGN_COLOURS

UNIFORM = BODIES["uniform"]
WITHOUT_AXES = {"definitions"}  # drawn in space, beside their plots
# A hyphen before a digit is no minus sign; between dollars matplotlib makes one of it.
HYPHEN = re.compile(r"(?<![\w$])-\s?\d")
SCRIPT = re.compile(r"\$[^$]*[_^]")
DIRECTED = set("<>^v")
NO_POINT = ("None", None, "", "_", "|")  # nothing, or the end of an interval

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def drawn(tmp_path_factory, traded):
    """Each picture on a figure or axes that are given, of what public calls return."""
    run = ex.run("measure-zero", samples=2000, tube=1024, disk="hoop", out=tmp_path_factory.mktemp("law") / "run")
    races = ex.run("race-angles", samples=500).summary
    states = ex.phi_to_states(UNIFORM, *np.random.default_rng(0).uniform(-1.0, 1.0, (4, 500)))
    both = ex.both_sides(ex.constants_to_states(BODIES["hoop"], 1.0, 0.0, 1.0))
    cut = ex.slice_map(UNIFORM, "phi=-1.35:1.35,phidot=0.05,sigma3=0.15,sigma4=-0.8:0.8", points=41)
    line, beside = ex.potential(UNIFORM, 0.25), ex.potential(UNIFORM, 0.25, 0.01)
    edges = np.linspace(-2.0, 2.0, 5)
    plane = ConstantsPlane(UNIFORM, edges, edges, np.geomspace(1e-3, 1.0, 16).reshape(4, 4), "quadrature")
    what = {
        "race-histogram": (races,),
        "race-deviation": (races,),
        "constants-plane": (plane,),
        "theta-min": (ex.scan(states, "theta_min")["theta_min"], 500),
        "slice-of-tilts": (cut,),
        "slice-of-sides": (ex.slice_map(UNIFORM, "phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2", points=41),),
        "observable": (cut,),
        "one-sided-distance": (ex.run("one-sided", samples=1, disk="hoop").summary,),
        "one-sided-motion": (both,),
        "contact-paths": (both,),
        "phase-portrait": (line,),
        "portrait-of-sides": (beside,),
        "potentials": ([line, beside],),
        "bifurcation-of-tilts": (UNIFORM, "line"),
        "bifurcation-of-energies": (UNIFORM, "line"),
        "portraits-of-regions": (UNIFORM, "line"),
        "rosette": (ex.wander_path(ex.constants_to_states(UNIFORM, 0.7, 0.01, 1.0), 2),),
        "work-precision": (traded,),
        "probability": (run.summary,),
    }
    numbers = {"rotation": {"points": 10}}
    made = {}

    def draw(name):
        if name not in made:
            before, figure = dict(matplotlib.rcParams), Figure(layout="constrained")
            ax = figure if ex.pictures[name].has_panels else figure.subplots()
            assert ex.picture(name, *what.get(name, (UNIFORM,)), ax=ax, **numbers.get(name, {})) is figure
            assert dict(matplotlib.rcParams) == before
            figure.set_size_inches(ex.pictures[name].size)
            LAY_OUT(figure)
            made[name] = figure
        return made[name]

    return draw


@pytest.mark.parametrize("name", sorted(ex.pictures))
def test_each_picture_is_drawn_where_it_is_told_with_a_caption_and_named_axes(name, drawn):
    figure = drawn(name)
    assert caption_of(figure) == ex.pictures[name].caption
    # Of axes that share one the outermost has its name; those in space have none
    for axis, get in (("x", "get_xlabel"), ("y", "get_ylabel")):
        named = [ax for ax in figure.axes if getattr(ax, get)()]
        assert named or getattr(figure, f"get_sup{axis}label")(), axis
    if name not in WITHOUT_AXES and not ex.pictures[name].has_panels:
        assert figure.axes[0].get_title()


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


@pytest.mark.parametrize("name", sorted(ex.pictures))
def test_each_picture_can_be_read_and_its_colours_have_one_meaning(name, drawn):
    """No hyphen is a minus sign; blue and vermilion are the sides of F, and legends that have them say which."""
    figure, sides = drawn(name), {to_hex(colour) for colour in SIGN_COLOURS.values()}
    texts = [re.sub(r"\$[^$]*\$", "", text.get_text()) for text in figure.findobj(Text)]
    assert not [text for text in texts if HYPHEN.search(text) or "κ" in text]
    # As the gallery shows it, 420 px wide; indices and exponents are 0.7 of their line
    letters = [
        each.get_fontsize() * (0.7 if SCRIPT.search(each.get_text()) else 1.0)
        for each in figure.findobj(Text)
        if each.get_visible() and each.get_text().strip()
    ]
    assert min(letters) / 72.0 * 420.0 / figure.get_figwidth() >= 8.0
    for legend in figure.findobj(Legend):
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
            colour = getattr(handle, "get_color", getattr(handle, "get_facecolor", None))()
            if is_color_like(colour) and to_hex(colour) in sides:
                assert "\\eta" in text.get_text()
    for ax in figure.axes:
        assert_that_points_beyond_are_marked(ax)
        if ax.get_legend():
            assert_that_the_legend_covers_no_line(ax)
