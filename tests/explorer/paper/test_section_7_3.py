"""Sections 7.3 and 1 of the paper hold, and every row fails once something it rests on is damaged."""

import numpy as np
import pytest
from paper_rows import Statements, field, first, without_one

from explorer.paper import closed_forms, section_7_3
from explorer.paper.checks import UNIFORM
from explorer.phase.disk import Disk

NUMBERS = range(48, 58)


def other_body(original):
    return lambda ratio: original(1.01 * ratio)


DAMAGES = [
    (48, Disk, "kappa", without_one),
    (49, Disk, "kappa", without_one),
    (50, section_7_3, "planar", other_body),
    (51, section_7_3, "beside", field("B", 1.01)),
    (52, section_7_3, "passages", field("energy", 0.5)),
    (53, closed_forms, "at_vertical", first(1.01)),
    (54, section_7_3, "passages", field("race_angle", 1.0 + 1e-4)),
    (55, section_7_3, "beside", field("arm", [1.0, -1.0, 1.0])),
    (56, closed_forms, "at_vertical", first(1.001)),
    (57, Disk, "kappa", without_one),
]


class TestStatements(Statements):
    """Those of NUMBERS, each with its damage."""


def test_the_printed_angle_of_the_contact_point_is_wrong_on_the_upper_side():
    """Section 7.3 has χ ± π for both faces; p - a points along χ on face +1."""
    run = section_7_3.beside(UNIFORM, 1, 1, 1e-8)
    assert complex(*run.arm[0, :2]) == pytest.approx(np.exp(1j * run.chi[0]), abs=1e-3)
