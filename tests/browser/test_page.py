"""The page in a real browser: it loads alone, moves when dragged, and says Python's numbers."""

import io
import json

import numpy as np
import pytest
from PIL import Image

import explorer as ex
from explorer.view.page import view

CANVASES = ("scene", "times", "plane", "portrait", "gauge")
FLATTEST = "nearflat.store.main.states[nearflat.store.main.turns[0]][modules.physics.CLOCK]"
DIGITS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻−", "0123456789--")


def shown(page):
    return page.evaluate("nearflat.store.shown")


def box(page, name):
    return page.evaluate(f"document.getElementById('{name}').getBoundingClientRect().toJSON()")


def inside(page, name, across, down):
    """A place on an element, as shares of its size."""
    b = box(page, name)
    return b["left"] + across * b["width"], b["top"] + down * b["height"]


def slide(page, name, value):
    """What a user does to a slider, as its page hears it."""
    page.evaluate(
        f"(e => {{ e.value = {value}; e.dispatchEvent(new Event('input', {{ bubbles: true }})); }})"
        f"(document.getElementById('{name}'))"
    )


def click(page, name):
    page.drag([inside(page, name, 0.5, 0.5)])


def until(page, condition):
    """Wait until an expression is true in the page."""
    page.evaluate(
        f"new Promise(done => {{ const look = () => {condition} ? done() : setTimeout(look, 20); look(); }})"
    )


def written(page, name):
    return page.evaluate(f"document.getElementById('{name}').textContent")


def number_in(text):
    """The number that the page writes as 7.2·10⁻⁴ or −3.1."""
    mantissa, _, exponent = text.translate(DIGITS).partition("·10")
    return float(mantissa) * 10.0 ** int(exponent or 0)


def test_the_page_asks_for_nothing_but_itself(page, page_file):
    page.open(page_file)
    page.frames(10)
    assert [address for address in page.requests() if address.startswith(("http", "ws"))] == []
    assert len(page.requests()) == 1
    assert page.problems() == []


def test_both_sides_end_a_race_apart(page):
    """What is drawn, not only what is written: chi at the end of the first race on both sides."""
    page.evaluate("(nearflat.store.set({ eta_hat: -1e-12, disk: 'hoop' }), 0)")
    code = """[nearflat.store.main, nearflat.store.other].map(path => {
        const { CHI, T, stateAt } = modules.physics;
        return stateAt(path, T, nearflat.store.numbers.duration)[CHI];
    })"""
    this, other = page.evaluate(code)
    assert other - this == pytest.approx(2.0 * ex.Disk.hoop().race_limit, abs=1e-4)


def test_the_slider_of_the_distance_goes_through_f_by_decades(page):
    for place, side in ((-0.9, -1.0), (-0.01, -1.0), (0.01, 1.0), (0.9, 1.0)):
        slide(page, "eta", place)
        assert np.sign(shown(page)["eta_hat"]) == side
        assert np.sign(page.evaluate("nearflat.store.numbers.race_angle")) == side
    slide(page, "eta", 1)
    assert shown(page)["eta_hat"] == pytest.approx(1.0)
    slide(page, "eta", 0.02)
    assert shown(page)["eta_hat"] == pytest.approx(1e-12)


def test_sliders_and_buttons_change_what_they_name(page):
    slide(page, "s3", -0.5)
    slide(page, "phidot", 1.7)
    assert shown(page)["sigma3_bar"] == -0.5
    assert shown(page)["phidot"] == 1.7
    slide(page, "inner", 0.3)
    body = ex.Disk.annulus(0.3).body
    assert page.evaluate("[nearflat.store.body.I1, nearflat.store.body.r0]") == pytest.approx([body.I1, body.r0])
    slide(page, "inner", 1)
    assert shown(page)["disk"] == "hoop"
    page.evaluate("(document.querySelector('[data-disk=matching]').click(), 0)")
    assert shown(page)["disk"] == "matching"
    page.evaluate("(document.querySelector('[data-face=\"-1\"]').click(), 0)")
    assert shown(page)["face"] == -1
    click(page, "slow")
    assert not shown(page)["slow"]
    click(page, "flip")
    assert shown(page)["eta_hat"] == -1e-3
    click(page, "reset")
    assert shown(page) == page.evaluate("nearflat.store.start")


