"""The physics of the page alone, against 25-digit references and against Python."""

import numpy as np
import pytest
from motions import trajectories

import explorer as ex

BODY = "modules.chaplygin.makeBody(row.I1, row.I3)"
MOTION = f"""({{ body: {BODY}, face: row.face ?? 1, sigma3_bar: row.sigma3_bar, phidot: row.phidot,
    theta: row.theta ?? Math.PI / 2, eta: modules.chaplygin.etaHatToEta(row.eta_hat, {BODY}) }})"""
READOUTS = f"rows => rows.map(row => modules.passage.readouts({MOTION}))"
# T is the sixth component of a state.
SAMPLES = f"""rows => rows.map(row => {{
    const path = modules.physics.trajectory({MOTION}, 3);
    return row.times.map(t => modules.physics.stateAt(path, modules.physics.T, t));
}})"""


def motion(disk, sigma3_bar, eta_hat, phidot, **more):
    """A motion as the page takes it, from numbers in the units of the disk."""
    unit = disk.rate_unit
    rates = {"sigma3_bar": sigma3_bar / unit, "eta_hat": eta_hat / unit, "phidot": phidot / unit}
    return {"I1": disk.body.I1, "I3": disk.body.I3, **rates, **more}


def test_series_are_those_of_python(javascript, body):
    code = f"row => {{ const made = {BODY}; return [made.rows.map(r => Array.from(r)), made.r0, made.dr0]; }}"
    rows, r0, dr0 = javascript(code, {"I1": body.body.I1, "I3": body.body.I3})
    ours = np.asarray(body.natural.series)
    assert np.allclose(rows, ours, rtol=0.0, atol=1e-13 * abs(ours).max())
    assert [r0, dr0] == pytest.approx([body.body.r0, body.body.dr0], rel=1e-14)


def test_passages_are_the_references_to_nine_digits(javascript, reference_passages):
    names = "sigma3_bar", "eta_hat", "phidot"
    disks = (ex.Disk(I1=row["I1"], I3=row["I3"]) for row in reference_passages)
    given = [[float(row[name]) for name in names] for row in reference_passages]
    found = javascript(READOUTS, [motion(disk, *row) for disk, row in zip(disks, given, strict=True)])
    for row, numbers in zip(reference_passages, found, strict=True):
        assert numbers["delta_chi"] == pytest.approx(row["chi_0"], abs=1e-9)
        assert numbers["theta_min"] == pytest.approx(row["theta_min_0"], rel=1e-9)
        assert numbers["duration"] == pytest.approx(row["duration_0"], rel=1e-9)


def test_readouts_are_those_of_python_for_every_body(javascript, body):
    sigma3_bar, eta_hat, phidot = np.meshgrid([0.0, 0.7, -1.2], [0.1, -3e-4, 1e-9, -1e-20], [0.02, 0.3, 1.5])
    unit = body.rate_unit
    columns = [column.ravel() * unit for column in (sigma3_bar, eta_hat, phidot)]
    passages = ex.passages(body, *columns, accuracy=1e-10)
    # A slow start may be too close to an equilibrium for this accuracy.
    good = passages.status == 0
    assert good.sum() >= 30
    readouts = javascript(READOUTS, [motion(body, *row) for row in np.transpose(columns)[good]])
    scales = {"duration": 1.0 / body.time_unit}
    for name in ("race_angle", "fall_angle", "delta_chi", "theta_min", "duration"):
        expected = getattr(passages, name)[good] * scales.get(name, 1.0)
        assert [row[name] for row in readouts] == pytest.approx(expected, rel=1e-8, abs=1e-8), name


def test_forces_are_those_of_python(javascript, body):
    unit = body.rate_unit
    columns = np.array([[1.0, -0.4, 0.3], [1e-2, -1e-5, 1e-12], [1.0, 0.3, 2.0]]) * unit
    forces = ex.passage_forces(body, *columns)
    found = javascript(READOUTS, [motion(body, *row) for row in columns.T])
    assert [row["min_normal_force"] for row in found] == pytest.approx(forces.min_normal_force, rel=1e-8)
    # JSON has no infinity: the page's becomes null.
    most = [np.inf if row["max_friction"] is None else row["max_friction"] for row in found]
    assert most == pytest.approx(forces.max_friction, rel=1e-6)


@pytest.mark.parametrize("face", [1, -1])
@pytest.mark.parametrize("eta_hat", [0.01, -1e-3, 1e-8, -1e-12])
def test_the_motion_in_time_is_that_of_python(javascript, face, eta_hat):
    disk = ex.Disk.hoop()
    states = ex.constants_to_states(disk, 0.8, eta_hat, 0.9, face)
    times = np.linspace(0.1, 6.0, 40)
    names = ("phi", "phidot", "sigma4", "chi", "psi", "path")
    python = trajectories(states, t_eval=times, observables=names, accuracy=1e-10)
    (found,) = javascript(SAMPLES, [motion(disk, 0.8, eta_hat, 0.9, face=face, times=list(times))])
    q, z, p, _rho, sigma4, _t, chi, psi, a1, a2, _clock = np.transpose(found)
    assert np.allclose(np.arctan2(z, q), python.phi, atol=2e-6)
    assert np.allclose(-p, python.phidot, atol=2e-6)
    assert np.allclose(sigma4, python.sigma4, atol=2e-6)
    assert np.allclose(chi, python.chi, atol=5e-6)
    assert np.allclose(psi, python.psi, atol=5e-6)
    assert np.allclose(np.stack([a1, a2], axis=1), python.path[:, :2], atol=5e-6)


def test_no_race_goes_the_wrong_way(javascript):
    """Motions down to 1e-15: chi grows by about side times kappa pi, never the other way."""
    random = np.random.default_rng(3)
    count = 150
    eta_hat = random.choice([-1.0, 1.0], count) * 10.0 ** random.uniform(-15.0, -2.0, count)
    disk = ex.Disk.uniform()
    rows = [
        motion(disk, *row)
        for row in zip(random.uniform(-1.5, 1.5, count), eta_hat, random.uniform(0.1, 2.0, count), strict=True)
    ]
    code = f"""rows => rows.map(row => {{
        const {{ states, turns }} = modules.physics.trajectory({MOTION}, 1);
        return states[turns[0]][modules.physics.RHO];
    }})"""
    assert np.array_equal(np.sign(javascript(code, rows)), np.sign(eta_hat))


def test_a_motion_that_keeps_to_the_other_face_has_no_race_here(javascript):
    """Leaning far towards face -1, at rest: it rocks there and has not the energy to stand up."""
    rows = [motion(ex.Disk.hoop(), 0.05, 0.05, 0.0, theta=2.9), motion(ex.Disk.hoop(), 1.0, 1e-3, 0.0, theta=1.2)]
    away, near = javascript(READOUTS, rows)
    assert away["race_angle"] is None
    assert 0.0 < near["theta_min"] < 1e-2
    assert near["race_angle"] == pytest.approx(ex.Disk.hoop().race_limit, abs=0.1)
