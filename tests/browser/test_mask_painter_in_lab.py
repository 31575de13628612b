"""The mask painter in a real JupyterLab."""

import inspect
from pathlib import Path

import pytest
from browser.lab import (
    execute,
    open_browser,
    open_notebook,
    run_all_cells,
    run_in_kernel,
    write_notebook,
)
from stand_in_probtalk import small_probtalk

pytestmark = pytest.mark.browser
HEAD = inspect.getsource(inspect.getmodule(small_probtalk))
CELLS = (
    f"import sys; sys.path.insert(0, {str(Path(__file__).parents[1])!r})\n{HEAD}\n"
    "from stand_in import capsule_body, tone, waving_motion\n"
    "from s2glib.widgets import MaskPainter\n"
    "painter = MaskPainter(\n"
    "    small_probtalk(), tone(), waving_motion(90), capsule_body(), {'one': 0, 'two': 5}\n"
    ")\n"
    "rows = painter.timeline",
    "painter",
    "rows",
)
NONE, ALL = "0" * 12, "1" * 12


@pytest.fixture(scope="module")
def lab(lab_folder, lab_address, tmp_path_factory):
    """A notebook that shows the painter, and its rows once more, all cells run."""
    write_notebook(lab_folder / "painter.ipynb", CELLS)
    with open_browser(tmp_path_factory.mktemp("painter")) as watched:
        open_notebook(watched.page, lab_address, "painter.ipynb")
        assert run_all_cells(watched.page) == []
        watched.page.wait_for_selector(".s2g-painter[data-kept] >> nth=1")
        watched.page.wait_for_selector(".s2g-player[data-draws]")
        yield watched


@pytest.fixture
def page(lab):
    """The painter, with nothing painted."""
    execute(lab.page, "painter.paint(['0' * 12] * 4); painter.player.seek(0)")
    wait_for_rows(lab.page, NONE, NONE, NONE, NONE)
    return lab.page


def wait_for_rows(page, *rows):
    """Until both views show these rows."""
    page.wait_for_function(
        """kept => [...document.querySelectorAll('.s2g-painter')]
            .every(e => e.dataset.kept === kept)""",
        arg=" ".join(rows),
    )


def agree(page, *rows):
    """Until both views and Python have these rows."""
    wait_for_rows(page, *rows)
    hear(page, f"assert rows.kept == {list(rows)}, rows.kept")


def hear(page, claim):
    """Until Python has heard the news; on a busy machine they take their time."""
    for _ in range(40):
        if run_in_kernel(page, claim) is None:
            return
        page.wait_for_timeout(300)
    raise AssertionError(f"Python never heard: {claim}")


def cell(page, row, column):
    return page.locator(".s2g-painter").first.get_by_role("gridcell").nth(12 * row + column)


def middle(page, row, column):
    cell(page, row, column).scroll_into_view_if_needed()
    box = cell(page, row, column).bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def press(page):
    """Press the button, and wait for the answer."""
    page.get_by_role("button", name="Make the rest anew").first.click()
    page.wait_for_selector(".s2g-painter[data-busy=false] >> nth=1", timeout=60_000)


def test_the_mouse_paints_a_rectangle_even_if_it_hurries(page):
    page.mouse.move(*middle(page, 1, 2))
    page.mouse.down()
    page.mouse.move(*middle(page, 2, 6), steps=1)
    page.mouse.up()
    row = "001111100000"
    agree(page, NONE, row, row, NONE)


def test_on_painted_fields_the_mouse_wipes(page):
    execute(page, "painter.paint(['1' * 12] * 4)")
    wait_for_rows(page, ALL, ALL, ALL, ALL)
    page.mouse.move(*middle(page, 0, 3))
    page.mouse.down()
    page.mouse.move(*middle(page, 0, 5), steps=5)
    page.mouse.up()
    page.mouse.move(*middle(page, 3, 9))  # no button is held any more
    agree(page, "111000111111", ALL, ALL, ALL)


def test_a_finger_paints(page):
    client = page.context.new_cdp_session(page)

    def touch(kind, *places):
        points = [dict(zip("xy", middle(page, *place), strict=True)) for place in places]
        client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    touch("touchStart", (3, 1))
    for column in (2, 3, 4):
        touch("touchMove", (3, column))
    touch("touchEnd")
    agree(page, NONE, NONE, NONE, "011110000000")


