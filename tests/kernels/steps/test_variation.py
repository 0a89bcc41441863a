"""The variational equations against differences of motions."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer import compiled


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_the_matrix_is_the_derivative_of_trajectories(name):
    """Against differences of trajectories at the same time, by another method."""
    disk = BODIES[name]
    start = np.array([0.3, 0.5, 0.7, -0.4]) * np.array([1.0, *[disk.rate_unit] * 3])
    states = ex.phi_to_states(disk, *start)
    out, ends = np.empty((1, 4, 4)), np.empty((6, 1))
    compiled.variation.variation_batch(states.natural, 0.05, 60, disk.body, out, ends)
    time, h = ends[5, 0] * disk.time_unit, 1e-5
    scale = np.array([1.0, *[disk.rate_unit] * 3])
    for j in range(4):
        either = [start + sign * h * scale * (np.arange(4) == j) for sign in (1, -1)]
        names = ("phi", "phidot", "sigma3", "sigma4")
        found = ex.simulate(
            ex.phi_to_states(disk, *np.transpose(either)),
            t_eval=[time],
            observables=names,
            accuracy=1e-10,
            method="dop853",
        )
        ends_of_both = np.stack([getattr(found, name)[:, 0] for name in names]) / scale[:, None]
        np.testing.assert_allclose(
            out[0, :, j], (ends_of_both[:, 0] - ends_of_both[:, 1]) / (2 * h), rtol=1e-5, atol=1e-5
        )
