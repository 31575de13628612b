"""The book in a browser: opened from the disk, with the network off."""

import re

import pytest
from browser.lab import open_browser
from browser.test_player_in_lab import NOW, REMEMBER_SOUNDS, picture, wait_for_time

from s2glib.teaching.book import write_book
from s2glib.teaching.build import NOTEBOOKS

pytestmark = pytest.mark.browser
FOCUSED = "() => document.activeElement.id || document.activeElement.innerText"


@pytest.fixture(scope="module")
def book(tmp_path_factory):
    """A browser without a network, and the address of the contents."""
    folder = tmp_path_factory.mktemp("book")
    index = write_book(sorted(NOTEBOOKS.glob("[0-9][0-9]_*.ipynb")), folder / "pages")
    with open_browser(folder) as watched:
        watched.page.context.set_offline(True)
        watched.page.add_init_script(REMEMBER_SOUNDS)
        yield watched, index.parent.as_uri()


@pytest.fixture
def visit(book):
    """Open a page by its name."""
    watched, address = book

    def visit(name):
        watched.page.goto(f"{address}/{name}.html", wait_until="domcontentloaded")
        return watched.page

    return visit


def test_the_contents_lead_to_a_notebook_and_that_to_the_next(visit):
    page = visit("index")
    page.get_by_role("link", name="00 Start here").click()
    page.wait_for_url("**/00_start_here.html", wait_until="domcontentloaded")
    page.get_by_role("link", name=re.compile("^Next 01")).first.click()
    page.wait_for_url("**/01_motion_and_sound.html", wait_until="domcontentloaded")
    assert page.get_by_role("heading", level=1).inner_text().startswith("Motion and sound")


def test_formulas_are_set(visit):
    page = visit("01_motion_and_sound")
    page.locator("main p mjx-container svg").first.wait_for()
    assert page.locator("mjx-container[display=true] svg").count() >= 1
    assert [text for text in page.locator("main p").all_inner_texts() if "$" in text] == []


def test_a_figure_is_seen_above_its_caption(visit):
    figure = visit("00_start_here").locator(".output_png img").first
    figure.scroll_into_view_if_needed()
    assert figure.evaluate("image => image.naturalWidth") > 300
    caption = figure.page.get_by_text("Figure.", exact=True).first
    assert caption.bounding_box()["y"] > figure.bounding_box()["y"]


def test_a_body_gestures_to_its_sound(visit, tmp_path):
    page = visit("00_start_here")
    page.locator(".place").first.scroll_into_view_if_needed()
    page.locator(".s2g-player[data-draws]").first.wait_for()
    before = picture(page)
    page.get_by_role("button", name="Play").first.click()
    wait_for_time(page, 0.5)
    assert page.evaluate("() => sounds[0].duration") > 4
    assert page.evaluate(NOW)[0] > 0.4
    assert abs(picture(page) - before).max() > 50
    page.screenshot(path=tmp_path / "book.png")


def test_the_keyboard_skips_to_the_text_and_opens_a_fold(visit):
    page = visit("00_start_here")
    page.keyboard.press("Tab")
    assert page.evaluate(FOCUSED) == "Skip to the text"
    page.keyboard.press("Enter")
    assert page.evaluate(FOCUSED) == "text"
    page.get_by_text("The letters", exact=True).focus()
    page.keyboard.press("Enter")
    page.get_by_role("columnheader", name="in ProbTalk").wait_for()


@pytest.mark.parametrize("width", [390, 1280])
def test_no_page_is_wider_than_the_screen(visit, width):
    page = visit("01_motion_and_sound")
    page.set_viewport_size({"width": width, "height": 800})
    page.locator("main p mjx-container svg").first.wait_for()
    assert page.evaluate("() => document.documentElement.scrollWidth") <= width


def test_nothing_was_complained_of_and_nobody_outside_was_asked(book):
    watched, _ = book
    assert watched.complaints == []
    assert watched.outside == []
