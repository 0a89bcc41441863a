"""The article: eight scenes that explain by playing, true in every number, for everybody."""

import io
import re
from html import escape
from importlib import resources

import numpy as np
import pytest
from browser.test_page import number_in, until
from PIL import Image

import explorer as ex
from explorer.view.page import view

SCENES = ["coin", "contact", "fall", "rise", "near", "slow-motion", "sides", "wall"]
MOVING = SCENES[2:]
COIN = ex.Disk.uniform(m=1.0, r=0.05, g=9.81)  # of the article: ten centimetres wide
PUSH = 1.0 * COIN.rate_unit
UNITS = {"mm": 1e-3, "µm": 1e-6, "nm": 1e-9, "pm": 1e-12, "fm": 1e-15}


@pytest.fixture(scope="module")
def article_file(tmp_path_factory):
    return view().save(tmp_path_factory.mktemp("article") / "page.html")


@pytest.fixture(scope="module")
def lent(browser, page_file):
    """The browser, which has the page of the other tests again at the end."""
    yield browser
    browser.size(1280, 800)
    browser.prefer(color_scheme="light")
    browser.open(page_file)
    browser.evaluate("(nearflat.player.running = false, 0)")


@pytest.fixture
def article(lent, article_file):
    """The article, opened on a laptop."""
    lent.size(1280, 800)
    lent.prefer(color_scheme="light")
    lent.open(article_file)
    return lent


def figure(name):
    return f"nearflat.article.figures[{SCENES.index(name)}]"


def go_to(page, name):
    page.evaluate(f"(document.querySelector('#{name} figure').scrollIntoView({{ block: 'center' }}), 0)")
    until(page, f"{figure(name)}.visible && {figure(name)}.words.textContent")


def slide(page, name, value):
    """What a reader does to the slider of a scene. Returns what stands beside it and under the picture."""
    go_to(page, name)
    page.evaluate(
        f"(e => {{ e.value = {value}; e.dispatchEvent(new Event('input', {{ bubbles: true }})); }})"
        f"(document.querySelector('#{name} input'))"
    )
    page.frames(3)
    return page.evaluate(
        f"['output', 'figcaption'].map(e => document.querySelector(`#{name} ${{e}}`).textContent)"
    )


def length_in(text):
    """The first length in a text, in metres."""
    number, unit = re.search(r"([\d.]+) ([mµnpf]m)", text).groups()
    return float(number) * UNITS[unit]


def test_the_article_comes_first_and_the_laboratory_where_a_motion_is_named(article, tmp_path):
    tops = "['article', 'laboratory'].map(id => document.getElementById(id).getBoundingClientRect())"
    first, then = article.evaluate(f"{tops}.map(box => box.toJSON())")
    assert (first["top"] < 100) & (then["top"] >= first["bottom"] > 3000)
    assert len(article.requests()) == 1
    assert article.problems() == []
    for page in (view("hoop"), view(eta_hat=1e-6), view(ex.constants_to_states(COIN, 20.0, 1e-3, 10.0))):
        article.open(page.save(tmp_path / "page.html"))
        first, then = article.evaluate(f"{tops}.map(box => box.toJSON())")
        assert first["height"] == 0
        assert then["top"] < 20
    article.evaluate("(document.getElementById('to-article').click(), 0)")
    go_to(article, "coin")
    assert article.problems() == []


def test_an_address_with_a_motion_opens_the_laboratory_and_its_name_keeps_the_article(article, article_file):
    article.open(article_file, "#disk=hoop")
    assert article.evaluate("document.getElementById('article').hidden")
    article.open(article_file, "#laboratory")
    article.frames(4)
    assert not article.evaluate("document.getElementById('article').hidden")
    assert -5 < article.evaluate("document.getElementById('laboratory').getBoundingClientRect().top") < 100


def test_in_a_frame_the_heading_of_the_article_is_left_to_the_page_round_it(article, article_file, tmp_path):
    heading = "document.querySelector('#article h1').getBoundingClientRect().height"
    assert article.evaluate(heading) > 0.0
    frame = tmp_path / "frame.html"
    inner = escape(article_file.read_text("utf-8"))
    frame.write_text(f"<!doctype html><iframe srcdoc='{inner}'></iframe>", "utf-8")
    article.open(frame)
    until(article, "document.querySelector('iframe').contentWindow.nearflat?.article")
    inside = heading.replace("document", "document.querySelector('iframe').contentDocument")
    assert article.evaluate(inside) == 0.0