def test_the_state_is_dragged_through_the_plane(page):
    page.drag([inside(page, "plane", 0.6, 0.4), inside(page, "plane", 0.8, 0.8)])
    below = shown(page)
    assert below["eta_hat"] > 0.2
    page.drag([inside(page, "plane", 0.8, 0.8), inside(page, "plane", 0.5, 0.15)])
    above = shown(page)
    assert above["eta_hat"] < -0.2
    assert below["sigma3_bar"] - above["sigma3_bar"] > 0.5


def test_close_to_f_the_plane_is_stretched_by_decades(page):
    """A point two pixels beside the line is on its side and far nearer than a pixel is wide."""
    line = page.evaluate("nearflat.plane.toPixel(1, modules.chaplygin.lineSlope(nearflat.store.body))")
    corner = box(page, "plane")
    for off, side in ((2.0, 1), (-2.0, -1)):
        page.drag([(corner["left"] + line[0], corner["top"] + line[1] + off)])
        assert 0.0 < side * shown(page)["eta_hat"] < 1e-8


def test_the_start_is_dragged_through_the_portrait(page):
    page.drag([inside(page, "portrait", 0.55, 0.3), inside(page, "portrait", 0.75, 0.4)])
    assert 0.2 < shown(page)["theta"] < 1.3
    assert shown(page)["phidot"] > 0.1
    assert page.evaluate("nearflat.store.main.states[0][1]") > 0.2


def test_time_is_dragged_and_the_table_is_turned(page):
    page.drag([inside(page, "times", 0.2, 0.5), inside(page, "times", 0.6, 0.5)])
    assert page.evaluate("nearflat.player.clock / nearflat.player.end") == pytest.approx(0.6, abs=0.08)
    before = page.evaluate("nearflat.scene.camera.azimuth")
    page.drag([inside(page, "scene", 0.4, 0.5), inside(page, "scene", 0.6, 0.5)])
    assert page.evaluate("nearflat.scene.camera.azimuth") < before - 0.3


def test_keys_do_what_the_footer_says(page):
    expected = (("f", "eta_hat", -1e-3), ("g", "ghost", False), ("s", "slow", False), ("2", "disk", "hoop"))
    for key, name, value in expected:
        page.key(key)
        assert shown(page)[name] == value
    page.key(" ")
    assert page.evaluate("nearflat.player.running")
    page.key("r")
    assert shown(page)["eta_hat"] == 1e-3
    page.evaluate("(document.getElementById('plane').focus(), 0)")
    page.key("ArrowRight")
    assert shown(page)["sigma3_bar"] > 1.005


def test_the_clock_is_slowed_near_flat_and_says_how_slow(page):
    page.evaluate("(nearflat.store.set({ eta_hat: 1e-12 }), 0)")
    page.evaluate(f"(nearflat.player.seek({FLATTEST}), 0)")
    page.evaluate("(nearflat.draw(), 0)")
    assert number_in(written(page, "slowing").removesuffix("× slowed")) == pytest.approx(1.4e12, rel=0.1)
    code = """slow => {
        nearflat.store.set({ slow });
        nearflat.player.seek(1.5);
        nearflat.player.running = true;
        nearflat.player.advance(0.5);
        return nearflat.player.clock;
    }"""
    assert page.evaluate(f"({code})(true)") == pytest.approx(2.0)
    assert page.evaluate(f"({code})(false)") > 3.0


def test_a_link_opens_the_same_view(page, page_file):
    values = {"disk": "annulus:0.25", "sigma3_bar": -0.7, "eta_hat": -3e-7, "phidot": 0.4, "face": -1}
    values |= {"pace": 0.5, "slow": False, "theta": 1.2}
    page.evaluate(f"(nearflat.store.set({json.dumps(values)}), 0)")
    until(page, "nearflat.written")
    fragment = page.evaluate("location.hash")
    page.open(page_file, fragment)
    try:
        assert {name: shown(page)[name] for name in values} == values
        assert page.problems() == []
    finally:
        page.open(page_file)


def test_an_address_that_makes_no_sense_does_no_harm(page, page_file):
    page.open(page_file, "#disk=banana&eta_hat=1e9&face=7&theta=9&sigma3_bar=x&pace=-1")
    try:
        assert page.evaluate("nearflat.store.body.name") == "uniform"
        assert shown(page)["eta_hat"] == 1e-3
        page.frames(3)
        assert page.problems() == []
    finally:
        page.open(page_file)


def test_who_prefers_no_motion_sees_none(page, page_file):
    page.prefer(color_scheme="light", reduced_motion="reduce")
    try:
        page.open(page_file)
        before = page.evaluate("nearflat.player.clock")
        page.frames(5)
        assert page.evaluate("[nearflat.player.running, nearflat.player.clock]") == [False, before]
        assert before > page.evaluate(FLATTEST)
    finally:
        page.prefer(color_scheme="light")
        page.open(page_file)


