"""Pictures of a user's own numbers: what is on the axes, what is in the bins, what is refused."""

import numpy as np
import pytest

import explorer as ex
from explorer import plot

DISK = ex.Disk.uniform()


@pytest.fixture(scope="module")
def plane():
    return ex.slice_map(DISK, "phi=0,phidot=1,sigma3_bar=0.2:2,eta_hat=-1:1", ["theta_min", "crosses"], points=9)


def test_a_plane_is_drawn_over_its_own_axes_with_f(plane):
    ax = plot.observable_map(plane, cmap="magma")
    assert ax.get_ylabel() == r"$\hat\eta$ ($\sqrt{g/r}$)"
    mesh = ax.collections[0]
    np.testing.assert_array_equal(mesh.get_array().reshape(9, 9), plane["theta_min"])
    assert mesh.get_cmap().name == "magma"
    assert len(ax.collections) > 1
    assert plot.observable_map(plane, "crosses").get_title().startswith("crosses: ")


def test_states_in_a_row_are_a_line_and_others_a_cloud():
    row = ex.scan(ex.phi_to_states(DISK, 0.1, 0.5, np.linspace(0.1, 1.0, 9), 0.3), "theta_min")
    line = plot.observable_map(row, color="k").lines[0]
    np.testing.assert_array_equal(line.get_ydata(), row["theta_min"])
    cloud = ex.scan(ex.phi_to_states(DISK, 0.1, [[0.5], [0.6]], np.linspace(0.1, 1.0, 9), 0.3), "theta_min")
    assert len(plot.observable_map(cloud).collections[0].get_offsets()) == 18


def test_race_angles_fall_into_the_bins_asked():
    eta = np.repeat([1e-3, -1e-3, np.nan], [5, 3, 2])
    found = ex.bounces(ex.constants_to_states(DISK, 1.0, eta, 1.0))
    ax = plot.race_angle_histogram(found, bins=16, range=(-8.0, 8.0), disk=DISK)
    counts = [stairs.get_data().values for stairs in ax.patches]
    assert [int(c.sum()) for c in counts] == [5, 3]
    assert counts[0].size == 16
    same = plot.race_angle_histogram(found.to_pandas(), bins=16, range=(-8.0, 8.0))
    np.testing.assert_array_equal(same.patches[0].get_data().values, counts[0])


def test_what_cannot_be_drawn_is_refused_in_words(plane):
    with pytest.raises(ex.InputError, match="did you mean 'theta_min'"):
        plot.observable_map(plane, "theta_mim")
    with pytest.raises(ex.InputError, match="needs race_angle"):
        plot.race_angle_histogram({"race": [1.0]})
    with pytest.raises(ex.InputError, match="no race angle that is known"):
        plot.race_angle_histogram({"race_angle": [np.nan], "side": [1]})


def test_what_nobody_knows_is_said_and_bins_without_a_race_angle_are_refused():
    bad = ex.scan(ex.phi_to_states(DISK, 2.0, [1.0, 2.0], 1.0, 0.7), "theta_min")
    assert plot.observable_map(bad).texts[0].get_text() == "theta min is not known of any state"
    with pytest.raises(ex.InputError, match="found: has no states"):
        plot.observable_map(ex.scan(ex.phi_to_states(DISK, [], [], [], []), "theta_min"))
    table = {"race_angle": [7.0, -7.0], "side": [1, -1]}
    with pytest.raises(ex.InputError, match="holds none of the race angles, which go from -7 to 7 rad"):
        plot.race_angle_histogram(table, range=(100, 200))
    for bins in (0, [2.0, 1.0], "nonsense", 10**9):
        with pytest.raises(ValueError, match="bins"):
            plot.race_angle_histogram(table, bins=bins)
