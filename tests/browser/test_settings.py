"""What the page says is right for every setting of its sliders: the numbers of Python, or a sentence."""

import itertools
import json
import os

import numpy as np
import pytest
from browser.test_page import DIGITS, number_in, shown, slide, written

import explorer as ex

# 1,512 settings, of which the suite takes every tenth; `nox -s page` takes all.
SETTINGS = list(
    itertools.product(
        ("uniform", "hoop", "matching", "annulus:0.5"),
        (-2.5, -0.7, -0.03, 0.0, 0.01, 0.09, 1.0),
        (-1.0, -0.06, -1e-9, 1e-12, 1e-3, 1.0),
        (-3.0, -1.0, -0.1, -0.01, 0.0, 0.01, 0.1, 1.0, 3.0),
    )
)
EVERY = int(os.environ.get("NEARFLAT_SETTINGS", "10"))
TAKEN = SETTINGS[3 % EVERY :: EVERY]
NAMES = ("disk", "sigma3_bar", "eta_hat", "phidot")
SET = """rows => rows.map(row => {
    nearflat.store.set(row);
    const { numbers, otherNumbers } = nearflat.store;
    const text = name => document.getElementById(name).textContent;
    return { numbers, otherNumbers, race: text("race"), thetaMin: text("theta-min"), told: text("told") };
})"""


def expected(side):
    """Python's columns for all settings, on the side that is shown or on the other one."""
    columns = {}
    for disk in dict.fromkeys(row[0] for row in TAKEN):
        body = ex.Disk.parse(disk)
        rows = [index for index, row in enumerate(TAKEN) if row[0] == disk]
        bar, eta_hat, phidot = np.array([TAKEN[index][1:] for index in rows]).T
        given = (body, bar, side * eta_hat, abs(phidot))  # upwards it comes back as fast as it went
        passages, forces = ex.passages(*given), ex.passage_forces(*given)
        columns |= {
            index: (passages.status[n] == 0, passages.race_angle[n], passages.theta_min[n],
                    forces.min_normal_force[n], forces.max_friction[n])
            for n, index in enumerate(rows)
        }  # fmt: skip
    return [columns[index] for index in range(len(TAKEN))]


@pytest.mark.long
def test_every_setting_has_the_numbers_of_python_or_a_sentence(page):
    page.evaluate("(nearflat.player.running = false, 0)")
    found = []
    for first in range(0, len(TAKEN), 50):
        rows = [dict(zip(NAMES, row, strict=True)) for row in TAKEN[first : first + 50]]
        found += page.evaluate(f"({SET})({json.dumps(rows)})")
    page.evaluate("(nearflat.store.reset(), 0)")
    for setting, said, this, other in zip(TAKEN, found, expected(1), expected(-1), strict=True):
        for numbers, (good, race, theta_min, least, most) in (
            (said["numbers"], this),
            (said["otherNumbers"], other),
        ):
            assert good == (not numbers["told"]), setting
            if good:
                assert numbers["race_angle"] == pytest.approx(race, abs=1e-6), setting
                assert numbers["theta_min"] == pytest.approx(theta_min, rel=1e-6), setting
                assert numbers["min_normal_force"] == pytest.approx(least, abs=1e-6, rel=1e-6), setting
                # Infinity does not travel through JSON.
                friction = np.inf if numbers["max_friction"] is None else numbers["max_friction"]
                assert friction == pytest.approx(most, rel=1e-6), setting
        if this[0]:
            # Written with four and with three digits.
            assert number_in(said["race"]) == pytest.approx(this[1], rel=0.5e-3), setting
            assert number_in(said["thetaMin"]) == pytest.approx(this[2], rel=0.5e-2), setting
        else:
            assert said["race"] == said["told"], setting
            assert not any(letter.isdigit() for letter in said["race"].translate(DIGITS)), setting
    assert page.problems() == []
    assert sum(not good for good, *_ in expected(1)) >= 2


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"sigma3_bar": 0.0, "phidot": 0.0}, "starts at an equilibrium"),
        ({"sigma3_bar": 1.0, "phidot": 0.0, "eta_hat": 1.0}, "moves towards the other face"),
        ({"sigma3_bar": 1e-7, "phidot": 0.0}, "too near an equilibrium"),
        ({"sigma3_bar": 1.0, "phidot": 1.0, "eta_hat": 0.0}, "the equations do not say what comes next"),
    ],
    ids=str,
)
def test_where_there_is_no_race_a_sentence_says_why(page, values, says):
    page.evaluate(f"(nearflat.store.set({json.dumps(values)}), 0)")
    assert says in written(page, "told")
    assert says in written(page, "race")
    assert written(page, "theta-min") == "–"
    page.evaluate("(nearflat.store.reset(), 0)")
    assert written(page, "told") == ""


