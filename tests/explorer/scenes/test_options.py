"""Options of scenes: one table for the command line, files, Python and run.json."""

import argparse
import dataclasses
import inspect
import json
import tomllib
from typing import get_args, get_overloads, get_type_hints

import numpy as np
import pytest

import explorer as ex
from explorer.commands import run as command
from explorer.errors import InputError
from explorer.measure.sampling import Box
from explorer.portrait.slices import Slice
from explorer.scenes.options import Option, as_json, read_disk, read_disks, read_ranges, read_slices
from explorer.scenes.registry import SCENES, build_scene, scene_from_options

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
        "gaussian": "sigma3=0.5:1",
        "box": "phi=-1:1",
        "ladder": "1e-7:1e-1",
        "tube": "512",
        "sampling": "sobol",
    },
    "one-sided": {
        "disk": "m=2,r=0.3,g=9.81,I1=0.05,I3=0.06",
        "samples": "3",
        "box": "phidot=1:2",
        "eta-hat": "1e-5:1e-3",
    },
    "portrait": {"sigma3-bar": "-0.2", "eta-hat": "-1e-3", "energy": "0.5:2"},
    "race-angles": {
        "method": "dop853",
        "accuracy": "1e-7",
        "eta-hat": "1e-4:1e-2",
        "box": "sigma3=-1:2",
        "keep": "all",
    },
}


def from_command_line(name):
    parser = argparse.ArgumentParser()
    command.add_options(parser, SCENES.values())
    words = [word for flag, value in GIVEN[name].items() for word in (f"--{flag}={value}",)]
    options = vars(parser.parse_args(words))
    return build_scene(name, **{key: value for key, value in options.items() if value is not None})


def from_python(name):
    return build_scene(name, **{key.replace("-", "_"): value for key, value in GIVEN[name].items()})


def from_file(name):
    content = tomllib.loads("".join(f"{key} = '{value}'\n" for key, value in GIVEN[name].items()))
    return build_scene(name, **{key.replace("-", "_"): value for key, value in content.items()})


@pytest.mark.parametrize("name", GIVEN)
def test_the_command_line_a_file_python_and_the_record_say_the_same(name):
    scene = from_python(name)
    assert from_command_line(name).options() == from_file(name).options() == scene.options()
    record = json.loads(json.dumps(scene.options(), allow_nan=False))
    assert scene_from_options(record).options() == scene.options()
    assert ex.run.__module__ == "explorer.commands.run"
    again = {key: value for key, value in record.items() if key != "scene"}
    assert build_scene(name, **again).options() == scene.options()


@pytest.mark.parametrize("name", SCENES)
def test_the_defaults_of_a_scene_are_read_back_from_its_record(name):
    scene = build_scene(name)
    assert scene_from_options(json.loads(json.dumps(scene.options()))).options() == scene.options()


@pytest.mark.parametrize("name", SCENES)
def test_every_field_of_a_scene_is_an_option_and_every_option_a_field(name):
    fields = {field.name for field in dataclasses.fields(SCENES[name])}
    assert {option.name for option in SCENES[name].OPTIONS} == fields


@pytest.mark.parametrize("name", SCENES)
def test_every_option_is_a_typed_keyword_of_run_and_described_there(name):
    described = {line.split(" : ")[0] for line in ex.run.__doc__.splitlines() if " : " in line}
    (keywords,) = (
        get_args(hints["options"])[0].__annotations__
        for hints in map(get_type_hints, get_overloads(command.run))
        if name in get_args(hints["scene"])
    )
    for option in SCENES[name].OPTIONS:
        assert option.word in keywords
        assert option.word in inspect.signature(ex.run).parameters
        assert option.word in described


def test_every_option_has_a_text_and_its_default_in_the_help():
    assert all(option.help_for(kind) for kind in SCENES.values() for option in kind.OPTIONS)
    (ladder,) = (option for option in SCENES["measure-zero"].OPTIONS if option.word == "ladder")
    assert ladder.help_for(SCENES["measure-zero"]).endswith("(default 1e-15:0.1)")
    (seed,) = (option for option in SCENES["measure-zero"].OPTIONS if option.word == "seed")
    assert seed.help_for(SCENES["measure-zero"]).endswith("(default 0)")


def test_an_option_is_a_word_for_python_and_a_key_for_the_record():
    option = Option("--eta-hat", str, "X", "text")
    assert (option.word, option.name) == ("eta_hat", "eta_hat")
    assert Option("--slice", str, "X", "text", field="slices").name == "slices"


def test_values_become_json_and_infinite_ends_null():
    assert as_json((-np.inf, 3.0)) == [None, 3.0]
    assert as_json({"phi": (0.0, 1.0)}) == {"phi": [0.0, 1.0]}
    assert as_json((ex.Disk.hoop(),))[0]["name"] == "hoop"
    assert as_json(None) is None


def test_ranges_are_text_a_mapping_or_a_box_and_keep_all_digits():
    third = {"phi": (-1.0 / 3.0, 1.0 / 3.0), "sigma3": "0.1"}
    assert read_ranges("--box", third) == {"phi": (-1.0 / 3.0, 1.0 / 3.0), "sigma3": (0.1, 0.1)}
    box = Box((0.0, 0.0), (-0.1, 0.2), (0.0, 1.0 / 7.0), (1.0, 1.0))
    assert read_ranges("--box", box) == {
        name: getattr(box, name) for name in ("phi", "phidot", "sigma3", "sigma4")
    }
    for wrong in (3, ["phi"], {"phi": 3}, {"phi": []}, {"phi": [1, 2, 3]}, {"tilt": [0, 1]}, "phi"):
        with pytest.raises(InputError, match="box"):
            read_ranges("--box", wrong)


def test_disks_are_names_mappings_or_disks():
    hoop = ex.Disk.hoop()
    assert read_disks("--disk", [hoop.describe(), "hoop", hoop]) == (hoop, hoop, hoop)
    for wrong in (3, [], [3], {"m": 1, "colour": 2}, None):
        with pytest.raises(InputError, match="disk"):
            read_disks("--disk", wrong)
    with pytest.raises(InputError, match="takes one disk, 2 were given"):
        read_disk("--disk", ["hoop", "uniform"])


def test_slices_are_text_mappings_or_slices():
    text = "phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2"
    one = Slice.of(text)
    assert (
        read_slices("--slice", text)
        == read_slices("--slice", [one.describe()])
        == read_slices("--slice", one)
        == (one,)
    )
    for wrong in ([], [1, 2], 3, "phi=0"):
        with pytest.raises(InputError, match="slice"):
            read_slices("--slice", wrong)
