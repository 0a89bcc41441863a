"""Disks: presets, text forms, units, and what no disk has."""

import copy
import json
import math
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import explorer as ex
from explorer.commands.main import main
from explorer.phase.disk import PRESETS


@pytest.mark.parametrize(("name", "ratio"), [("uniform", 4), ("hoop", 2), ("matching", 3)])
def test_presets_have_the_papers_moments(name, ratio):
    disk = ex.Disk.parse(name)
    assert pytest.approx(ratio, rel=1e-15) == 1 / disk.I1
    assert disk.I3 == 2 * disk.I1
    assert disk.kappa == pytest.approx(np.sqrt(1 + ratio), rel=1e-15)
    assert name in PRESETS


@pytest.mark.parametrize(("name", "gap"), [("uniform", 1.483259), ("hoop", 4.599611), ("matching", 0.0)])
def test_the_gap_between_the_limits_has_the_published_value_in_any_units(name, gap):
    for m, r, g in ((1, 1, 1), (0.0057, 0.0121, 9.81), (3e3, 1e3, 1.62)):
        assert getattr(ex.Disk, name)(m=m, r=r, g=g).gap == pytest.approx(gap, abs=1e-6)


def test_an_annulus_goes_from_uniform_to_hoop():
    assert ex.Disk.annulus(0.0).I1 == ex.Disk.uniform().I1
    assert ex.Disk.annulus(1.0).I1 == ex.Disk.hoop().I1
    assert ex.Disk.parse("annulus:0.5773502691896258").kappa == pytest.approx(2.0, rel=1e-15)


def test_c_and_d_of_the_paper():
    """Checklist 16."""
    for disk, c, d in (
        (ex.Disk.uniform(), 4 / 3, 2 / 3),
        (ex.Disk.hoop(), 1, 1),
        (ex.Disk.matching(), 6 / 5, 4 / 5),
    ):
        b = disk.body
        assert b.c == pytest.approx(c, rel=1e-15)
        assert pytest.approx(d, rel=1e-15) == b.I3**2 / (b.J * b.I1)


@pytest.mark.parametrize("key", ["m", "r", "g", "I1"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_quantities_that_no_disk_has_are_refused_by_name_and_value(key, value):
    with pytest.raises(ex.InputError, match=rf"{key} = {value}"):
        ex.Disk(**{key: value})


@pytest.mark.parametrize("value", [-0.1, np.nan, 0.6])
def test_i3_outside_zero_to_twice_i1_is_refused(value):
    with pytest.raises(ex.InputError, match=f"I3 = {value}"):
        ex.Disk(I1=0.25, I3=value)


def test_text_forms_of_a_disk(tmp_path):
    assert ex.Disk.parse("m=2,r=3,g=9.81,I1=1,I3=1.5").r == 3.0
    path = tmp_path / "coin.toml"
    path.write_text("m = 0.0057\nr = 0.0121\ng = 9.81\nI1 = 2.0e-7\nI3 = 4.0e-7\n")
    disk = ex.Disk.parse(str(path))
    assert (disk.name, disk.g) == ("coin", 9.81)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("unifrom", "not known"),
        ("annulus:2", "between 0 and 1"),
        ("annulus:x", "as in annulus:0.5"),
        ("annulus", "as in annulus:0.5"),
        ("m=1,r=1", "I1 and I3 missing"),
        ("Hoop", "did you mean 'hoop'"),
        ("uniform:m=20s", "m = 20s is not a number; give one, also in kg, g"),
        ("m=1,q=2,I1=1,I3=1", "quantity 'q' is not known"),
        ("m=one,I1=1,I3=1", "not a number"),
        ("nowhere.toml", "cannot be read"),
    ],
)
def test_text_that_names_no_disk_is_refused_in_words(text, message):
    with pytest.raises(ex.InputError, match=message):
        ex.Disk.parse(text)


def test_a_broken_disk_file_is_refused(tmp_path):
    path = tmp_path / "broken.toml"
    path.write_text("m = = 1")
    with pytest.raises(ex.InputError, match="not valid TOML"):
        ex.Disk.parse(str(path))
    path.write_text('m = "heavy"\nI1 = 1.0\nI3 = 1.0\n')
    with pytest.raises(ex.InputError, match="not a number"):
        ex.Disk.parse(str(path))


def test_units_of_an_si_disk():
    coin = ex.Disk.uniform(m=0.0057, r=0.0121, g=9.81)
    assert coin.rate_unit * coin.time_unit == pytest.approx(1.0)
    *constants, anchor = coin.body
    *plain, flat = ex.Disk.uniform().body
    assert constants == pytest.approx(plain, rel=1e-15)
    assert anchor == flat


