"""The unmasking stepper in a real JupyterLab."""

from pathlib import Path

import numpy as np
import pytest
from browser.lab import (
    execute,
    open_browser,
    open_notebook,
    pixels,
    run_all_cells,
    run_in_kernel,
    write_notebook,
)

pytestmark = pytest.mark.browser
CELLS = (
    f"import sys; sys.path.insert(0, {str(Path(__file__).parents[1])!r})\n"
    "from stand_in import capsule_body, tone\n"
    "from stand_in_probtalk import small_probtalk\n"
    "from s2glib.widgets import UnmaskingStepper",
    "stepper = UnmaskingStepper(small_probtalk(), tone(6.0), capsule_body())\nstepper",
)
HIDDEN = "rect[fill='#d9d9d9']"


@pytest.fixture(scope="module")
def lab(lab_folder, lab_address, tmp_path_factory):
    """A notebook that shows the stepper, all cells run."""
    write_notebook(lab_folder / "stepper.ipynb", CELLS)
    with open_browser(tmp_path_factory.mktemp("stepper")) as watched:
        open_notebook(watched.page, lab_address, "stepper.ipynb")
        assert run_all_cells(watched.page) == []
        watched.page.wait_for_selector(".s2g-player[data-draws]")
        yield watched


@pytest.fixture
def page(lab):
    """The stepper, eight steps in all, nothing decoded yet."""
    execute(lab.page, "stepper.choose(steps=8, draw=1); stepper.go(0)")
    lab.page.get_by_text("all 88 tokens are hidden").wait_for()
    return lab.page


def picture(page):
    return pixels(page.locator(".s2g-player canvas"))


def step(page):
    page.get_by_role("button", name="Next step").click()


def test_the_table_fills_up_step_by_step(page):
    counts = []
    for number in range(1, 9):
        step(page)
        page.get_by_text(f"Step {number} of 8:").wait_for()
        counts.append(page.locator(HIDDEN).count())
    assert counts == [86, 81, 73, 62, 48, 33, 17, 0]


def test_at_first_the_table_is_blank_and_later_hidden_tokens_are_crossed(page):
    svg = page.locator("[role=img] svg")
    crosses = svg.get_by_text("×", exact=True)
    assert crosses.count() == 0
    step(page)
    page.get_by_text("Step 1 of 8:").wait_for()
    assert crosses.count() == 86


def test_the_body_moves_differently_after_a_step(page):
    execute(page, "stepper.player.seek(2.0)")
    page.wait_for_selector(".s2g-player[data-frame='60']")
    before = picture(page)
    execute(page, "stepper.go(8)")
    page.get_by_text("Step 8 of 8:").wait_for()
    page.wait_for_timeout(500)
    page.wait_for_selector(".s2g-player[data-frame='60']")
    assert np.abs(picture(page) - before).max() > 50


def test_start_again_goes_back(page):
    step(page)
    page.get_by_text("Step 1 of 8:").wait_for()
    page.get_by_role("button", name="Start again").click()
    page.get_by_text("all 88 tokens are hidden").wait_for()
    execute(page, "assert stepper.step.value == 0")


def test_the_slider_of_steps_goes_by_keys(page):
    handle = page.locator(".widget-slider", has_text="steps in all").locator(".noUi-handle")
    handle.focus()
    for _ in range(7):
        page.keyboard.press("ArrowLeft")
    page.keyboard.press("Tab")
    for _ in range(20):
        page.wait_for_timeout(300)
        if run_in_kernel(page, "assert stepper.steps.value == 1") is None:
            break
    step(page)
    page.get_by_text("Step 1 of 1: 88 of 88 tokens are known").wait_for()


def test_a_burst_of_steps_ends_with_the_last_one(page):
    execute(
        page,
        "for k in range(30): stepper.choose(steps=8, draw=1 + k % 3); stepper.go(k % 9)\n"
        "stepper.choose(steps=4, draw=2); stepper.go(3)",
    )
    page.get_by_text("Step 3 of 4:").wait_for()
    assert page.locator(HIDDEN).count() == 33


def test_it_plays(page):
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("() => document.querySelector('.s2g-player').dataset.time > 0.3")
    page.locator(".s2g-play").click()


def test_the_table_is_told_to_those_who_do_not_see_it(page):
    step(page)
    page.get_by_text("Step 1 of 8:").wait_for()
    table = page.locator("[role=img]", has=page.locator("svg"))
    assert table.get_attribute("aria-label").startswith("Step 1 of 8: 2 of 88 tokens")


def test_nothing_was_complained_of_and_nobody_outside_was_asked(lab):
    assert lab.complaints == []
    assert lab.outside == []
