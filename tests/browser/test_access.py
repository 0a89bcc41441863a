"""Everybody can use the page: names of controls, contrast, touch."""

from importlib import resources

import pytest
from browser.test_page import box, inside, until

AXE = resources.files("axe_core_python").joinpath("axe.min.js")


@pytest.mark.parametrize(("size", "scheme"), [((1280, 800), "light"), ((375, 700), "dark")], ids=str)
def test_axe_finds_nothing_serious(page, scheme, size):
    page.prefer(color_scheme=scheme)
    page.size(*size)
    try:
        page.frames(3)
        page.evaluate(f"{AXE.read_text('utf-8')}; 0")
        found = page.evaluate("axe.run().then(({ violations }) => violations)")
    finally:
        page.prefer(color_scheme="light")
        page.size(1280, 800)
    grave = [each for each in found if each["impact"] in ("serious", "critical")]
    assert [(each["id"], [node["html"] for node in each["nodes"]]) for each in grave] == []
    assert page.evaluate("typeof axe") == "object"


def test_every_control_has_a_name_and_says_its_value(page):
    tree = page.send("Accessibility.getFullAXTree")["nodes"]
    sliders = {node["name"]["value"]: node for node in tree if node.get("role", {}).get("value") == "slider"}
    assert len(sliders) == 5
    for word in ("distance", "turning", "falling speed", "hole", "speed"):
        (name,) = [name for name in sliders if name.lower().startswith(word) or f"signed {word}" in name.lower()]
        told = [p["value"]["value"] for p in sliders[name]["properties"] if p["name"] == "valuetext"]
        assert told, name
    for node in tree:
        if node.get("role", {}).get("value") in ("button", "checkbox", "slider"):
            assert node["name"]["value"], node


def luminance(colour):
    parts = [value / 255.0 for value in colour]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def rgb(text):
    return tuple(int(text.strip().lstrip("#")[n : n + 2], 16) for n in (0, 2, 4))


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_words_on_plots_have_contrast(page, scheme):
    """What axe cannot see: letters on a canvas, also those on the tints of the two sides."""
    page.prefer(color_scheme=scheme)
    names = ("ink", "soft", "plus-ink", "minus-ink", "paper", "panel", "plus", "minus")
    code = f"{list(names)}.map(name => getComputedStyle(document.documentElement).getPropertyValue('--' + name))"
    colours = dict(zip(names, map(rgb, page.evaluate(code)), strict=True))
    page.prefer(color_scheme="light")
    share = 0.13 if scheme == "light" else 0.22
    tint = {
        side: tuple((1.0 - share) * p + share * c for p, c in zip(colours["paper"], colours[side], strict=True))
        for side in ("plus", "minus")
    }
    pairs = [(colours[ink], colours[ground]) for ink in names[:4] for ground in ("paper", "panel")]
    pairs += [(colours[f"{side}-ink"], tint[side]) for side in tint]
    for ink, ground in pairs:
        light, dark = sorted((luminance(ink), luminance(ground)), reverse=True)
        assert (light + 0.05) / (dark + 0.05) >= 4.5, (ink, ground)


@pytest.fixture
def phone(page):
    page.size(375, 700, mobile=True)
    page.frames(4)
    yield page
    page.size(1280, 800)


@pytest.mark.parametrize("name", ["scene", "times", "plane", "portrait"])
def test_a_swipe_that_begins_on_a_picture_scrolls_the_page(phone, name):
    phone.evaluate(f"(document.getElementById('{name}').scrollIntoView({{ block: 'center' }}), 0)")
    phone.frames(2)
    before = phone.evaluate("scrollY")
    way = 1 if name == "scene" else -1
    phone.swipe(*inside(phone, name, 0.5, 0.5), 0, -120 * way)
    until(phone, f"{way} * (scrollY - {before}) > 60")
    assert phone.evaluate("nearflat.store.shown.sigma3_bar") == 1.0


def test_a_finger_on_the_dot_takes_it_up_and_down_and_scrolls_nothing(phone):
    phone.evaluate("(document.getElementById('plane').scrollIntoView({ block: 'center' }), 0)")
    phone.frames(2)
    x, y, scrolled, eta_hat = phone.evaluate("""(() => {
        const box = document.getElementById('plane').getBoundingClientRect();
        const { eta_hat } = nearflat.store.shown, [x, y] = nearflat.plane.place(eta_hat);
        return [box.left + x, box.top + y, scrollY, eta_hat];
    })()""")
    phone.swipe(x, y, 0, -40)
    until(phone, f"nearflat.store.shown.eta_hat !== {eta_hat}")
    phone.frames(10)
    assert phone.evaluate("scrollY") == scrolled


def test_a_finger_from_side_to_side_turns_the_table_and_scrolls_nothing(phone):
    before = phone.evaluate("nearflat.scene.camera.azimuth")
    phone.swipe(*inside(phone, "scene", 0.3, 0.5), 100, 0)
    assert phone.evaluate("nearflat.scene.camera.azimuth") < before - 0.3
    assert phone.evaluate("scrollY") == 0


def test_buttons_are_as_large_as_a_finger_where_there_is_one(phone):
    for name in ("play", "flip", "reset", "save-film"):
        assert box(phone, name)["height"] >= 44
