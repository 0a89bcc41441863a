"""Outcomes of samples: codes with sentences."""

import re

import pytest

from kernels.status import Status


@pytest.mark.parametrize("status", Status)
def test_every_code_has_a_sentence_and_a_remedy_of_its_own(status):
    assert status.sentence.endswith(".")
    assert status.remedy.endswith(".")
    assert [other for other in Status if other.sentence == status.sentence] == [status]


def test_only_ok_is_false_so_that_a_status_can_be_asked_for():
    assert [status for status in Status if not status] == [Status.OK]


def test_remedies_name_only_arguments_that_calls_have():
    """There was one that asked for a step cap, which no call takes that returns the status by default."""
    arguments = {"accuracy", "method", "constants_to_states", "passages", "limit_motion"}
    named = {word for status in Status for word in re.findall(r"`(\w+)`", status.remedy)}
    assert named <= arguments
    assert not any("step cap" in status.remedy for status in Status)