def test_the_laboratory_explains_itself_where_it_stands(article):
    article.evaluate("(document.getElementById('laboratory').scrollIntoView(), 0)")
    article.frames(3)
    before = article.evaluate("scrollY")
    article.evaluate("(document.querySelector('#laboratory summary').click(), 0)")
    article.frames(3)
    assert article.evaluate("scrollY") == before
    text = article.evaluate("document.querySelector('#laboratory details').innerText")
    for symbol in ("η̂", "σ̄₃", "σ̄₄", "φ̇", "χ", "θ", "κ", "√(r/g)"):
        assert symbol in text


def test_eight_scenes_have_a_picture_and_a_slider_with_a_name_and_a_value(article):
    assert article.evaluate("[...document.querySelectorAll('article section[id]')].map(e => e.id)") == SCENES
    for name in SCENES:
        go_to(article, name)
    article.frames(3)
    tree = article.send("Accessibility.getFullAXTree")["nodes"]
    sliders = [node for node in tree if node.get("role", {}).get("value") == "slider"][: len(SCENES)]
    for node in sliders:
        told = [p["value"]["value"] for p in node["properties"] if p["name"] == "valuetext"]
        assert node["name"]["value"]
        assert told, node["name"]
    assert article.evaluate("document.querySelectorAll('article input').length") == len(SCENES)
    assert article.evaluate("document.querySelectorAll('article canvas[aria-label]').length") == len(SCENES)


def test_a_tilted_coin_reaches_as_high_as_a_sine(article):
    assert slide(article, "coin", 30) == ["30°", "Its upper edge is 5.0 cm above the table."]
    assert slide(article, "coin", 90) == ["90°", "Its upper edge is 10.0 cm above the table."]
    assert slide(article, "coin", 0) == ["0°", "Its upper edge is 0.0 cm above the table."]


@pytest.mark.parametrize("size", [(1280, 800), (375, 812)], ids=str)
def test_no_picture_cuts_the_coin_off(article, size):
    article.size(*size)
    for name in SCENES:
        go_to(article, name)
        assert (name, outside_of(article, name)) == (name, [])


def outside_of(article, name):
    """Points of the coin beyond the edges of its picture, at any place of its slider."""
    return article.evaluate(f"""(() => {{
        const f = {figure(name)}, {{ min, max }} = f.slider, {{ scene, canvas, player, store }} = f;
        const {{ CLOCK, stateAt }} = modules.physics, outside = [];
        player.running = false;
        for (let n = 0; n <= 8; n++) {{
            f.slider.value = Number(min) + (n / 8) * (max - min);
            f.slid();
            f.draw();
            const clocks = f.declared.posed || f.declared.span ? [player.clock]
                : [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1].map(share => share * player.end);
            for (const clock of clocks) for (const path of f.both ? [store.main, store.other] : [store.main]) {{
                const pose = modules.disk.poseOf(stateAt(path, CLOCK, clock), 0);
                for (let turn = 0; turn < 2 * Math.PI; turn += 0.1) for (const height of [pose.low, pose.high]) {{
                    const [x, y] = scene.camera.project([0, 1, 2].map(i => pose.centre[i] + height * pose.normal[i]
                        + Math.cos(turn) * pose.down[i] + Math.sin(turn) * pose.along[i]));
                    const inside = x >= 0 && x <= canvas.clientWidth && y >= 0 && y <= canvas.clientHeight;
                    if (!inside) outside.push([Number(f.slider.value), clock, x, y]);
                }}
            }}
        }}
        return outside;
    }})()""")


PLAYING = "document.querySelector('#{0} .play').classList.contains('playing')"