@pytest.mark.parametrize("name", [*PRESETS, "annulus"])
def test_every_preset_takes_mass_radius_and_gravity(name):
    text = "annulus:0.4,m=5.67e-3,r=12.1e-3,g=9.81" if name == "annulus" else f"{name}:m=5.67e-3,r=12.1e-3,g=9.81"
    scales = {"m": 5.67e-3, "r": 12.1e-3, "g": 9.81}
    made = ex.Disk.annulus(0.4, **scales) if name == "annulus" else getattr(ex.Disk, name)(**scales)
    assert ex.Disk.parse(text) == made


def test_a_preset_can_have_a_name_of_its_own():
    assert ex.Disk.parse("uniform:m=5.67e-3,r=12.1e-3,g=9.81,name=quarter").name == "quarter"


def test_flat_stands_for_twice_the_transverse_moment():
    assert ex.Disk.parse("I1=0.3,I3=flat").I3 == 0.6


def test_an_axial_moment_that_is_larger_by_rounding_is_that_of_a_flat_body():
    """Products of the same numbers in another order differ in the last digit, and no body has I3 > 2 I1."""
    assert ex.Disk(I1=0.3, I3=math.nextafter(0.6, 1.0)).I3 == 0.6
    random = np.random.default_rng(1)
    for m, r in random.uniform(1e-3, 1.0, (500, 2)):
        disk = ex.Disk(m=m, r=r, g=9.81, I1=0.25 * m * r * r, I3=0.5 * m * r**2)
        assert disk.I3 <= 2.0 * disk.I1


def test_a_moment_that_no_body_has_is_refused_with_what_a_flat_one_has():
    for I3 in ("0.6667", "0.6669", repr(0.6666 * (1.0 + 1e-14))):
        with pytest.raises(ex.InputError, match=r"exceeds 2 I1.* for a flat one give I3=flat"):
            ex.Disk.parse(f"I1=0.3333,I3={I3}")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("uniform:I1=0.3", "quantity 'I1' is not known"),
        ("uniform:heavy", "'heavy' is not NAME=VALUE"),
        ("hoop:m=heavy", "disk: m"),
        ("annulus:", "annulus"),
    ],
)
def test_scales_of_presets_that_cannot_be_read_are_named(text, message):
    with pytest.raises(ex.InputError, match=message):
        ex.Disk.parse(text)


@pytest.mark.parametrize(
    "text", ["coin", "uniform:m=x", "uniform:q=1", "annulus:2", "I1=1", "I1=1,I3=5", "m=-1,I1=1,I3=1"]
)
def test_a_disk_that_cannot_be_read_is_named_as_the_command_line_knows_it(text, capsys):
    assert main(["passage", "--disk", text, "--sigma3-bar=1", "--eta-hat=1e-3", "--phidot=1"]) == 2
    assert "disk" in capsys.readouterr().err


def test_a_description_is_a_dict_for_files_and_a_text_with_units_for_readers():
    coin = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
    described = coin.describe()
    assert ex.Disk(**described) == ex.Disk(**json.loads(json.dumps(described))) == coin
    assert (described["name"], described["m"], described["I3"]) == ("uniform", 5.67e-3, coin.I3)


def test_moments_that_are_left_out_are_those_of_a_flat_uniform_disk():
    scales = {"m": 5.67e-3, "r": 12.1e-3, "g": 9.81}
    assert ex.Disk(**scales, name="uniform") == ex.Disk.uniform(**scales)
    assert ex.Disk(I1=0.3).I3 == 0.6
    assert ex.Disk(I3=0.4).I1 == 0.25


def test_a_number_may_be_text_and_other_text_is_refused():
    assert ex.Disk.uniform(m="1e-3", g="9.81") == ex.Disk.uniform(m=1e-3, g=9.81)
    assert ex.Disk(I1="0.3", I3="flat") == ex.Disk(I1=0.3)
    for make, said in (
        (lambda: ex.Disk.uniform(m="heavy"), "disk: m = heavy is not a number"),
        (lambda: ex.Disk(I1=0.3, I3="thin"), "disk: I3 = thin is not a number"),
        (lambda: ex.Disk.annulus("half"), "annulus .*half is not a number"),
        (lambda: ex.Disk(I1=1.0, I3=np.zeros(3)), "disk: I3 = ndarray of shape .* is not a number"),
    ):
        with pytest.raises(ex.InputError, match=said):
            make()


