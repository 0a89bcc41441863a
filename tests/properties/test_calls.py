"""Public calls answer or refuse in a sentence, whatever numbers they are given."""

import pickle
import warnings

import pytest
from hypothesis import given

import explorer as ex
from properties.finite import missing
from properties.strategies import examples, keywords

CALLS = {
    "phi_to_states": "disk phi phidot sigma3 sigma4",
    "theta_to_states": "disk theta thetadot sigma3 sigma4 face?",
    "constants_to_states": "disk sigma3_bar eta_hat phidot face?",
    "rates_to_states": "disk tilt tilt_rate? precession? spin? face? degrees?",
    "coordinates_to_states": "disk phi phidot sigma3_bar sigma4_bar degrees?",
    "constants": "states",
    "falls": "states",
    "periods": "states accuracy? jobs? method?",
    "bounces": "states count? accuracy? jobs? method?",
    "compare": "states count? accuracy? jobs?",
    "simulate": "states max_steps t_end t_eval observables? accuracy? method? jobs?",
    "scan": "states observable jobs? batch?",
    "limit_motion": "state_on_f side?",
    "both_sides": "state",
    "flow_stretch": "states steps step?",
    "passages": "disk sigma3_bar eta_hat phidot face? window? accuracy? method? jobs?",
    "passage_forces": "disk sigma3_bar eta_hat phidot",
    "steady_motions": "disk tilt precession face? degrees?",
    "circular_rolling": "disk lean radius degrees?",
    "slice_map": "disk slice points degrees?",
    "falling_constant": "disk box energy?",
    "probability": "disk samples! count? accuracy? degrees? phi phidot sigma3 sigma4",
    "push_forward": "disk time samples rng?",
    "run": "scene disk samples! eta_hat? seed? accuracy? method? chunk_size? box? jobs?",
    "Disk": "I1 I3 m? r? g?",
    "Disk.annulus": "inner m? r?",
    "Disk.uniform": "m? r? g",
    "Disk.parse": "text",
    "potential": "disk sigma3_bar eta_hat?",
    "wander": "states",
}
SELDOM = {
    "falling_constant": 0.1,
    "push_forward": 0.2,
    "probability": 0.1,
    "slice_map": 0.3,
    "run": 0.5,
    "both_sides": 0.3,
    "limit_motion": 0.5,
}
SHARE = 0.7 / sum(SELDOM.get(name, 1.0) for name in CALLS)


def image(value):
    """What differs where an argument was changed."""
    if isinstance(value, dict):
        return {name: image(each) for name, each in value.items()}
    if isinstance(value, ex.States | ex.Disk):  # they keep what was computed of them
        return (
            value.describe() if isinstance(value, ex.Disk) else (value.natural.tobytes(), value.status.tobytes())
        )
    return pickle.dumps(value)


@pytest.mark.parametrize("name", CALLS)
def test_a_call_answers_with_finite_numbers_or_refuses(name, counts):
    call = ex
    for word in name.split("."):
        call = getattr(call, word)

    @examples(SHARE * SELDOM.get(name, 1.0))
    @given(keywords(CALLS[name]))
    def claim(made):
        arguments, senseless = made
        before = image(arguments)
        with warnings.catch_warnings(action="error"):
            warnings.simplefilter("ignore", UserWarning)  # the project's own
            try:
                found = call(**arguments)
            except (ex.InputError, ex.RunError):
                found = None
            except TypeError:
                assert senseless
                found = None
        assert image(arguments) == before
        counts[name]["refused" if found is None else "answered"] += 1
        with warnings.catch_warnings(action="ignore"):
            assert missing(found) == []

    claim()