@pytest.mark.parametrize("name", [name for name in MOVING if name != "slow-motion"])
def test_a_slider_of_a_motion_neither_stops_nor_starts_its_picture(article, name):
    go_to(article, name)
    article.evaluate(f"(document.querySelector('#{name} input').focus(), 0)")
    for plays in (True, False):
        for key, code in (("Home", 36), ("End", 35), ("ArrowLeft", 37)):
            article.send("Input.dispatchKeyEvent", type="keyDown", key=key, windowsVirtualKeyCode=code)
            article.frames(3)
            before = article.evaluate(f"{figure(name)}.player.clock")
            article.frames(4)
            moved = article.evaluate(f"{figure(name)}.player.clock") != before
            assert (article.evaluate(PLAYING.format(name)), moved) == (plays, plays)
        article.evaluate(f"(document.querySelector('#{name} .play').click(), 0)")
        article.frames(3)


def test_the_slider_of_the_time_stops_it_where_it_is_put(article):
    go_to(article, "slow-motion")
    article.evaluate("(document.querySelector('#slow-motion input').focus(), 0)")
    article.send("Input.dispatchKeyEvent", type="keyDown", key="End", windowsVirtualKeyCode=35)
    article.frames(3)
    clock = article.evaluate(f"{figure('slow-motion')}.player.clock")
    article.frames(4)
    assert article.evaluate(f"{figure('slow-motion')}.player.clock") == clock
    assert not article.evaluate(PLAYING.format("slow-motion"))


def test_the_contact_goes_round_while_the_coin_hardly_turns(article):
    """Rolling: the coin turns by how much longer the rim is than the circle of the contact on the table."""
    beside, under = slide(article, "contact", 1)
    assert beside == "360°"
    assert under == f"The coin itself has turned by {round(360 * (1 - np.cos(np.radians(25))))}°."


def seconds_in(text):
    return float(re.search(r"[\d.]+(?= seconds)", text)[0])


def time_of_fall(phidot):
    """Half of the passage close beside the fall."""
    return ex.passages(COIN, 0.0, 1e-9 * COIN.rate_unit, phidot).duration.item() / 2


def test_the_time_of_the_fall_is_pythons(article):
    for push in (0.3, 1.2, 3.0):
        _, under = slide(article, "fall", push)
        assert seconds_in(under) == pytest.approx(time_of_fall(push / 0.1), abs=6e-4)


def test_each_moving_picture_says_how_much_it_is_slowed(article):
    """A unit of natural time takes a second; near flat more, as far as the contact runs."""
    slide(article, "fall", 1.4)
    corner = "document.querySelector('#{0} .slowed').textContent"
    assert article.evaluate(corner.format("fall")) == f"time slowed {COIN.rate_unit:.0f} times"
    article.evaluate(f"({figure('slow-motion')}.player.running = false, 0)")
    slide(article, "slow-motion", 0.5)
    said = number_in(re.search(r"slowed (\S+) times", article.evaluate(corner.format("slow-motion")))[1])
    slowing = article.evaluate(f"modules.physics.slowing({figure('slow-motion')}.state)")
    assert said == pytest.approx(slowing * COIN.rate_unit, rel=0.05)


def test_the_least_tilt_is_pythons(article):
    for speed in (1.0, 6.0, 20.0):
        _, under = slide(article, "rise", speed)
        least = ex.passages(COIN, 0.0, 0.01 * speed / 0.05, PUSH).theta_min.item()
        assert float(re.search(r"[\d.]+(?=°)", under)[0]) == pytest.approx(np.degrees(least), abs=0.051)


def test_how_near_it_comes_is_pythons(article):
    for decades in (-13.5, -9.0, -3.0, -1.0):
        beside, under = slide(article, "near", decades)
        assert length_in(beside) == pytest.approx(10.0**decades, rel=0.05)
        least = ex.passages(COIN, 0.0, 10.0**decades / 0.05, PUSH).theta_min.item()
        assert length_in(under) == pytest.approx(0.1 * np.sin(least), rel=0.05)


def test_the_race_begins_at_nothing_and_ends_as_in_python(article):
    turns = abs(ex.passages(ex.Disk.uniform(), 0.0, 1e-3, 1.0).race_angle.item()) / (2.0 * np.pi)
    article.evaluate(f"({figure('slow-motion')}.player.running = false, 0)")
    said = [float(re.search(r"[\d.]+(?= turns)", slide(article, "slow-motion", at)[1])[0]) for at in (0, 0.5, 1)]
    assert said == pytest.approx([0.0, turns / 2, turns], abs=0.011)


