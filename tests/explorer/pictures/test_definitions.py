"""The disk of the sketch: a rigid body that touches the table in one point."""

import math

import numpy as np

from explorer.pictures.definitions import Pose

POSE = Pose(0.7, 0.4, np.array([0.3, -0.2, math.cos(0.7)]))


def test_the_lowest_point_of_the_rim_is_the_contact():
    rim = POSE.rim(np.linspace(0.0, 2.0 * math.pi, 361))
    assert np.argmin(rim[:, 2]) in (0, 360)
    assert abs(POSE.place(0.0)[2]) < 1e-15
    np.testing.assert_allclose(np.linalg.norm(rim - POSE.centre, axis=1), 1.0)


def test_the_axis_is_the_normal_of_the_rim_and_points_up_where_phi_is_above_zero():
    assert np.abs((POSE.rim(np.linspace(0.0, 6.0, 50)) - POSE.centre) @ POSE.normal).max() < 1e-15
    assert np.isclose(POSE.normal[2], math.sin(0.7))
