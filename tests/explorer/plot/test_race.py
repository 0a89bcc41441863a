"""Pictures of the race."""

import numpy as np
from conftest import BODIES, computed

from explorer import plot
from explorer.scenes.registry import build_scene

UNIFORM = BODIES["uniform"]


def test_kappa_pi_is_drawn_in_the_histogram():
    scene = build_scene("race-angles", samples=500)
    ax = plot.race_histogram(scene.summarise(computed(scene)))
    drawn = [line.get_xdata()[0] for line in ax.lines]
    assert drawn == [UNIFORM.race_limit, -UNIFORM.race_limit]


def test_every_cell_of_the_deviation_is_drawn_at_its_place():
    cells = {(-48, -36): 10, (-24, -12): 20}
    ax = plot.race_deviation(UNIFORM, cells, 1.8)
    mesh = ax.collections[0]
    counts = np.ma.filled(mesh.get_array(), 0.0)
    assert counts.shape == (25, 25)
    assert counts[0, 0] == 10
    assert counts[24, 24] == 20
    assert counts.sum() == 30
    np.testing.assert_allclose(mesh.get_coordinates()[0, 0], [1e-4, 1e-3])