_WITHOUT_G = {
    "Disk": lambda **scales: ex.Disk(**scales),
    "uniform": lambda **scales: ex.Disk.uniform(**scales),
    "hoop": lambda **scales: ex.Disk.hoop(**scales),
    "matching": lambda **scales: ex.Disk.matching(**scales),
    "annulus": lambda **scales: ex.Disk.annulus(0.5, **scales),
    "from_ratios": lambda **scales: ex.Disk.from_ratios(I1=0.3, **scales),
    "parse": lambda **scales: ex.Disk.parse("uniform:" + ",".join(f"{k}={v}" for k, v in scales.items())),
}


@pytest.mark.parametrize("name", _WITHOUT_G)
def test_a_mass_or_a_radius_without_gravity_is_warned_of_at_the_line_of_the_caller(name):
    make = _WITHOUT_G[name]
    for scales in ({"m": 5.67e-3}, {"r": 12.1e-3}, {"m": 5.67e-3, "r": 12.1e-3}, {"m": 1.0}):
        with pytest.warns(UserWarning, match=r"without g, which is then 1; give g=9\.81") as told:
            assert make(**scales).g == 1.0
        assert [Path(each.filename).name for each in told] == [Path(__file__).name]


@pytest.mark.parametrize("name", _WITHOUT_G)
def test_natural_units_and_copies_of_a_disk_give_no_warning(name):
    make = _WITHOUT_G[name]
    make(g=9.81)
    if name != "parse":
        make()
    with pytest.warns(UserWarning, match="without g"):
        disk = make(r=0.05)
    assert replace(disk, r=0.06).g == 1.0
    assert ex.Disk(**disk.describe()) == pickle.loads(pickle.dumps(disk)) == copy.deepcopy(disk) == disk
    assert ex.Disk.parse("uniform:m=5.67g,r=12.1mm").g == 9.81


@pytest.mark.parametrize(
    "quantity",
    [{"r": "12.1 mm"}, {"m": "5.67g"}, {"I1": "150 g cm^2"}, {"I3": "150 g cm^2"}, {"r": ".5 cm"}, {"r": "-1 m"}],
)
def test_a_number_with_a_unit_is_referred_to_the_call_that_reads_units(quantity):
    with pytest.raises(ex.InputError, match=r"Disk\.parse"):
        ex.Disk(**quantity)
    with pytest.raises(ex.InputError, match=r"Disk\.parse"):
        ex.Disk.from_ratios(**{"I1": 0.3} | quantity)


def test_quantities_may_carry_units():
    assert ex.Disk.parse("uniform:m=20g,r=5cm,g=9.81 m/s^2") == ex.Disk.uniform(m=0.02, r=0.05, g=9.81)
    for moment in ("150 g cm^2", "150gcm^2", "150 g cm2", "150g*cm²", "1.5e-5 kg m^2"):
        given = ex.Disk.parse(f"m=0.02kg,r=50mm,I1={moment},I3=2.25e-5kgm2")
        assert (given.m, given.r, given.I1, given.I3) == pytest.approx((0.02, 0.05, 1.5e-5, 2.25e-5), rel=1e-14)
    with pytest.raises(ex.InputError, match=r"also in kg m\^2, g cm\^2"):
        ex.Disk.parse("m=20g,r=5cm,I1=150 g cm")


def test_ratios_are_moments_in_units_of_a_hoop():
    scales = {"m": 0.02, "r": 0.05, "g": 9.81}
    wheel = ex.Disk.from_ratios(I1=0.3, I3=0.45, **scales)
    np.testing.assert_allclose([wheel.body.I1, wheel.body.I3], [0.3, 0.45], rtol=1e-14)
    assert ex.Disk.from_ratios(I1=0.25, **scales) == ex.Disk(**scales)
    with pytest.warns(UserWarning, match="use Disk.from_ratios"):
        ex.Disk(I1=0.3, I3=0.45, **scales)
    with pytest.raises(TypeError):
        ex.Disk(0.3, 0.45)


@pytest.mark.parametrize(("gravity", "g"), [("", 9.81), ("g = 1.62", 1.62), ('g = "1.62 m/s^2"', 1.62)])
def test_a_file_of_a_disk_may_have_units_and_its_own_gravity(gravity, g, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "moon.toml").write_text(f'm = "20g"\nr = "5cm"\nI1 = "150 g cm^2"\nI3 = "flat"\n{gravity}\n')
    disk = ex.Disk.parse("moon.toml")
    assert disk.m == pytest.approx(0.02)
    assert disk.g == pytest.approx(g)
    assert pytest.approx(3e-5) == disk.I3
