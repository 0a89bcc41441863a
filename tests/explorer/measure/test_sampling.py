"""Streams: that they are repeatable, and what is made of them; the measure that is drawn from."""

import numpy as np
import pytest
from conftest import BODIES
from scipy.stats import kstest

import explorer as ex
from explorer.measure.sampling import log_uniform, numbered_stream

UNIFORM = BODIES["uniform"]
# The first doubles of Philox, seed 0, chunk 0.
STREAM = ["0x1.7140b364494fdp-1", "0x1.b924c9003caa0p-6", "0x1.9c32fa6c393e4p-2"]


def test_the_first_draws_of_a_stream_never_change():
    """A run must be repeatable with later releases: these bits are part of the format."""
    got = numbered_stream(0, 0).random(3)
    assert [x.hex() for x in got] == STREAM


def test_log_uniform_covers_its_decades_evenly():
    values = np.log10(log_uniform(numbered_stream(3, 0).random(20_000), 1e-6, 1e-2))
    assert kstest(values, "uniform", args=(-6, 4)).pvalue > 1e-4


def test_the_reduced_flow_preserves_the_measure():
    """The field in (phi, phidot, sigma3, sigma4) has no divergence: by central differences."""
    from kernels.disk.field import State, reduced

    b = UNIFORM.body

    def rates(y):
        phi, phidot, s3, s4 = y
        q = np.cos(phi)
        _q, _z, dp, drho, ds4 = reduced(State(q, np.sin(phi), -phidot, s3 / q, s4, 0, 0, 0, 0, 0), b)
        ds3 = (-q * np.sin(phi) * phidot) * s3 / q + q * drho  # sigma3 = q rho, q' = z q p
        return np.array([q * phidot, -dp, ds3, ds4]) / q

    rng = np.random.default_rng(0)
    for y in np.column_stack([rng.uniform(-1.2, 1.2, 20), rng.uniform(-2, 2, (20, 3))]):
        step = 1e-5 * np.eye(4)
        divergence = sum((rates(y + step[i])[i] - rates(y - step[i])[i]) / 2e-5 for i in range(4))
        assert abs(divergence) < 1e-6


def test_a_face_is_one_of_two_and_no_range():
    for face in ("-1:1", "0.5"):
        with pytest.raises(ex.InputError, match=r"face = .*: give 1 or -1"):
            ex.slice_map(ex.Disk.uniform(), f"phi=0:1,phidot=1,sigma3_bar=-2:2,eta_hat=1,face={face}", points=3)
