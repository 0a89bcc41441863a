"""Options of scenes: declared once for the command line, files, Python and run.json; what is wrong is refused."""

import inspect
import json
import re
import tomllib

import numpy as np
import pytest

import explorer as ex
from explorer.commands.main import parser_of
from explorer.measure.slices import Slice
from explorer.scenes.options import described, options_of
from explorer.scenes.scene import NAMES, read_scene_file, scene_class, scene_of

GIVEN = {
    "falling-set": {
        "disk": "hoop",
        "samples": "2e3",
        "box": "phi=-1:1,sigma4=-0.5",
        "energy": ":3",
        "slice": "phi=0,phidot=1,sigma3=-2:2,sigma4=-1e-3:2",
        "grid": "21",
        "keep": "none",
        "theta-min": "near",
    },
    "measure-zero": {
        "seed": "7",
        "energy": "1.2:4",
        "box": "phi=-1:1,sigma3=norm:0.5:1",
        "ladder": "1e-7:1e-1",
        "tube": "512",
    },
    "one-sided": {
        "disk": "m=2,r=0.3,g=9.81,I1=0.05,I3=0.06",
        "samples": "3",
        "box": "phidot=1:2",
        "eta-hat": "1e-5:1e-3",
    },
    "race-angles": {
        "method": "dop853",
        "accuracy": "1e-7",
        "eta-hat": "1e-4:1e-2",
        "box": "sigma3=-1:2",
        "keep": "all",
    },
}


def made(name, **options):
    return scene_class(name).of(options)


def from_command_line(name):
    words = [name, *(f"--{flag}={value}" for flag, value in GIVEN[name].items())]
    found = vars(parser_of("run", words).parse_args(words))
    return made(
        name,
        **{key: found[key.replace("-", "_")] for key in map(str, found) if key.replace("_", "-") in GIVEN[name]},
    )


def from_file(name):
    content = tomllib.loads("".join(f"{key} = '{value}'\n" for key, value in GIVEN[name].items()))
    return made(name, **{key.replace("-", "_"): value for key, value in content.items()})


@pytest.mark.parametrize("name", GIVEN)
def test_the_command_line_a_file_python_and_the_record_say_the_same(name):
    scene = made(name, **{key.replace("-", "_"): value for key, value in GIVEN[name].items()})
    assert from_command_line(name).options == from_file(name).options == scene.options
    record = json.loads(json.dumps(scene.options, allow_nan=False))
    assert scene_of(record).options == scene.options


@pytest.mark.parametrize("name", NAMES)
def test_the_defaults_of_a_scene_are_read_back_from_its_record(name):
    scene = made(name)
    assert scene_of(json.loads(json.dumps(scene.options))).options == scene.options


@pytest.mark.parametrize("name", NAMES)
def test_every_option_is_a_keyword_of_run_described_there_and_a_flag_with_help(name):
    text = " ".join(parser_of("run", [name]).format_help().split())
    entries = {line.split(" : ")[0] for line in ex.run.__doc__.splitlines() if " : " in line}
    for each in options_of(scene_class(name)):
        assert each.name in inspect.signature(ex.run).parameters
        assert each.name in entries
        of_python_only = each.metadata["reader"].metavar is None
        assert of_python_only or re.search(rf"--{each.name.replace('_', '-')}\b", text)
        assert described(each)
    assert "--ladder" not in text or name == "measure-zero"