def test_each_side_of_f_races_and_turns_back_as_in_python(article):
    for place in (-0.9, -0.3, 0.02, 0.6):
        beside, under = slide(article, "sides", place)
        eta_hat = article.evaluate(f"{figure('sides')}.store.shown.eta_hat")
        there = ex.passages(ex.Disk.uniform(), 0.0, eta_hat, 1.0)
        assert ("right" in beside, "counterclockwise" in under) == (eta_hat > 0, there.race_angle.item() > 0)
        turns = float(re.search(r"[\d.]+(?= turns)", under)[0])
        assert turns == pytest.approx(abs(there.race_angle.item()) / (2.0 * np.pi), abs=0.0051)
        _, under = slide(article, "wall", place)
        assert length_in(under) == pytest.approx(0.1 * np.sin(there.theta_min.item()), rel=0.05)


def test_on_f_the_coin_falls_flat_and_there_is_no_wall(article):
    assert slide(article, "sides", 0) == ["not at all: F", "On F it falls flat. What comes next, nobody can tell."]
    assert article.evaluate(f"{figure('sides')}.player.running")
    until(article, f"{figure('sides')}.state[0] < 1e-5")
    _, under = slide(article, "wall", 0)
    assert under.startswith("On F there is no wall: ")
    assert seconds_in(under) == pytest.approx(time_of_fall(PUSH), abs=6e-4)


def test_on_f_the_marble_has_left_the_ruler_when_the_coin_is_flat(article):
    slide(article, "wall", 0)
    at_the_edge = article.evaluate(f"""(() => {{
        const f = {figure("wall")}, {{ canvas, box }} = f.ruler.chart, context = canvas.getContext("2d");
        const ratio = canvas.width / canvas.clientWidth;
        return [0, 0.9, 1].map(share => {{
            f.player.running = false;
            f.player.seek(share * f.player.end);
            f.draw();
            return context.getImageData(ratio * box.left, ratio * (box.bottom - 4), 1, 1).data[3];
        }});
    }})()""")
    assert at_the_edge == [0, 0, 255]


def test_right_and_left_are_those_of_the_picture(article):
    for place in (0.9, -0.9):
        slide(article, "sides", place)
        start, later = (
            article.evaluate(f"""(() => {{
                const {{ A1, A2, CLOCK, stateAt }} = modules.physics, f = {figure("sides")};
                const x = stateAt(f.store.main, CLOCK, {clock});
                return f.scene.camera.project([x[A1], x[A2], 0])[0];
            }})()""")
            for clock in (0, 0.5)
        )
        assert (later > start) == (place > 0)


def test_the_numbers_of_the_prose_are_those_of_the_disks(article):
    prose = re.sub(r"\s+", " ", article.evaluate("document.getElementById('article').textContent"))
    coin, hoop = (disk.race_limit / np.pi for disk in (ex.Disk.uniform(), ex.Disk.hoop()))
    assert f"by {coin / 2:.2f} turns" in prose
    assert f"a coin races {coin / 2:.2f} turns, a hoop, with all its mass at the rim, {hoop / 2:.2f}." in prose
    assert f"{coin:.2f} for a coin, {hoop:.2f} for a hoop" in prose
    assert f"{2.0 * np.sqrt(9.81 * COIN.r):.1f} m/s" in prose  # the upper edge of a coin that falls with phidot 1
    apart = np.degrees(2.0 * coin * np.pi) % 360.0
    assert f"{min(apart, 360.0 - apart):.0f}° apart" in prose
    assert ex.Disk.annulus(1.0 / np.sqrt(3.0)).race_limit == pytest.approx(2.0 * np.pi)
    assert f"A ring whose hole is {1.0 / np.sqrt(3.0):.2f} of its width is such a body: its κ is 2" in prose


