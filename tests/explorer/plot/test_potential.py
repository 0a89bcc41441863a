"""Phase portraits and curves of the potential."""

import math

import numpy as np
import pytest
from conftest import BODIES

from explorer import plot
from explorer.portrait.potential import CENTRE, SADDLE
from explorer.portrait.potentials import on_line

UNIFORM = BODIES["uniform"]


def lines(ax, label):
    return [line for line in ax.lines if line.get_label() == label]


def test_the_portrait_draws_levels_separatrix_equilibria_and_walls():
    potential = on_line(UNIFORM, 0.25, 0.01)
    ax = plot.phase_portrait(potential)
    (separatrix,) = lines(ax, "separatrix")
    phi, phidot = separatrix.get_data()
    energy = 0.5 * UNIFORM.body.M * phidot**2 + potential.V(phi)
    assert energy == pytest.approx(potential.separatrices()[0].saddle.energy, rel=1e-12)
    lower = ax.lines[list(ax.lines).index(separatrix) + 1]
    assert (lower.get_xdata() == phi).all()
    assert (lower.get_ydata() == -phidot).all()
    marks = {
        label: [float(line.get_xdata()[0]) for line in ax.lines if line.get_marker() == m]
        for label, m in ((CENTRE, "o"), (SADDLE, "X"))
    }
    assert marks == {kind: [at.phi for at in potential.equilibria if at.kind == kind] for kind in marks}
    (wall,) = lines(ax, "wall at flat")
    assert wall.get_xdata() == [-0.5 * math.pi, -0.5 * math.pi]
    assert not lines(ax, "flat, reached")
    assert "falls" not in [text.get_text() for text in ax.get_legend().get_texts()]
    on = plot.phase_portrait(on_line(UNIFORM, 0.25))
    assert len(lines(on, "wall at flat")) == len(lines(on, "flat, reached")) == 1
    assert "falls" in [text.get_text() for text in on.get_legend().get_texts()]
    assert "(rad)" in on.get_xlabel()


@pytest.mark.parametrize("near_flat", [False, True])
def test_the_curves_of_the_potential_are_its_values(near_flat):
    potentials = [on_line(UNIFORM, 0.25, eta) for eta in (0.0, 0.01, -0.01)]
    ax = plot.potential_curves(potentials, near_flat)
    for potential, sign in zip(potentials, ("on the line", "= 0.01", "= −0.01"), strict=True):
        (line,) = [line for line in ax.lines if sign in line.get_label()]
        x, V = line.get_data()
        phi = 0.5 * math.pi - x if near_flat else x
        shown = np.isfinite(V) & (abs(phi) < 1.57)
        assert V[shown] == pytest.approx(potential.V(phi[shown]), rel=1e-6)
        assert np.isnan(V).any() == (not near_flat or potential.eta != 0.0)
    (end,) = lines(ax, "$V_0$, at flat" if near_flat else "$V_0$")
    assert end.get_ydata()[0] == pytest.approx(potentials[0].flat_value(1))
