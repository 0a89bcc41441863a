"""Outcomes of samples: codes with sentences."""

import pytest

from kernels.status import Status


@pytest.mark.parametrize("status", Status)
def test_every_code_has_a_sentence_and_a_remedy_of_its_own(status):
    assert status.sentence.endswith(".")
    assert status.remedy.endswith(".")
    assert [other for other in Status if other.sentence == status.sentence] == [status]


def test_only_ok_is_false_so_that_a_status_can_be_asked_for():
    assert [status for status in Status if not status] == [Status.OK]
