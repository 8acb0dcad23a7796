"""The built pages as people meet them: Chromium, on a desk and on a phone, light and dark, without a network.

They need playwright (``pip install ".[browser]"``), a Chromium, and pages that were built
(``sphinx-build docs docs/_build``, or the folder in ``FRICMB_PAGES``); ``FRICMB_SHOTS=folder`` keeps the screenshots.
"""

import functools
import http.server
import os
import shutil
import threading
from pathlib import Path
from urllib.parse import urldefrag

import pytest

PAGES = Path(os.environ.get("FRICMB_PAGES", Path(__file__).parents[2] / "docs" / "_build"))
SHOTS = os.environ.get("FRICMB_SHOTS")
SHOWN = {
    "landing": "index.html",
    "tutorial": "tutorials/block_on_belt.html",
    "own scene": "tutorials/own_scene.html",
    "shaken": "tutorials/shaken.html",
    "coming from": "howto/coming_from.html",
    "law": "reference/generated/fricmb.laws.Stribeck.html",
    "class": "reference/generated/fricmb.Solution.html",
    "analysis": "reference/generated/fricmb.analysis.complex_eigenvalues.html",
    "benchmark": "reference/benchmark.html",
    "gallery": "gallery/index.html",
    "example": "gallery/stick_slip/plot_belt.html",
}
SIZES = {"desk": (1400, 900), "phone": (390, 740)}
#: Code that is folded in the middle of a line though a desk has room for it: lines of up to a hundred characters.
FOLDED = """() => [...document.querySelectorAll('article div.highlight pre')].flatMap((pre) => {
  if (pre.closest('dl')) return [];  // beside a margin
  const lines = pre.textContent.replace(/\\n$/, '').split('\\n');
  const style = getComputedStyle(pre);
  const inner = pre.clientHeight - parseFloat(style.paddingTop) - parseFloat(style.paddingBottom);
  const high = lines.length * parseFloat(style.lineHeight) + 2;
  return Math.max(...lines.map((line) => line.length)) <= 100 && inner > high ? [lines[0]] : [];
})"""
TROUBLE = """() => {
  const found = [], width = document.documentElement.clientWidth;
  if (document.documentElement.scrollWidth > width + 1)
    found.push(`the page is ${document.documentElement.scrollWidth} wide, the window ${width}`);
  const scrolls = (e) => ['auto', 'scroll'].includes(getComputedStyle(e).overflowX);
  for (const e of document.querySelectorAll('article *, .fricmb *')) {
    const box = e.getBoundingClientRect(), style = getComputedStyle(e);
    const skipped = e.closest('mjx-container, svg, details:not([open])');
    if (!box.width || !box.height || style.visibility === 'hidden' || skipped) continue;
    if (style.overflowX === 'hidden' && e.scrollWidth > e.clientWidth + 1 && e.textContent.trim())
      found.push(`clipped: ${e.tagName}.${e.className}: ${e.textContent.trim().slice(0, 60)}`);
    let inside = e.parentElement;
    while (inside && !scrolls(inside)) inside = inside.parentElement;
    if (!inside && !scrolls(e) && box.right > width + 1)
      found.push(`beyond the edge: ${e.tagName}.${e.className}: ${e.textContent.trim().slice(0, 60)}`);
    if (e.tagName === 'PRE' && e.scrollWidth > e.clientWidth + 1)
      found.push(`code is cut off: ${e.textContent.trim().slice(0, 60)}`);
    if (e.tagName === 'IMG' && (!e.complete || !e.naturalWidth))
      found.push(`no picture: ${e.src}`);
    if (/^(TD|CODE|PRE)$/.test(e.tagName) && /(^|\\s)nan(\\s|$)/i.test(e.textContent))
      found.push(`nan: ${e.textContent.trim().slice(0, 60)}`);
  }
  for (const e of document.querySelectorAll('mjx-merror, .MathJax_Error')) found.push(`formula: ${e.textContent}`);
  if (document.querySelector('.math') && !document.querySelector('mjx-container'))
    found.push('formulas are not typeset');
  return found.slice(0, 12);
}"""


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *args):
        pass


@pytest.fixture(scope="module")
def address():
    if not (PAGES / "index.html").exists():
        pytest.skip(f"no pages in {PAGES}: sphinx-build docs docs/_build")
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=PAGES))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()


@pytest.fixture(scope="module")
def chromium():
    playwright = pytest.importorskip("playwright.sync_api", reason='no playwright: pip install ".[browser]"')
    path = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    with playwright.sync_playwright() as running:
        if path is None and not Path(running.chromium.executable_path).exists():
            pytest.skip("no Chromium: playwright install chromium, or one on PATH")
        browser = running.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def visit(chromium):
    """Opens an address without a network, says what went wrong, and gives the page."""
    contexts = []

    def go(url, size="desk", theme="light"):
        width, height = SIZES[size]
        context = chromium.new_context(
            viewport={"width": width, "height": height}, color_scheme=theme,
            is_mobile=size == "phone", has_touch=size == "phone",
        )  # fmt: skip
        contexts.append(context)
        page, wrong = context.new_page(), []
        here = url if url.startswith("file") else "/".join(url.split("/")[:3])

        def only_here(route):
            asked = route.request.url
            if asked.startswith((here, "data:", "blob:")):
                return route.continue_()
            wrong.append(f"asks the network for {asked}")
            return route.abort()

        page.route("**/*", only_here)
        page.on("console", lambda said: wrong.append(f"console: {said.text}") if said.type == "error" else None)
        page.on("pageerror", lambda error: wrong.append(f"error: {error}"))
        page.on("response", lambda got: wrong.append(f"{got.status}: {got.url}") if got.status >= 400 else None)
        page.goto(url, wait_until="load")
        page.wait_for_timeout(1200)  # formulas are set after loading
        for picture in page.query_selector_all("img[loading=lazy]"):
            picture.scroll_into_view_if_needed()
        page.evaluate("window.scrollTo(0, 0)")
        page.wait_for_timeout(200)
        return page, wrong

    yield go
    for context in contexts:
        context.close()


