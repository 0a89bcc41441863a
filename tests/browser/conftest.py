"""A browser for the tests of the page, and a way to run its modules alone."""

import json
import shutil
import subprocess

import pytest
from browser import chromium

from explorer.view.assembly import FOLDER
from explorer.view.page import view


@pytest.fixture(scope="session")
def browser():
    """One headless Chromium for all tests."""
    with chromium.started() as browser:
        yield browser


@pytest.fixture(scope="session")
def page_file(tmp_path_factory):
    """A page as a user saves it."""
    return view(eta_hat=1e-3).save(tmp_path_factory.mktemp("view") / "page.html")


@pytest.fixture(scope="session")
def opened(browser, page_file):
    """The page, opened on a laptop."""
    browser.size(1280, 800)
    browser.prefer(color_scheme="light")
    browser.open(page_file)
    return browser


@pytest.fixture
def page(opened):
    """The page as it was opened, standing still, whatever another test has done with it."""
    opened.size(1280, 800)
    opened.evaluate("(nearflat.store.reset(), nearflat.scene.camera.home(), nearflat.player.seek(0), 0)")
    opened.evaluate("(scrollTo(0, 0), nearflat.player.running = false, 0)")
    opened.frames()
    return opened


@pytest.fixture(scope="session")
def javascript(tmp_path_factory, request):
    """Calls a function of the modules of the page with JSON: in node where there is one, else in the browser."""
    node = shutil.which("node")
    if node is None:
        page = request.getfixturevalue("opened")
        return lambda code, values: page.evaluate(f"(({code})({json.dumps(values)}))")
    folder = tmp_path_factory.mktemp("modules")
    for file in FOLDER.glob("*.js"):
        shutil.copy(file, folder)
    (folder / "package.json").write_text('{"type": "module"}', encoding="utf-8")
    names = ("chaplygin", "physics", "passage")
    modules = "".join(f'import * as {name} from "./{name}.js";\n' for name in names)

    def call(code, values):
        source = f"{modules}const modules = {{ {', '.join(names)} }};\n"
        source += f"process.stdout.write(JSON.stringify(({code})({json.dumps(values)})));\n"
        (folder / "call.js").write_text(source, encoding="utf-8")
        done = subprocess.run([node, "call.js"], cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return call