@pytest.mark.parametrize("reduced", [False, True], ids=["moves", "prefers no motion"])
def test_only_what_is_in_view_moves_and_only_for_who_does_not_mind(article, article_file, reduced):
    if reduced:
        article.prefer(color_scheme="light", reduced_motion="reduce")
        article.open(article_file)
    clocks = f"{[SCENES.index(name) for name in MOVING]}.map(n => nearflat.article.figures[n].player.clock)"
    for name in MOVING:
        go_to(article, name)
        before = article.evaluate(f"[{clocks}, {figure(name)}.visible, nearflat.player.clock]")
        article.frames(8)
        after = article.evaluate(f"[{clocks}, {figure(name)}.visible, nearflat.player.clock]")
        visible = article.evaluate("nearflat.article.figures.map(f => f.visible)")[2:]
        moved = [a != b for a, b in zip(before[0], after[0], strict=True)]
        assert moved == ([False] * 6 if reduced else visible)
        assert before[2] == after[2]
    if reduced:
        article.evaluate("(document.querySelector('#wall .play').click(), 0)")
        article.frames(8)
        assert article.evaluate(f"{figure('wall')}.player.clock") != after[0][-1]


def test_the_keyboard_plays_a_scene_and_leaves_the_laboratory_alone(article):
    go_to(article, "coin")
    article.evaluate("(document.querySelector('#coin input').focus(), 0)")
    article.send("Input.dispatchKeyEvent", type="keyDown", key="ArrowRight", windowsVirtualKeyCode=39)
    article.frames(3)
    assert article.evaluate("document.querySelector('#coin output').textContent") == "61°"
    before = article.evaluate("[nearflat.player.running, nearflat.store.shown]")
    article.evaluate("(document.activeElement.blur(), 0)")
    for key in (" ", "f", "2"):
        article.key(key)
    assert article.evaluate("[nearflat.player.running, nearflat.store.shown]") == before


def test_a_picture_is_dragged_by_steps_of_a_hand(article):
    go_to(article, "coin")
    x, y = article.evaluate("""(() => {
        const box = document.querySelector('#coin canvas').getBoundingClientRect();
        return [box.left + box.width / 2, box.top + box.height / 2];
    })()""")
    article.drag([(x - step, y) for step in range(0, 100, 2)])
    article.frames(3)
    assert number_in(article.evaluate("document.querySelector('#coin output').textContent").rstrip("°")) < 50


def test_a_picture_is_dragged_aside_and_scrolled_up(article):
    article.size(375, 800, mobile=True)
    go_to(article, "coin")
    x, y, scrolled = article.evaluate("""(() => {
        const box = document.querySelector('#coin canvas').getBoundingClientRect();
        return [box.left + box.width / 2, box.top + box.height / 2, scrollY];
    })()""")
    article.swipe(x, y, 100, 0)
    article.frames(3)
    assert number_in(article.evaluate("document.querySelector('#coin output').textContent").rstrip("°")) > 70
    assert article.evaluate("scrollY") == scrolled
    article.swipe(x, y, 0, -120)
    until(article, f"scrollY > {scrolled} + 60")


@pytest.mark.parametrize(("size", "scheme"), [((1280, 800), "light"), ((375, 800), "dark")], ids=str)
def test_the_article_fits_shows_pictures_and_has_no_grave_fault(article, article_file, size, scheme):
    article.prefer(color_scheme=scheme)
    article.size(*size)
    article.open(article_file)
    for name in SCENES:
        go_to(article, name)
        article.frames(2)
        picture = np.asarray(Image.open(io.BytesIO(article.screenshot())).convert("RGB")).astype(int)
        for part in article.evaluate(f"""[...document.querySelectorAll('#{name} canvas')].map(
            canvas => canvas.getBoundingClientRect().toJSON()).filter(box => box.height)"""):
            seen = picture[max(0, round(part["top"])) : round(part["bottom"]), round(part["left"]) :]
            assert len(np.unique(seen @ np.array([1, 256, 65536]))) > 30, name
        assert (picture.mean() < 90) == (scheme == "dark")
    assert article.evaluate("document.documentElement.scrollWidth") <= size[0]
    axe = resources.files("axe_core_python").joinpath("axe.min.js")
    article.evaluate(f"{axe.read_text('utf-8')}; 0")
    found = article.evaluate("axe.run('#article').then(({ violations }) => violations)")
    grave = [each for each in found if each["impact"] in ("serious", "critical")]
    assert [(each["id"], [node["html"] for node in each["nodes"]]) for each in grave] == []
    assert article.problems() == []
