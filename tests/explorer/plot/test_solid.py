"""Perspective, and the order in which a table, shadows and disks are painted."""

import math

import numpy as np
from matplotlib.figure import Figure

from explorer.plot import solid
from explorer.portrait.pose import Pose

CAMERA = solid.Camera(np.zeros(3), math.radians(30.0), math.radians(-60.0), 8.0)
POSE = Pose(0.9, 0.4, 0.0, np.array([0.0, 0.0, math.cos(0.9)]), 1.0)


def test_what_is_nearer_looks_larger_and_the_target_is_in_the_middle():
    np.testing.assert_allclose(CAMERA.see(np.zeros(3)), 0.0, atol=1e-15)
    toward = CAMERA.eye / 8.0
    right = np.array([-math.sin(CAMERA.azimuth), math.cos(CAMERA.azimuth), 0.0])
    np.testing.assert_allclose(CAMERA.see(right), [1.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(CAMERA.see(right + 4.0 * toward), [2.0, 0.0], atol=1e-14)
    assert CAMERA.see(np.array([0.0, 0.0, 1.0]))[1] > 0.0


def test_straight_lines_stay_straight():
    line = CAMERA.see(np.linspace([-2.0, 1.0, 0.0], [3.0, -2.0, 1.0], 9))
    along = (line - line[0]) @ np.array([[0.0, -1.0], [1.0, 0.0]]) @ (line[-1] - line[0])
    assert np.abs(along).max() < 1e-13


def test_the_shadow_meets_the_disk_at_its_contact():
    ax = Figure().subplots()
    solid.shadow(ax, CAMERA, POSE)
    contact = CAMERA.see(POSE.contact)
    for patch in ax.patches:
        assert np.linalg.norm(patch.get_xy() - contact, axis=1).min() < 1e-12


def test_each_face_of_the_disk_has_its_colour():
    def face(elevation):
        ax = Figure().subplots()
        solid.disk(ax, solid.Camera(np.zeros(3), elevation), Pose(1.3, 0.0, 0.0, np.zeros(3), 1.0))
        return np.array(ax.patches[1].get_facecolor()[:3])

    assert face(1.0).mean() > face(-1.0).mean() + 0.2


def test_the_table_lies_below_all_else():
    ax = Figure().subplots()
    solid.table(ax, CAMERA, np.zeros(3), 3.0)
    below = max(artist.get_zorder() for artist in [*ax.patches, *ax.lines])
    solid.shadow(ax, CAMERA, POSE)
    solid.disk(ax, CAMERA, POSE)
    assert below < 1.0 <= min(artist.get_zorder() for artist in ax.patches[2:])
