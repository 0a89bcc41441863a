"""General solvers on the plain equations: right far from F, through the table near it."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.portrait.general_solvers import METHODS, OURS, PlainField, general_solvers

HOOP = BODIES["hoop"]


def test_the_plain_equations_are_those_of_the_paper():
    phi, phidot, sigma3, sigma4 = 0.6, 0.4, 0.7, -0.3
    q, z, I1, I3 = np.cos(phi), np.sin(phi), HOOP.I1, HOOP.I3
    wanted = [
        phidot,
        (-I1 * z * sigma3**2 / q**3 + (I3 + 1.0) * sigma3 * sigma4 / q + z) / (I1 + 1.0),
        -I3 / I1 * q * sigma4 * phidot,
        -phidot * sigma3 / (q * (I3 + 1.0)),
        sigma3 / q**2,
    ]
    np.testing.assert_allclose(
        PlainField(HOOP)(0.0, np.array([phi, phidot, sigma3, sigma4, 0.0])), wanted, rtol=1e-13
    )


def test_far_from_f_all_agree_and_near_it_the_disk_of_general_solvers_goes_through_the_table():
    solved = general_solvers(BODIES["uniform"], [0.1, -0.1, 1e-7, -1e-8])
    assert not solved.wrong(OURS).any()
    for name in METHODS:
        assert solved.wrong(name).tolist() == [False, False, True, True]
        assert solved.beyond[name].tolist() == [False, False, True, True]


def test_a_solver_that_gives_up_is_counted_as_wrong(monkeypatch):
    monkeypatch.setitem(general_solvers.__globals__, "_MOST_EVALUATIONS", 10)
    solved = general_solvers(HOOP, [0.1])
    assert np.isnan(solved.race_angle["RK45"]).all()
    assert solved.wrong("RK45").all()


def test_bad_input_gets_a_sentence():
    with pytest.raises(ex.InputError, match="phidot above 0"):
        general_solvers(HOOP, 0.1, phidot=-1.0)
