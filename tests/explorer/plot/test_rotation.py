"""The picture of rotation numbers names its lines beside them."""

import numpy as np
from conftest import BODIES

from explorer import plot
from explorer.portrait.rotation import rotation_map


def test_each_line_is_named_at_both_ends_outside_the_motions():
    rotation = rotation_map(BODIES["uniform"], 2.0, points=8)
    ax = plot.rotation_map(rotation)
    names = [text for text in ax.texts if "l_" in text.get_text()]
    assert len(names) == 4
    for text in names:
        x, y = text.get_position()
        assert np.hypot(x / rotation.sigma3_bar[-1], y / rotation.sigma4_bar[-1]) > 1.0
        assert (np.sign(x * y) > 0.0) == ("+" in text.get_text())
