"""What `probability` says: plain draws, draws beside F and C delta agree, and intervals hold as often as said."""

import math
import os

import numpy as np
import pytest
from scipy import stats

import explorer as ex

UNIFORM, HOOP, RING = ex.Disk.uniform(), ex.Disk.hoop(), ex.Disk.annulus(0.5)
COIN = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
# Name: disk, coordinates, and a delta which some 1e-3 of the states come below.
CASES = {
    "box": (UNIFORM, {"phi": 0, "phidot": (-2, 2), "sigma3": (-2, 2), "sigma4": (-2, 2)}, 1e-3),
    "coin in degrees": (
        COIN,
        {"tilt": stats.norm(60, 5), "precession": stats.norm(0, 900), "spin": (-900, 900), "degrees": True},
        5e-4,
    ),
    "coin in degrees that tilts": (
        COIN,
        {
            "tilt": (20, 80),
            "tilt_rate": stats.norm(0, 500),
            "precession": stats.norm(600, 200),
            "spin": stats.norm(100, 300),
            "degrees": True,
        },
        2e-4,
    ),
    "tail of both spins": (
        UNIFORM,
        {"tilt": stats.norm(1.0, 0.1), "precession": stats.norm(1.4, 0.3), "spin": stats.norm(-0.4, 0.35)},
        5e-3,
    ),
    "precession is a number": (
        HOOP,
        {"tilt": (0.5, 1.2), "tilt_rate": -0.3, "precession": 1.0, "spin": stats.norm(0.5, 0.5)},
        1e-3,
    ),
    "heavy tails": (
        RING,
        {
            "tilt": stats.beta(3, 2),
            "tilt_rate": stats.t(3),
            "precession": stats.cauchy(0, 1),
            "spin": stats.laplace(0, 1),
        },
        2e-4,
    ),
    "energy": (UNIFORM, {"phi": (-0.5, 0.5), "energy": (2, 4), "sigma3": (-1, 1), "sigma4": (-1, 1)}, 5e-4),
    "constants of motion": (
        HOOP,
        {"phidot": stats.norm(0, 1), "sigma3_bar": stats.norm(0, 2), "eta_hat": stats.norm(0.1, 0.2), "face": -1},
        2e-4,
    ),
    "the other face": (
        UNIFORM,
        {"theta": (0.2, 2.0), "thetadot": (-1, 1), "sigma3": (-1, 1), "sigma4": (-2, 2), "face": -1},
        1e-3,
    ),
    "both constants": (RING, {"phidot": (0, 2), "sigma3_bar": (0, 2), "sigma4_bar": stats.norm(0, 1)}, 5e-4),
}
REPETITIONS, DRAWS = (
    int(os.environ.get("NEARFLAT_REPETITIONS", "10")),
    int(os.environ.get("NEARFLAT_DRAWS", "200000")),
)


def asked(name, delta, count=2, **how):
    disk, coordinates, _ = CASES[name]
    return ex.probability(disk, ("theta_min", delta), count=count, **coordinates, **how)


def error(found):
    return (found.interval[1] - found.interval[0]) / 4


@pytest.mark.parametrize("name", CASES)
def test_draws_beside_the_falling_set_agree_with_plain_ones(name):
    delta = CASES[name][2]
    rare, plain = asked(name, delta, samples=20_000), asked(name, delta, samples=DRAWS, rng=1)
    assert (rare.method, plain.method) == ("importance", "plain")
    assert plain.effective_samples >= 100
    assert abs(rare.estimate - plain.estimate) < 4 * math.hypot(error(rare), error(plain))


@pytest.mark.parametrize("name", CASES)
def test_the_law_holds_at_1e_12(name):
    found = asked(name, 1e-12, samples=100_000)
    assert found.method == "importance"
    assert found.effective_samples > 300
    law = found.law.constant * 1e-12
    assert abs(found.estimate - law) < 4 * math.hypot(error(found), found.law.error * 1e-12)
    assert 1e-12 < found.law.holds_below <= 0.1


def by_tilt(tilt, precession, spin):
    """A density of tilt, precession and spin at rest as `falling_constant` takes it, up to a factor."""

    def density(phi, phidot, sigma3, sigma4):
        q = np.cos(phi)
        return tilt.pdf(np.pi / 2 - phi) * precession.pdf(sigma3 / q**2) / q**2 * spin.pdf(sigma4)

    return density


