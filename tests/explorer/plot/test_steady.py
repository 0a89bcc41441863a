"""Pictures of steady motions."""

import numpy as np
import pytest
from conftest import BODIES

from explorer import plot
from explorer.phase.membership import well
from explorer.plot.steady import TILTS
from explorer.portrait.potential import CENTRE
from explorer.portrait.potentials import at_constants
from explorer.portrait.steady import (
    measured_thresholds,
    stability_edges,
    whole_path,
)

UNIFORM, COIN = BODIES["uniform"], BODIES["coin"]


def lines(ax, label):
    return [line for line in ax.lines if line.get_label() == label]


def test_the_plane_of_constants_has_the_lines_the_wells_and_the_thresholds():
    ax = plot.steady_plane(COIN)
    measured = measured_thresholds(COIN, 0.7, COIN.r)
    (marks,) = lines(ax, "upright becomes stable")
    assert max(marks.get_xdata()) == pytest.approx(measured["spinning_upright"], rel=1e-9)
    assert max(marks.get_ydata()) == pytest.approx(measured["straight_rolling"], rel=1e-9)
    (with_well,) = lines(ax, "with a well on it")
    x, y = with_well.get_data()
    assert max(x) == pytest.approx(well(COIN).sigma3_bar * COIN.rate_unit)
    for bar, spin in zip(x, y, strict=True):
        assert abs(at_constants(COIN, bar, spin).eta) < 1e-15
    for tilt in TILTS:
        (curve,) = lines(ax, f"_tilt {tilt:g}")
        bar3, bar4 = (np.asarray(v)[300:900:100] for v in curve.get_data())
        for bar, spin in zip(bar3, bar4, strict=True):
            if np.isfinite(bar):
                potential = at_constants(COIN, float(bar), float(spin))
                assert min(abs(at.phi - tilt) for at in potential.equilibria) < 1e-9


def test_the_map_of_circular_rolling_is_the_sign_of_the_curvature():
    ax = plot.steady_map(UNIFORM)
    (mesh,) = [
        child for child in ax.collections if child.get_array() is not None and child.get_array().size > 1000
    ]
    stable = np.asarray(mesh.get_array()).reshape(321, 241)
    assert stable.any()
    assert not stable.all()
    # lean 0.1 rad: rows of precession from 0.02 to 3.2
    column = stable[:, 16]
    lean = np.linspace(1e-3, 0.5 * np.pi - 1e-3, 241)[16]
    fast, slow = stability_edges(UNIFORM, lean)[:, 0]
    precession = np.linspace(0.02, 3.2, 321)
    assert (column == ((precession < slow) | (precession > fast))).all()


@pytest.mark.parametrize("path", ["spinning", "rolling", "line"])
def test_the_bifurcation_diagram_draws_its_branches(path):
    branches, marks = whole_path(UNIFORM, path)
    ax = plot.bifurcations(UNIFORM, path, branches, marks)
    assert len(lines(ax, "stable")) == len(lines(ax, "unstable")) == 1
    drawn = ax.lines[: len(branches)]
    for branch, line in zip(branches, drawn, strict=True):
        assert (line.get_ydata() == branch.phi).all()
        assert line.get_linestyle() == ("-" if branch.kind == CENTRE else "--")