def keep(page, name):
    if SHOTS:
        Path(SHOTS).mkdir(parents=True, exist_ok=True)
        page.screenshot(path=Path(SHOTS) / f"{name.replace(' ', '_')}.png", full_page=True)


@pytest.mark.slow
@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", SHOWN)
def test_page_is_whole(name, size, theme, address, visit):
    page, wrong = visit(f"{address}/{SHOWN[name]}", size, theme)
    keep(page, f"{name} {size} {theme}")
    assert wrong == []
    assert page.evaluate(TROUBLE) == []
    background = page.evaluate("getComputedStyle(document.body).backgroundColor")
    shade = sum(map(int, background[background.index("(") + 1 : -1].split(",")[:3]))
    assert (shade < 200) == (theme == "dark"), background


@pytest.mark.slow
@pytest.mark.parametrize("name", SHOWN)
def test_code_is_as_wide_as_a_desk(name, address, visit):
    page, _ = visit(f"{address}/{SHOWN[name]}")
    assert page.evaluate(FOLDED) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", SHOWN)
def test_pictures_are_dark_on_dark_pages(name, address, visit):
    """Plots on white have their lightness turned round by a filter."""
    light, _ = visit(f"{address}/{SHOWN[name]}")
    dark, _ = visit(f"{address}/{SHOWN[name]}", theme="dark")
    filters = "[...document.querySelectorAll('article img')].map((e) => getComputedStyle(e).filter)"
    assert set(light.evaluate(filters)) <= {"none"}
    assert all("invert" in found for found in dark.evaluate(filters))


@pytest.mark.slow
def test_equations_are_typeset(address, visit):
    """What a cell returns as LaTeX is a formula, no text."""
    page, _ = visit(f"{address}/{SHOWN['own scene']}")
    assert "\\begin{" not in page.inner_text("article")
    assert page.query_selector("article .output mjx-container, article .cell_output mjx-container") is not None


@pytest.mark.slow
def test_types_of_public_names_are_links(address, visit):
    page, _ = visit(f"{address}/{SHOWN['analysis']}")
    assert page.query_selector(".classifier a[href*='fricmb.Scene.html']") is not None


@pytest.mark.slow
def test_benchmark_shows_three_tables_and_folds_the_rest(address, visit):
    page, _ = visit(f"{address}/{SHOWN['benchmark']}")
    shown = "[...document.querySelectorAll('article table')].filter((e) => !e.closest('details'))"
    assert page.evaluate(f"{shown}.length") == 3  # times, impacts, and the other packages
    assert page.evaluate("document.querySelectorAll('article details').length") >= 6


@pytest.mark.slow
def test_wide_tables_scroll_on_a_phone(address, visit):
    page, _ = visit(f"{address}/reference/errors.html", "phone")
    wide = "[...document.querySelectorAll('article .table-wrapper')].filter((e) => e.scrollWidth > e.clientWidth + 1)"
    assert page.evaluate(f"{wide}.length") > 0
    assert page.evaluate(f"{wide}.every((e) => ['auto', 'scroll'].includes(getComputedStyle(e).overflowX))")


@pytest.mark.slow
def test_search_leaves_out_decisions(address, visit):
    page, _ = visit(f"{address}/search.html?q=friction")
    page.wait_for_timeout(3000)
    links = page.eval_on_selector_all("#search-results a[href]", "all => all.map((a) => a.href)")
    assert len(links) > 10
    assert not [link for link in links if "/decisions/" in link]
    landing, _ = visit(f"{address}/index.html")
    assert not landing.eval_on_selector_all(".sidebar-tree a[href*='decisions/']", "all => all.map((a) => a.href)")


@pytest.mark.slow
@pytest.mark.parametrize("name", SHOWN)
def test_links_lead_to_pages_and_places(name, address, visit):
    page, _ = visit(f"{address}/{SHOWN[name]}")
    links = page.eval_on_selector_all("a[href]", "all => all.map(a => a.href)")
    inside = {link for link in links if link.startswith(address)}
    assert inside
    missing = []
    for link in sorted(inside):
        path, place = urldefrag(link)
        file = PAGES / path.removeprefix(address).lstrip("/").partition("?")[0]
        file = file / "index.html" if file.is_dir() else file
        is_page = file.exists() and file.suffix == ".html"
        if not file.exists() or (place and is_page and f'id="{place}"' not in file.read_text(encoding="utf-8")):
            missing.append(link)
    assert missing == []


@pytest.mark.slow
@pytest.mark.parametrize("size", SIZES)
def test_view_of_a_run(size, visit, tmp_path):
    import fricmb as fm

    sol = fm.simulate(fm.models.belt_oscillator(), t_end=40.0)
    file = tmp_path / "view.html"
    sol.plot.view(file)
    page, wrong = visit(file.as_uri(), size)
    keep(page, f"view {size}")
    assert wrong == []
    assert page.evaluate(TROUBLE) == []
    assert page.query_selector("canvas, svg, img") is not None
