"""The picture and the film of what the page shows."""

import base64
import io

import numpy as np
import pytest
from browser.test_page import click
from PIL import Image, ImageSequence

import explorer as ex
from explorer.commands.pages import caption_in
from explorer.view import record
from explorer.view.page import view

HERO = {"disk": "given", "sigma3_bar": 0.0, "eta_hat": 0.004, "phidot": 1.0}


@pytest.fixture(scope="module")
def stage(browser, page_file, tmp_path_factory):
    """The page with the disk of the hero."""
    where = view(record.OPPOSITE, 0.0, 0.004).save(tmp_path_factory.mktemp("film") / "page.html")
    browser.size(1280, 800)
    browser.open(where)
    browser.evaluate("(nearflat.player.running = false, 0)")
    yield browser
    browser.open(page_file)


def pixels(page, share=1.0, film=False, size=(320, 180)):
    drawn = f"modules.saving.picture(nearflat.store, {size[0]}, {size[1]}, {share}, {str(film).lower()})"
    data = base64.b64decode(page.evaluate(f"{drawn}.toDataURL()").partition(",")[2])
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), dtype=int)


def test_the_two_rises_of_the_hero_are_opposite(stage):
    code = """(() => {
        const { falls } = new modules.film.Film(nearflat.store);
        const { CHI, CLOCK, stateAt } = modules.physics;
        return falls.map(({ path, begin, over }) => [begin, over].map(at => stateAt(path, CLOCK, at)[CHI]));
    })()"""
    (start, one), (other_start, other) = stage.evaluate(code)
    assert start == other_start
    assert np.cos(one - other) == pytest.approx(-1.0, abs=1e-3)
    assert one - start == pytest.approx(1.25 * 2.0 * np.pi, abs=0.05)


def test_the_film_shows_one_disk_that_falls_and_two_that_rise(stage):
    def coloured(share):
        """How many pixels are gold, blue and vermilion."""
        r, g, b = np.moveaxis(pixels(stage, share, film=True), -1, 0)
        gold = (r > 150) & (g > 120) & (b < 150) & (r > b + 60)
        return gold.sum(), ((b > 120) & (b > r + 60)).sum(), ((r > 150) & (r > 1.5 * g)).sum()

    gold, blue, vermilion = coloured(0.12)
    assert gold > 800
    assert blue + vermilion < 30
    _, blue, vermilion = coloured(1.0)
    assert min(blue, vermilion) > 400


def test_at_the_end_of_the_film_each_side_has_counted_its_turns(stage):
    code = """(() => {
        const film = new modules.film.Film(nearflat.store), { CLOCK, stateAt } = modules.physics;
        return film.falls.map((fall, n) => (
            modules.scene.raceAt(film.races[n], stateAt(fall.path, CLOCK, fall.over), 1).turned / (2 * Math.PI)));
    })()"""
    assert stage.evaluate(code) == pytest.approx([1.25, -1.25], abs=0.01)


@pytest.mark.parametrize(
    "values",
    [
        {"eta_hat": 0.0},
        {"eta_hat": 0.5, "sigma3_bar": -1.0},
        {"sigma3_bar": 0.0, "phidot": 0.0},
        {"theta": 2.0, "phidot": -1.0},
        {"disk": "hoop", "face": -1, "eta_hat": -1e-12},
    ],
    ids=str,
)
def test_any_motion_has_its_picture_and_its_film(stage, values):
    stage.evaluate(f"(nearflat.store.set({values}), 0)".replace("'", '"'))
    try:
        for share in (0.0, 0.5, 1.0):
            for film in (False, True):
                assert len(np.unique(pixels(stage, share, film).reshape(-1, 3), axis=0)) > 300
    finally:
        stage.evaluate("(nearflat.store.reset(), 0)")
    assert stage.problems() == []


def test_a_film_plays_as_long_and_as_large_as_it_was_recorded(stage):
    """Red, then blue: what is seen in the middle of its second half is blue."""
    code = """(async () => {
        const draw = (context, share) => {
            context.fillStyle = share < 0.5 ? "#f00" : "#00f";
            context.fillRect(0, 0, 128, 72);
        };
        const data = await modules.webm.record(draw, 1, 128, 72, "title");
        const video = document.createElement("video");
        video.src = URL.createObjectURL(new Blob([data], { type: "video/webm" }));
        await new Promise(done => { video.onloadeddata = done; });
        video.currentTime = 0.75;
        // Where it has arrived it need not be seen yet, and no event says when: so it is looked at until it is.
        const context = document.createElement("canvas").getContext("2d");
        let r = 0, g = 0, b = 0;
        while (b < 200) {
            await new Promise(done => setTimeout(done, 20));
            context.drawImage(video, 0, 0);
            [r, g, b] = context.getImageData(64, 36, 1, 1).data;
        }
        return [video.duration, video.videoWidth, video.videoHeight, r, g, b];
    })()"""
    duration, width, height, r, g, b = stage.evaluate(code)
    assert (duration, width, height) == (pytest.approx(1.0, abs=0.01), 128, 72)
    assert b >= 200
    assert max(r, g) < 60


def test_the_button_saves_the_picture(stage, tmp_path):
    stage.evaluate("(document.getElementById('save-picture').scrollIntoView(), 0)")
    with stage.downloads(tmp_path):
        click(stage, "save-picture")
    with Image.open(tmp_path / "nearflat.png") as saved:
        assert saved.size == (1920, 1080)


def test_without_a_browser_the_hero_is_refused_with_the_remedy(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("NEARFLAT_CHROMIUM", raising=False)
    with pytest.raises(ex.InputError, match=r"no Chromium was found.*apt-get install chromium.*nearflat view"):
        record.record("hero", tmp_path)


@pytest.mark.parametrize("name", ["hero.webp", "hero.png", "film.gif"])
def test_what_is_committed_moves_and_carries_its_caption(name):
    path = record.Path(__file__).parents[2] / "results" / "portrait" / name
    assert caption_in(path) == record.CAPTIONS[path.stem]
    assert path.stat().st_size < 3e6
    with Image.open(path) as picture:
        assert getattr(picture, "n_frames", 1) > 40 or name == "hero.png"
        if name == "film.gif":
            assert sum(frame.info["duration"] for frame in ImageSequence.Iterator(picture)) == 6000  # milliseconds