def test_c_is_that_of_an_integral_over_the_falling_set():
    tilt, precession, spin = stats.norm(0.9, 0.1), stats.norm(0, 0.4), stats.norm(0, 0.4)
    box = {"phi": (-0.1, 1.5), "phidot": 0.2, "sigma3": (-2.5, 2.5), "sigma4": (-2.5, 2.5)}
    C = ex.falling_constant(UNIFORM, box, density=by_tilt(tilt, precession, spin))
    found = ex.probability(
        UNIFORM,
        ("theta_min", 1e-12),
        tilt=tilt,
        tilt_rate=-0.2,
        precession=precession,
        spin=spin,
        count=2,
        samples=200_000,
    )
    assert abs(found.law.constant - C.value) < 4 * math.hypot(found.law.error, C.error)
    assert abs(found.estimate / 1e-12 - C.value) < 4 * math.hypot(error(found) / 1e-12, C.error)
    assert found.law.error < 0.02 * C.value


def test_one_bounce_is_half_of_a_box_that_looks_the_same_with_time_reversed():
    one, two = (
        ex.probability(UNIFORM, ("theta_min", 1e-9), count=count, samples=100_000, **CASES["box"][1])
        for count in (1, 2)
    )
    assert abs(2 * one.estimate - two.estimate) < 4 * math.hypot(2 * error(one), error(two))


NEARLY_FLAT = {"tilt": stats.norm(0.35, 0.1), "precession": stats.norm(1.4, 0.3), "spin": stats.norm(-1, 0.35)}


def test_a_cloud_that_reaches_flat_has_no_law_and_still_a_probability():
    found = ex.probability(UNIFORM, ("theta_min", 1e-9), samples=200_000, **NEARLY_FLAT)
    # A start at rest at the small tilt t comes down to some t^1.5: all below delta^(2/3) do, 100 times as many
    # at 1e-6.
    more = ex.probability(UNIFORM, ("theta_min", 1e-6), samples=200_000, **NEARLY_FLAT)
    assert found.law is None
    assert "no law" in repr(found)
    assert more.estimate / found.estimate == pytest.approx(100, rel=0.2)


# Of 100 intervals at least 90; fewer tell less, and in the suite there are some of one distribution.
ENOUGH = 90 if REPETITIONS == 100 else 0.9 * REPETITIONS - 1


@pytest.mark.parametrize("name", CASES if REPETITIONS >= 100 else ["coin in degrees"])
def test_the_interval_of_rare_tilts_holds_as_often_as_said(name):
    truth = asked(name, 1e-8, samples=1_900_000, rng=10_000)
    inside = 0
    for seed in range(REPETITIONS):
        low, high = asked(name, 1e-8, samples=4000, rng=seed).interval
        assert high - low > 5 * (truth.interval[1] - truth.interval[0])
        inside += low < truth.estimate < high
    assert inside >= ENOUGH


def test_the_interval_of_plain_draws_holds_as_often_as_said():
    def clockwise(bounces):
        return bounces.race_angle > 0

    # The mirror image of a motion races the other way round, and is as likely.
    cloud = {"phi": 0, "phidot": (-2, 2), "sigma3": (-2, 2), "sigma4": (-2, 2)}
    intervals = [
        ex.probability(UNIFORM, clockwise, samples=1000, rng=seed, **cloud).interval for seed in range(REPETITIONS)
    ]
    share = ex.probability(UNIFORM, clockwise, samples=100_000, rng=10_000, **cloud).estimate
    assert sum(low < share < high for low, high in intervals) >= ENOUGH


def test_an_event_of_bounces_counts_a_state_once():
    def on_the_other_face(bounces):
        return bounces.face == -1

    start = {"tilt": (0.5, 1.5), "tilt_rate": 1.5, "precession": 0.2, "spin": (-0.2, 0.2)}
    one = ex.probability(UNIFORM, on_the_other_face, samples=2000, **start)
    three = ex.probability(UNIFORM, on_the_other_face, samples=2000, count=3, **start)
    assert one.method == "plain"
    assert one.law is None
    assert one.estimate <= three.estimate <= 1
    never = ex.probability(UNIFORM, lambda bounces: bounces.theta_min < 0, samples=2000, **start)
    assert never.estimate == 0
    assert never.interval[0] == 0
    assert never.interval[1] == pytest.approx(1 - 0.05 ** (1 / 2000))
    assert "no hit: with a confidence of 95 % it is at most 0.001497" in repr(never)
    assert "more samples" in never.note


@pytest.mark.parametrize("samples", [10, 1000])
def test_a_rare_tilt_is_found_however_few_samples_are_asked_for(samples):
    event = "theta_min", 1e-3
    many = ex.probability(UNIFORM, event, samples=300_000, rng=100, **NEARLY_FLAT)
    some = [ex.probability(UNIFORM, event, samples=samples, rng=rng, **NEARLY_FLAT) for rng in range(5)]
    assert {few.method for few in some} == {"importance"}
    off = [abs(few.estimate - many.estimate) / math.hypot(error(few), error(many)) for few in some]
    assert sorted(off)[3] < 3


