"""The variational equations against differences."""

import numpy as np
import pytest
from conftest import BODIES

from explorer import compiled
from explorer.phase.states import phi_to_states
from kernels.disk.field import State, reduced
from kernels.steps.variation import tangent_field


def some_states(disk, count, seed=3):
    draw = np.random.default_rng(seed).uniform
    return phi_to_states(disk, draw(-1.2, 1.2, count), *draw(-2.0, 2.0, (3, count)))


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_the_tangent_field_is_the_derivative_of_the_field(name):
    b = BODIES[name].body
    x = np.array([0.8, 0.6, 0.7, -1.1, 0.4])
    draw = np.random.default_rng(1)
    Y = np.zeros((6, 5))
    Y[:5, 0] = x
    Y[:5, 1:] = draw.normal(size=(5, 4))
    out = np.empty((6, 5))
    tangent_field(Y, b, out)
    h = 1e-6

    def field(values):
        return np.array(reduced(State(*values, 0.0, 0.0, 0.0, 0.0, 0.0), b))

    np.testing.assert_allclose(out[:5, 0], field(x), rtol=1e-14)
    for j in range(1, 5):
        slope = (field(x + h * Y[:5, j]) - field(x - h * Y[:5, j])) / (2 * h)
        np.testing.assert_allclose(out[:5, j], slope, rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_the_matrix_is_the_derivative_of_trajectories(name):
    """Against differences of trajectories at the same time, by another method."""
    import explorer as ex

    disk = BODIES[name]
    start = np.array([0.3, 0.5, 0.7, -0.4]) * np.array([1.0, *[disk.rate_unit] * 3])
    states = phi_to_states(disk, *start)
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