@pytest.mark.parametrize(
    ("size", "scheme"), [((1280, 800), "light"), ((600, 900), "dark"), ((360, 700), "light")], ids=str
)
def test_every_picture_shows_something_at_every_size(page, size, scheme):
    page.prefer(color_scheme=scheme)
    page.size(*size)
    try:
        page.evaluate("(nearflat.player.seek(2.4), 0)")
        page.drawn()
        picture = np.asarray(Image.open(io.BytesIO(page.screenshot(whole=True))).convert("RGB"))
        width = page.evaluate("document.documentElement.scrollWidth")
        boxes = {name: box(page, name) for name in CANVASES}
    finally:
        page.prefer(color_scheme="light")
        page.size(1280, 800)
    assert page.problems() == []
    assert width <= size[0]
    assert (picture.mean() < 90) == (scheme == "dark")
    for name, b in boxes.items():
        part = picture[round(b["top"]) : round(b["bottom"]), round(b["left"]) : round(b["right"])]
        assert part.shape[0] >= 20
        assert part.shape[1] >= 100
        assert len(np.unique(part @ np.array([1, 256, 65536]))) > 30, name


def test_a_page_that_had_no_room_draws_when_it_has(page):
    """A notebook may open the frame in a hidden tab."""
    for style in ("none", ""):
        page.evaluate(f"(nearflat.canvases.forEach(canvas => {{ canvas.style.display = '{style}'; }}), 0)")
        page.drawn()
    for name in CANVASES:
        code = """name => {
            const { data } = nearflat.canvases.find(canvas => canvas.id === name)
                .getContext("2d").getImageData(0, 0, 400, 30);
            return new Set(new Uint32Array(data.buffer)).size;
        }"""
        assert page.evaluate(f"({code})('{name}')") > 3, name
    assert page.problems() == []


def test_the_page_runs_in_the_frame_of_a_notebook(page, page_file, tmp_path):
    file = tmp_path / "notebook.html"
    file.write_text(f"<!doctype html><body>{view(eta_hat=-1e-6)._repr_html_()}</body>", encoding="utf-8")
    page.open(file)
    try:
        frame = "document.querySelector('iframe').contentWindow.nearflat"
        until(page, f"{frame}?.frame?.count > 3")
        assert page.evaluate(f"{frame}.store.shown.eta_hat") == -1e-6
        assert page.problems() == []
    finally:
        page.open(page_file)


def test_any_body_and_any_tilt_can_be_opened(page, page_file, tmp_path):
    disk = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
    heavy = ex.Disk(I1=0.02, I3=0.04, name="heavy & core")
    starts = ex.theta_to_states(heavy, 1e-3, 0.1, 0.05, 0.2, face=-1)
    try:
        for motion in (view(disk, 20.0, 1e-9 * disk.rate_unit, 20.0), view(starts)):
            page.open(motion.save(tmp_path / "other.html"))
            page.frames(3)
            assert page.problems() == []
            for name in ("sigma3_bar", "eta_hat", "theta", "phidot", "face"):
                assert shown(page)[name] == pytest.approx(getattr(motion.start, name), rel=1e-14)
            r0 = page.evaluate("nearflat.store.body.r0")
            assert r0 == motion.disk.body.r0
    finally:
        page.open(page_file)


def test_no_setting_within_reach_breaks_the_page(page):
    random = np.random.default_rng(5)
    for _ in range(12):
        values = {
            "disk": str(random.choice(["uniform", "hoop", "matching", "annulus:0.8"])),
            "face": int(random.choice([-1, 1])),
            "sigma3_bar": float(random.choice([0.0, random.uniform(-2.5, 2.5)])),
            "eta_hat": float(random.choice([-1, 1]) * 10.0 ** random.uniform(-12.0, 0.5)),
            "phidot": float(random.choice([0.0, random.uniform(-3.0, 3.0)])),
            "theta": float(random.choice([np.pi / 2, random.uniform(0.1, 3.0)])),
        }
        page.evaluate(f"(nearflat.store.set({json.dumps(values)}), nearflat.player.seek(1.0), nearflat.draw(), 0)")
        finite = "nearflat.store.main.states.every(x => x.every(Number.isFinite))"
        assert page.evaluate(finite), values
    page.frames()
    assert page.problems() == []
