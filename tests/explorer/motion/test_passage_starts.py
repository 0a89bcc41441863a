"""Starts at the vertical: which can be computed, and what is said of the others."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.motion.passage_starts import starts_at_vertical


def test_bad_input_is_flagged_sample_by_sample():
    got = ex.passages(
        BODIES["uniform"],
        [1.0, np.nan, 1.0, 1.0, 1.0],
        [1e-3] * 5,
        [1.0, 1.0, -1.0, np.inf, 1.0],
        face=[1, 1, 1, 1, 2],
    )
    assert got.status.tolist() == [0, 2, 2, 2, 2]
    alone = ex.passages(BODIES["uniform"], 1.0, 1e-3, 1.0)
    assert got.delta_chi[0] == alone.delta_chi
    assert np.isnan(got.delta_chi[1:]).all()


@pytest.mark.filterwarnings("error")
def test_input_beyond_all_scales_is_bad_input_and_a_vanishing_eta_has_no_side():
    disk = BODIES["uniform"]
    for method in ("quadrature", "dop853"):
        got = ex.passages(disk, [1e308, 1.0, np.nan, 1.0], 1e-3, [1.0, 1e200, 1.0, np.inf], method=method)
        assert (got.status == ex.Status.BAD_INPUT).all()
    got = ex.passages(disk, 1.0, [1e-300, 5e-324], 1.0)
    assert got.status.tolist() == [ex.Status.OK, ex.Status.UNRESOLVED_SIDE]
    forces = ex.passage_forces(disk, 1.0, [1e-3, 1e-3, 5e-324], [1.0, -1.0, 1.0])
    assert np.isnan(forces.max_friction).tolist() == [False, True, True]


def test_no_kernel_sees_what_means_nothing(body):
    unit = body.rate_unit
    given = [np.nan, 1.0, unit], [1.0, -5e-324, unit], [1.0, 1.0, np.inf], [1.0, -1.0, 0.0]
    starts = starts_at_vertical(body, *map(np.array, given))
    assert starts.status.tolist() == [ex.Status.BAD_INPUT, ex.Status.UNRESOLVED_SIDE, ex.Status.BAD_INPUT]
    assert np.isfinite(starts.natural(body)).all()
    assert starts.face[1] == -1.0
    assert starts.eta_hat[1] < 0.0