def test_the_ruler_sticks_at_f_and_the_fall_is_shown(page):
    slide(page, "eta", 0.0)
    assert shown(page)["eta_hat"] == 0.0
    assert page.evaluate("document.getElementById('flip').disabled")
    code = """nearflat.store.main.states.map(x => modules.physics.tiltOf(x, 1))"""
    tilts = np.array(page.evaluate(code))
    assert (np.diff(tilts) < 0.0).all()
    assert tilts[-1] < 1e-6
    took = page.evaluate("nearflat.store.main.states.at(-1)[modules.physics.T]")
    beside = ex.passages(ex.Disk.uniform(), 1.0, 1e-15, 1.0)
    assert took == pytest.approx(0.5 * beside.duration, abs=1e-6)
    page.evaluate("(nearflat.player.seek(99), nearflat.draw(), 0)")
    assert "race" not in written(page, "clock")
    page.key("f")
    assert shown(page)["eta_hat"] == 0.0
    page.evaluate("(nearflat.store.reset(), 0)")


@pytest.mark.parametrize("eta_hat", [1e-12, -1e-3, 0.5, -1.0])
@pytest.mark.parametrize("disk", ["uniform", "hoop"])
def test_the_race_over_the_picture_goes_without_a_jump_to_the_number_of_the_card(page, disk, eta_hat):
    values = {"disk": disk, "eta_hat": eta_hat}
    code = """values => {
        const { store, scene, player } = nearflat, { stateAt, CLOCK, T } = modules.physics;
        store.set(values);
        const ends = [store.main, store.other].map((path, n) => {
            const { duration } = [store.numbers, store.otherNumbers][n];
            const at = x => modules.scene.raceAt(scene.races[n], x, 1).turned, { clock } = scene.races[n][0];
            const ends = [0, duration].map(t => at(stateAt(path, T, t)));
            const [before, after] = [-1e-6, 1e-6].map(aside => at(stateAt(path, CLOCK, clock + aside)));
            return [ends[0], before, after, ends[1]];
        });
        const wanted = [store.numbers.race_angle, store.otherNumbers.race_angle];
        store.reset();
        return [ends, wanted];
    }"""
    ends, wanted = page.evaluate(f"({code})({json.dumps(values)})")
    for (start, before, after, end), race in zip(ends, wanted, strict=True):
        assert start == pytest.approx(0.0, abs=1e-4)
        assert [before, after] == pytest.approx([0.5 * race] * 2, abs=1e-4)
        assert end == pytest.approx(race, abs=1e-4)


def test_both_motions_go_on_as_long_as_the_picture(page):
    """At large eta_hat the other side is through its bounces sooner."""
    code = """values => {
        nearflat.store.set(values);
        const { main, other } = nearflat.store;
        const ends = [main, other].map(path => path.states.at(-1)[modules.physics.CLOCK]);
        nearflat.store.reset();
        return ends;
    }"""
    for eta_hat in (0.5, -0.5):
        main, other = page.evaluate(f"({code})({json.dumps({'eta_hat': eta_hat, 'phidot': 0.6})})")
        assert other >= main
