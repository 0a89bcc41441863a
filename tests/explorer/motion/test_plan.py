"""The ladder of models: which level and which method a question gets."""

from dataclasses import replace

import numpy as np
import pytest

import explorer as ex
from explorer.motion.plan import LEVELS, OBSERVABLES, plan
from explorer.scenes.scene import NAMES, scene_class


def test_the_lowest_rung_that_gives_everything_is_chosen():
    assert plan(("face", "distance")).level == "algebra"
    assert plan(("theta_min", "face")).level == "quadrature"
    assert plan(("theta_min", "phi")).level == "reduced"
    assert plan(("phi", "chi")).level == "angles"
    assert plan(("contact", "phi")).level == "path"
    assert plan(()).level == "algebra"
    assert set(OBSERVABLES.values()) <= set(LEVELS)


def test_what_follows_no_motion_has_no_method_of_integration():
    found = plan(("face", "distance"), method="dop853")
    assert found.method == "algebra"
    assert "dop853" not in found.reason


def test_a_plan_says_why():
    assert "knows eta exactly" in plan(("race_angle",)).reason
    reason = plan(("theta_min", "contact")).reason
    assert "path because of contact" in reason
    assert "dop853" in reason
    assert "costs least" in reason
    assert "as asked" in plan(("chi",), method="rk4").reason


def test_the_setting_falls_with_the_accuracy():
    for method in ("rk4", "rk8", "dopri5", "dop853"):
        loose, tight = plan(("chi",), 1e-3, method), plan(("chi",), 1e-9, method)
        assert 0.0 < tight.control < loose.control


def test_a_plan_may_name_its_setting():
    given = replace(plan(("chi",), 1e-6, "rk8"), setting=0.25)
    assert given.control == 0.25


@pytest.mark.parametrize("accuracy", [0.0, -1.0, 1.0, np.nan, 1e-30])
def test_an_accuracy_no_method_can_hold_is_refused(accuracy):
    with pytest.raises(ex.InputError, match="accuracy"):
        plan(("chi",), accuracy)


def test_every_scene_asks_only_for_known_observables():
    for name in NAMES:
        assert set(scene_class(name).observables) <= set(OBSERVABLES)


def test_a_method_that_cannot_answer_is_refused():
    with pytest.raises(ex.InputError, match="passages and periods, not path"):
        plan(("path",), method="quadrature")
    assert plan(("race_angle",), 1e-13).method == "quadrature"
    with pytest.raises(ex.InputError, match="for dopri5"):
        plan(("race_angle",), 1e-13, "dopri5")


def test_an_integrator_asked_for_a_passage_carries_what_it_needs():
    assert plan(("theta_min",), method="rk4").level == "reduced"
    assert plan(("theta_min", "race_angle"), method="rk4").level == "angles"