def test_where_nothing_moves_eta_the_share_is_counted_and_it_says_so():
    found = ex.probability(
        UNIFORM, ("theta_min", 4e-4), phidot=(0, 1), sigma3_bar=1.0, eta_hat=0.0005, samples=2000
    )
    assert 0 < found.estimate < 1
    assert "single tilts or not at all" in repr(found)
    fixed = ex.probability(
        UNIFORM, ("theta_min", 1e-3), phidot=(0, 1), sigma3_bar=(0, 1), eta_hat=0.5, samples=2000
    )
    assert fixed.estimate == 0
    assert "eta_hat is fixed" in fixed.note


@pytest.mark.parametrize("phi", [(0.1, 1.4), (-1.4, -0.1)])
@pytest.mark.parametrize("event", [("theta_min", 1e-3), lambda bounces: bounces.theta_min < 1e-3])
def test_where_all_states_fall_the_probability_is_one_on_either_face(phi, event):
    found = ex.probability(UNIFORM, event, phi=phi, phidot=(-1, 1), sigma3=0, sigma4=0, samples=2000)
    assert found.estimate == 1
    assert found.interval[0] > 0.998


def test_motions_on_f_that_first_come_to_the_other_face_fall_at_the_second_approach():
    on_f = {"phidot": (-2, 2), "sigma3_bar": (0.2, 1), "samples": 4000, "accuracy": 1e-3}
    for count, share in ((1, 0.5), (2, 1.0)):
        found = ex.probability(UNIFORM, ("theta_min", 1e-6), count=count, eta_hat=0.0, **on_f)
        beside = ex.probability(UNIFORM, ("theta_min", 1e-6), count=count, eta_hat=1e-12, **on_f)
        assert found.estimate == beside.estimate == pytest.approx(share, abs=0.05)


def test_draws_that_are_no_states_are_left_out():
    given = {**NEARLY_FLAT, "samples": 100_000}
    # A tenth of the first distribution lies below 0.
    wide, positive = stats.norm(0.35, 0.27), stats.truncnorm(-0.35 / 0.27, 10, 0.35, 0.27)
    some, cut = (
        ex.probability(UNIFORM, ("theta_min", 1e-9), **given | {"tilt": tilt}) for tilt in (wide, positive)
    )
    assert some.method == cut.method == "importance"
    assert abs(some.estimate - cut.estimate) < 4 * math.hypot(error(some), error(cut))
    with pytest.raises(ex.RunError, match="are states; give tilts between 0 and pi"):
        ex.probability(UNIFORM, ("theta_min", 1e-9), **given | {"tilt": -1.0})


def test_the_same_rng_gives_the_same_numbers():
    first, second = (asked("box", 1e-6, samples=10_000, rng=7) for _ in range(2))
    other = asked("box", 1e-6, samples=10_000, rng=np.random.default_rng(8))
    assert first == second != other


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"tilt": stats.poisson(3)}, "or a continuous frozen distribution"),
        ({"tilt": "norml:1:2"}, "did you mean 'norm'"),
        ({"tilt": "norm:1:2:3:4"}, "norm"),
        ({"tilt": "norm:1:-2"}, "not the parameters"),
        ({"tilt": "norm"}, "not the parameters"),
        ({"tilt": [1, 2, 3]}, "or a continuous frozen distribution"),
        ({"tilt": stats.norm}, "or a continuous frozen distribution"),
        ({"tilt": (2, 1)}, "or a continuous frozen distribution"),
        ({"event": ("theta_max", 1)}, "give theta_min:DELTA"),
        ({"event": ("theta_min", 2)}, "from 1e-100 to 1"),
        ({"event": lambda bounces: bounces.theta_min, "samples": 1000}, "return a bool"),
        ({"rng": "seed"}, "SeedSequence"),
        ({"count": 0}, "count"),
        ({"tillt": 1}, "did you mean 'tilt'"),
        ({"sigma3": 1}, "leave out"),
    ],
)
def test_what_cannot_be_used_is_refused_in_a_sentence(given, message):
    start = {"tilt": (0.5, 1.5), "precession": 0.2, "spin": (-0.2, 0.2), **given}
    with pytest.raises(ex.InputError, match=message):
        ex.probability(UNIFORM, **start)


@pytest.mark.parametrize("tilt", ["1e-6:1e-2", "1e-6:1e-3", "1e-8:1e-5", "norm:1e-4:1e-6"])
def test_narrow_distributions_beside_flat_have_a_probability(tilt):
    found = ex.probability(ex.Disk.uniform(), tilt=tilt, precession="0:2", spin="0", samples=2000)
    assert 0.0 <= found.interval[0] <= found.estimate <= found.interval[1] <= 1.0
    assert found.effective_samples > 0