def test_keys_paint_without_moving_the_notebook(page):
    active = "() => jupyterapp.shell.currentWidget.content.activeCellIndex"
    cell(page, 0, 0).click()
    before = page.evaluate(active)
    agree(page, "100000000000", NONE, NONE, NONE)
    for key in ("Shift+ArrowRight", "Shift+ArrowRight", "ArrowDown", "Space", "End", "Enter"):
        page.keyboard.press(key)
    agree(page, "111000000000", "001000000001", NONE, NONE)
    page.keyboard.press("Home")
    page.keyboard.press("ArrowLeft")  # there is nothing further left
    page.keyboard.press("Space")
    agree(page, "111000000000", "101000000001", NONE, NONE)
    assert page.evaluate(active) == before


def test_one_field_of_the_grid_is_in_the_tab_order(page):
    painter = page.locator(".s2g-painter").first
    assert painter.locator("[role=gridcell][tabindex='0']").count() == 1
    painter.get_by_role("button", name="right hand: all or nothing").focus()
    page.keyboard.press("Shift+Tab")
    outline = page.evaluate("() => getComputedStyle(document.activeElement).outlineWidth")
    assert float(outline.removesuffix("px")) >= 2


def test_a_name_paints_its_row_and_presets_paint_all(page):
    painter = page.locator(".s2g-painter").first
    painter.get_by_role("button", name="left hand: all or nothing").click()
    agree(page, NONE, NONE, ALL, NONE)
    painter.get_by_role("button", name="left hand: all or nothing").click()
    agree(page, NONE, NONE, NONE, NONE)
    wanted = {
        "hands stay": (NONE, NONE, ALL, ALL),
        "body stays": (NONE, ALL, NONE, NONE),
        "continue": ("111100000000",) * 4,
        "in-between": ("111100000111",) * 4,
        "everything": (ALL,) * 4,
        "nothing": (NONE,) * 4,
    }
    for name, rows in wanted.items():
        painter.get_by_role("button", name=name, exact=True).click()
        agree(page, *rows)


def test_fields_say_what_they_are(page):
    cell(page, 2, 6).click()
    name = cell(page, 2, 6).get_attribute("aria-label")
    assert name == "left hand, 1.6 s, stays"
    assert cell(page, 2, 7).get_attribute("aria-selected") == "false"


def test_the_button_makes_the_rest_anew_and_both_play(page):
    page.locator(".s2g-painter").first.get_by_role("button", name="body stays").click()
    press(page)
    execute(page, "assert painter.stays and painter.context_mask.any(0).tolist() == [0, 1, 0, 0]")
    page.get_by_text("25% is kept, bit for bit").wait_for()
    names = page.locator(".s2g-names span").all_text_contents()
    assert names == ["original", "made anew"]
    page.locator(".s2g-play").click()
    page.wait_for_function("() => document.querySelector('.s2g-player').dataset.time > 0.3")
    page.locator(".s2g-play").click()


def test_the_button_works_by_keys_and_keeps_the_focus(page):
    page.locator(".s2g-painter").first.locator(".paint-make").focus()
    page.keyboard.press("Enter")
    page.wait_for_selector(".s2g-painter[data-busy=false] >> nth=1", timeout=60_000)
    focused = page.evaluate("() => document.activeElement.textContent")
    assert focused == "Make the rest anew"
    execute(page, "assert rows.done == rows.pressed > 0")


def test_a_burst_of_presses_asks_once(page):
    execute(page, "before = painter._takes")
    page.evaluate(
        "() => { for (let k = 0; k < 50; k++) document.querySelector('.paint-make').click(); }"
    )
    page.wait_for_selector(".s2g-painter[data-busy=false] >> nth=1", timeout=60_000)
    execute(page, "assert painter._takes == before + 1, painter._takes - before")


def test_a_burst_of_painting_ends_with_the_last_field(page):
    page.evaluate(
        """() => {
            const buttons = document.querySelectorAll('.s2g-painter .paint-name');
            for (let k = 0; k < 101; k++) buttons[k % 4].click();
        }"""
    )
    agree(page, NONE, ALL, ALL, ALL)


def test_a_line_follows_the_player_in_both_views(page):
    execute(page, "painter.player.seek(1.5)")
    page.wait_for_function(
        """() => [...document.querySelectorAll('.s2g-painter')]
            .every(e => Math.abs(e.style.getPropertyValue('--moment') - 45 / 96) < 0.02)"""
    )


def test_another_speaker_can_be_chosen(page):
    page.locator(".widget-dropdown select").select_option("two")
    hear(page, "assert painter.speaker.value == 5")


def test_nothing_was_complained_of_and_nobody_outside_was_asked(lab):
    assert lab.complaints == []
    assert lab.outside == []
