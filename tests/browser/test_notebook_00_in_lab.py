"""A reader's first minutes: notebook 00 in JupyterLab, run from top to bottom and played with."""

import shutil
from pathlib import Path

import pytest
from browser.lab import open_browser, open_notebook, pixels, run_all_cells
from browser.test_player_in_lab import NOW, REMEMBER_SOUNDS

pytestmark = pytest.mark.browser
NOTEBOOK = Path(__file__).parents[2] / "notebooks" / "00_start_here.ipynb"
MATHS = ".jp-MarkdownOutput mjx-container"


@pytest.fixture(scope="module")
def lab(lab_folder, lab_address, tmp_path_factory):
    """The notebook with all cells run, and the errors of its cells."""
    shutil.copy(NOTEBOOK, lab_folder)
    folder = tmp_path_factory.mktemp("notebook_00")
    with open_browser(folder) as watched:
        watched.page.add_init_script(REMEMBER_SOUNDS)
        open_notebook(watched.page, lab_address, NOTEBOOK.name)
        errors = run_all_cells(watched.page)
        yield watched, errors, folder


@pytest.fixture
def demo(lab):
    """The emotion swap, in view."""
    demo = lab[0].page.locator(".jp-OutputArea-output:has(.widget-dropdown):has(.s2g-player)")
    demo.scroll_into_view_if_needed()
    demo.locator(".s2g-player[data-draws]").wait_for()
    return demo


def picture(demo):
    return pixels(demo.locator("canvas"))


def test_every_cell_runs(lab):
    assert lab[1] == []


def test_another_emotion_changes_the_body_and_the_words(lab, demo):
    before = picture(demo)
    demo.locator(".widget-dropdown", has_text="becomes").locator("select").select_option(
        "happiness"
    )
    demo.locator("p[role=status]", has_text="happiness").wait_for()
    demo.page.wait_for_timeout(500)
    assert abs(picture(demo) - before).max() > 50
    demo.page.screenshot(path=lab[2] / "notebook_00.png")


def test_time_advances_with_the_sound(demo):
    before = picture(demo)
    demo.get_by_role("button", name="Play").click()
    demo.locator(".s2g-player[data-playing=true]").wait_for()
    demo.page.wait_for_timeout(1000)
    seen = float(demo.locator(".s2g-player").get_attribute("data-time"))
    assert seen > 0.3
    assert min(abs(heard - seen) for heard in demo.page.evaluate(NOW)) < 0.6
    assert abs(picture(demo) - before).max() > 50


def test_the_wheel_scrolls_past_a_body_until_it_is_clicked(demo):
    def turn_wheel(amount):
        box = demo.locator("canvas").bounding_box()
        demo.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        demo.page.mouse.wheel(0, amount)
        demo.page.wait_for_timeout(500)
        return box["y"] - demo.locator("canvas").bounding_box()["y"]

    demo.page.evaluate("() => document.activeElement.blur()")
    assert turn_wheel(60) > 30
    demo.locator("canvas").click()
    assert turn_wheel(60) == 0


def test_formulas_are_set(lab):
    page = lab[0].page
    page.get_by_role("heading", name="One letter").scroll_into_view_if_needed()
    page.get_by_text("The letters", exact=True).click()
    page.locator(MATHS).first.wait_for()
    assert page.locator(MATHS).count() > 5


def test_nothing_was_complained_of_and_nobody_outside_was_asked(lab):
    assert lab[0].complaints == []
    assert lab[0].outside == []