@pytest.mark.parametrize(
    ("scene", "options", "message"),
    [
        ("race-angels", {}, "did you mean 'race-angles'"),
        ("falling-set", {"samples": 0}, "samples = 0"),
        ("falling-set", {"samples": "1e400"}, "finite"),
        ("falling-set", {"samples": 1.5}, "whole number"),
        ("falling-set", {"samples": "many"}, "not a number"),
        ("falling-set", {"eta_hat": "1e-3:1e-2"}, "takes no such option"),
        ("falling-set", {"slice": "phi=0,phidot=1"}, "slice"),
        ("falling-set", {"slice": [1, 2]}, "slice"),
        ("falling-set", {"energy": ":nan"}, "finite"),
        ("falling-set", {"energy": ":0"}, "widen it or shrink the box"),
        ("falling-set", {"disk": ex.Disk(I1=0.3, I3=0.0)}, "I3 = 0"),
        ("falling-set", {"box": 3}, "box"),
        ("falling-set", {"box": {"phi": [1, 2, 3]}}, "box"),
        ("falling-set", {"box": {"tilt": [0, 1]}}, "box"),
        ("falling-set", {"density": 3}, "cannot be called"),
        ("falling-set", {"box": "phidot=norm:0:-1"}, "box phidot norm:0:-1: not the parameters of norm"),
        ("falling-set", {"gaussian": "phidot=0:1"}, "gaussian: falling-set takes no such option"),
        ("measure-zero", {"ladder": "1e-3"}, "ladder = 1e-3 must be LOW:HIGH with 1e-100 <= LOW < HIGH"),
        ("one-sided", {"eta_hat": "1:1e10"}, "eta_hat"),
        ("race-angles", {"eta_hat": "1e-320:1e-310"}, "eta_hat"),
        ("one-sided", {"box": "sigma4=1:2"}, "box sigma4"),
        ("one-sided", {"box": "phi=0.2"}, "box phi"),
        ("race-angles", {"box": "phi=0.2", "eta_hat": "1e-3:1e-2"}, "eta_hat: is for start near"),
        ("race-angles", {"box": "phidot=-2:2"}, "towards flat"),
        ("race-angles", {"eta_hat": "0:1"}, "eta_hat"),
        ("race-angles", {"eta_hat": "1e-2:1e-3"}, "eta_hat"),
        ("race-angles", {"method": "rk45"}, "method"),
        ("race-angles", {"accuracy": "1e-40"}, "accuracy"),
        ("race-angles", {"seed": -1}, "seed"),
        ("race-angles", {"disk": ["hoop", "uniform"]}, "disk"),
        ("race-angles", {"disk": {"m": 1, "colour": 2}}, "disk"),
        ("race-angles", {"disk": ex.Disk(I1=0.3, I3=0.0)}, "I3 = 0"),
        ("one-sided", {"disk": ["hoop", "hoop"]}, "different names"),
        ("one-sided", {"disk": [3]}, "disk"),
    ],
)
def test_options_that_make_no_sense_are_refused_by_name(scene, options, message):
    with pytest.raises(ex.InputError, match=message):
        made(scene, **options)


@pytest.mark.parametrize("name", ["falling", 5, None, ["falling-set"]])
def test_what_is_no_scene_is_answered_with_the_known_ones(name):
    with pytest.raises(ex.InputError, match="known: falling-set, measure-zero, one-sided, race-angles"):
        scene_class(name)


def test_a_scene_of_before_is_answered_with_what_to_use_instead():
    with pytest.raises(ex.InputError, match=r"scene portrait: .*nearflat portrait --only phase"):
        made("portrait", eta_hat=0.1)


def test_dashes_and_underscores_are_the_same_in_a_scene_file(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text('scene = "race-angles"\neta-hat = "1e-3:1e-2"\n')
    assert read_scene_file(path) == {"scene": "race-angles", "eta_hat": "1e-3:1e-2"}


def test_ranges_are_text_a_mapping_or_a_box_and_keep_all_digits():
    third = {"phi": (-1.0 / 3.0, 1.0 / 3.0), "sigma3": "0.1"}
    box = made("falling-set", box=third).box
    assert [box.coordinates[name].ends for name in third] == [(-1.0 / 3.0, 1.0 / 3.0), (0.1, 0.1)]
    assert made("falling-set", box=box).box == box


def test_disks_and_slices_are_one_or_several_in_any_form():
    hoop = ex.Disk.hoop()
    assert made("one-sided", disk=[hoop.describe(), "uniform"]).disk == (hoop, ex.Disk.uniform())
    assert made("one-sided", disk="hoop").disk == (hoop,)
    one = Slice.read("phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2")
    for given in (one, [one.describe()], ["phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2"]):
        assert made("falling-set", slice=given).slice == (one,)


def test_an_open_end_is_null_in_the_record():
    assert made("falling-set", energy=":3").options["energy"] == [None, 3.0]
    assert np.isneginf(made("falling-set", energy=[None, 3.0]).energy[0])
