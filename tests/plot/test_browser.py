"""The view of a run in a browser: no network, no complaints, nothing wider than the screen, and time goes on."""

import shutil

import numpy as np
import pytest

import fricmb as fm

playwright = pytest.importorskip("playwright.sync_api")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")


@pytest.fixture(scope="module")
def page_of_a_run(tmp_path_factory):
    sol = fm.simulate(fm.models.belt_oscillator(), t_end=60.0, rtol=1e-6)
    return sol.plot.view(tmp_path_factory.mktemp("view") / "view.html")


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("size", [(1280, 800), (390, 844)], ids=["desktop", "phone"])
def test_view(page_of_a_run, size, theme):
    with playwright.sync_playwright() as start:
        browser = start.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        screen = {"width": size[0], "height": size[1]}
        page = browser.new_context(viewport=screen, color_scheme=theme, offline=True).new_page()
        complaints = []
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(page_of_a_run.as_uri())
        paper = page.evaluate("getComputedStyle(document.querySelector('.fricmb')).backgroundColor")
        assert paper == {"light": "rgb(255, 255, 255)", "dark": "rgb(20, 24, 30)"}[theme]
        assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
        for name in ("scene", "plane", "time"):  # something is drawn on each: more than one colour
            colours = page.evaluate(
                f"""() => {{ const c = document.querySelector('canvas.{name}'), d = c.getContext('2d')
                .getImageData(0, 0, c.width, c.height).data, found = new Set();
                for (let i = 0; i < d.length; i += 4) found.add(d[i] + 256 * d[i + 1] + 65536 * d[i + 2]);
                return found.size; }}"""
            )
            assert colours > 5, name
        before = float(page.text_content("output").split()[2])
        page.click("button.play")
        page.wait_for_timeout(400)
        page.click("button.play")
        after = float(page.text_content("output").split()[2])
        assert after > before
        page.fill("input[type=range]", "500")
        assert float(page.text_content("output").split()[2]) == pytest.approx(30.0)
        page.click("button.nearer")
        page.click("button.whole")
        page.select_option("select.first", "mass.x")
        assert page.text_content(".told").startswith("mass.x = ")
        told = float(page.text_content(".told").split("=")[1].split()[0])
        assert np.isfinite(told)
        browser.close()
    assert complaints == []


def test_a_scene_in_space_is_turned_by_dragging(tmp_path):
    ball = fm.space.Ball("ball", mass=0.1, radius=0.03, position=(0, 0, 0.03), velocity=(1, 0, 0))
    cloth = fm.space.OnPlane("cloth", ball, normal=(0, 0, 1), friction=fm.laws.Coulomb(mu_s=0.2), push_only=True)
    scene = fm.Scene("billiard", [ball, cloth, fm.Gravity("weight", acceleration={"z": -9.81})])
    path = fm.simulate(scene, t_end=0.3, rtol=1e-6).plot.view(tmp_path / "view.html")
    with playwright.sync_playwright() as start:
        browser = start.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page = browser.new_context(viewport={"width": 1280, "height": 800}, offline=True).new_page()
        complaints = []
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(path.as_uri())
        picture = "document.querySelector('canvas.scene').toDataURL()"
        before = page.evaluate(picture)
        box = page.locator("canvas.scene").bounding_box()
        page.mouse.move(box["x"] + 100, box["y"] + 100)
        page.mouse.down()
        page.mouse.move(box["x"] + 180, box["y"] + 130)
        page.mouse.up()
        turned = page.evaluate(picture)
        page.mouse.move(box["x"] + 60, box["y"] + 90)
        assert before != turned == page.evaluate(picture)
        page.fill("input[type=range]", "500")
        assert page.evaluate(picture) != turned
        browser.close()
    assert complaints == []
