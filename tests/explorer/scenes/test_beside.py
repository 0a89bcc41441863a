"""Starts beside the falling set: at the vertical, on both faces alike."""

import pytest
from conftest import BODIES

from explorer.errors import InputError
from explorer.measure.sampling import chunk_stream
from explorer.scenes.beside import box_beside, check_eta_hat, default_box, describe_beside, draw_beside


def test_starts_lie_in_the_box_and_on_both_faces_alike(body):
    box = default_box(body)
    start = draw_beside(box, chunk_stream(1, 0), 4000)
    speed = start["face"] * start["phidot"]
    assert (speed >= box.phidot[0]).all()
    assert (speed <= box.phidot[1]).all()
    assert (start["sigma3_bar"] >= box.sigma3[0]).all()
    assert (start["sigma3_bar"] <= box.sigma3[1]).all()
    assert set(start["face"]) == {-1.0, 1.0}
    assert abs(start["face"].mean()) < 0.1


def test_only_what_is_given_differs_from_the_default_box():
    disk = BODIES["coin"]
    box = box_beside(disk, {"sigma3": (0.0, 1.0)})
    assert box.sigma3 == (0.0, 1.0)
    assert box.phidot == default_box(disk).phidot
    assert box_beside(disk, {name: tuple(span) for name, span in describe_beside(box).items()}) == box


@pytest.mark.parametrize(
    ("ranges", "message"),
    [
        ({"sigma4": (0.0, 0.0)}, "sets sigma4 by eta_hat"),
        ({"phi": (0.0, 1.0)}, "starts at the vertical"),
        ({"phidot": (-1.0, 1.0)}, "speed towards flat"),
    ],
)
def test_a_box_that_describes_no_start_beside_f_is_refused(ranges, message):
    with pytest.raises(InputError, match=message):
        box_beside(BODIES["hoop"], ranges)


@pytest.mark.parametrize("span", [(0.0, 1.0), (1e-2, 1e-3), (1e-3, 11.0), (1e-310, 1e-3)])
def test_distances_that_are_no_longer_beside_f_are_refused(span):
    with pytest.raises(InputError, match="eta_hat"):
        check_eta_hat(span, BODIES["hoop"])
