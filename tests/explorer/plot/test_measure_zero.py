"""Pictures of the law P(theta_min < delta) = C delta."""

import numpy as np
import pytest

import explorer as ex
from explorer import plot


@pytest.fixture(scope="module")
def summary(tmp_path_factory):
    options = {"samples": 2000, "tube": 1024, "disk": "hoop"}
    return ex.run("measure-zero", out=tmp_path_factory.mktemp("law") / "run", **options).summary


def test_the_ladder_lies_on_its_line_and_off_the_others(summary):
    """Data of the artists: the line C delta, two laws that it is not, and the estimates of the summary."""
    ax = plot.falling_ladder(summary)
    delta = np.array([row["delta"] for row in summary["ladder"]])
    line, square, plateau = (np.asarray(artist.get_ydata()) for artist in ax.lines[:3])
    np.testing.assert_allclose(line, summary["constant_predicted"] * delta)
    # Where it would be more than certain the law of dimension two is not drawn.
    assert (square[-10:] < 0.2 * line[-10:]).all()
    assert plateau[-1] == pytest.approx(1e-6, rel=1e-6)
    tubes = ax.containers[0].lines[0]
    np.testing.assert_allclose(tubes.get_ydata(), [row["estimate"] for row in summary["ladder"]])
    np.testing.assert_allclose(tubes.get_ydata()[3:], line[3:], rtol=0.1)


def test_the_convergence_ends_at_the_constant_of_the_summary(summary):
    ax = plot.constant_convergence(summary)
    last = ax.containers[0].lines[0].get_ydata()[-1]
    assert last == pytest.approx(summary["constant"]["value"] / summary["constant_predicted"] - 1.0)
