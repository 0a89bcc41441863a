"""Constants and angle after many passages."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.portrait.conservation import conservation


@pytest.fixture(scope="module")
def kept():
    return conservation(BODIES["coin"], most=1000, most_by_solver=8, accuracies=(1e-4, 1e-8))


def test_constants_stay_bounded_and_angles_drift_in_proportion(kept):
    for accuracy, each in kept.ours.items():
        assert each.passages[-1] == 1000
        assert each.constants.max() < accuracy
        assert each.chi[-1] < accuracy * 1000
        slope = np.polyfit(np.log(each.passages[-8:]), np.log(each.chi[-8:]), 1)[0]
        assert slope == pytest.approx(1.0, abs=0.15)


def test_the_general_solver_starts_on_the_same_motion_and_drifts(kept):
    assert kept.solver.chi[0] < 1e-6
    assert kept.solver.constants[-1] > 3.0 * kept.solver.constants[0]


def test_how_many_passages_must_be_a_number_above_0():
    with pytest.raises(ex.InputError, match="most = 0"):
        conservation(BODIES["coin"], most=0)
