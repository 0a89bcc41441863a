"""The plain equations do what the paper says of them, and share no code with what they judge."""

import ast
from pathlib import Path

import numpy as np
import pytest

from explorer.paper import eight_dimensions as plain
from explorer.paper.checks import THICK, UNIFORM, WITH_UNITS, sample


def test_they_share_no_code_with_the_explorer():
    tree = ast.parse(Path(plain.__file__).read_text(encoding="utf-8"))
    names = [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    names += [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
    assert {name.partition(".")[0] for name in names} == {"dataclasses", "typing", "numpy", "scipy"}


@pytest.mark.parametrize("disk", WITH_UNITS, ids=lambda disk: disk.name)
def test_a_motion_starts_in_the_state_that_was_asked_for(disk):
    phi, phidot, s3, s4 = sample(disk)
    motion = plain.integrate(disk, sample(disk), np.array([0.0, 0.1 * disk.time_unit]))
    assert motion.sigma[0] == pytest.approx([np.sin(phi), phidot * np.cos(phi), s3, s4], rel=1e-13)
    assert motion.a[0] == pytest.approx([0.0, 0.0, disk.r * np.cos(phi)], abs=1e-15)
    assert (motion.chi[0], motion.psi[0]) == pytest.approx((0.0, 0.0), abs=1e-14)


def test_rotations_stay_rotations_and_the_contact_point_on_the_floor():
    motion = plain.integrate(THICK, sample(THICK), np.linspace(0.0, 3.0, 16))
    for A in motion.A:
        assert pytest.approx(np.eye(3), abs=1e-10) == A @ A.T
    assert motion.contact[:, 2] == pytest.approx(np.zeros(16), abs=1e-10)
    assert motion.nu @ [0.0, 0.0, 1.0] == pytest.approx((motion.u * motion.omega).sum(axis=1), abs=1e-10)


def test_a_disk_at_rest_upright_tips_as_an_inverted_pendulum():
    """Section 3.4: M phi'' = m g r sin phi."""
    assert plain.tilting(UNIFORM, (0.3, 0.0, 0.0, 0.0)) == pytest.approx(np.sin(0.3) / 1.25, rel=1e-13)
