"""The mask mixer in a real JupyterLab."""

import inspect

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
from stand_in_pair import stand_in_pair

from s2glib.widgets import MaskMixer

pytestmark = pytest.mark.browser
HEAD = inspect.getsource(inspect.getmodule(stand_in_pair))
CELLS = (
    f"{HEAD}\nfrom s2glib.widgets import MaskMixer\nmixer = MaskMixer(*stand_in_pair())\nmixer",
    "mixer",
)
EVERYWHERE = "(test) => [...document.querySelectorAll('.s2g-mixer')].every(eval(test))"


@pytest.fixture(scope="module")
def lab(lab_folder, lab_address, tmp_path_factory):
    """A notebook that shows one mixer twice, all cells run."""
    write_notebook(lab_folder / "mixer.ipynb", CELLS)
    with open_browser(tmp_path_factory.mktemp("browser")) as watched:
        open_notebook(watched.page, lab_address, "mixer.ipynb")
        assert run_all_cells(watched.page) == []
        watched.page.wait_for_selector(".s2g-mixer[data-draws] >> nth=1")
        yield watched


@pytest.fixture(scope="module")
def twin():
    """The same mixer, without a page."""
    return MaskMixer(*stand_in_pair())


@pytest.fixture
def page(lab, twin):
    """The notebook with all gains at 0 and no paint."""
    twin.reset()
    twin.paint(False)
    execute(lab.page, "mixer.reset(); mixer.paint(False)")
    wait_for_error(lab.page, twin.error)
    return lab.page


def wait_for_error(page, wanted):
    """Until both views show an error."""
    page.wait_for_function(
        EVERYWHERE, arg=f"(root) => Math.abs(root.dataset.error - {wanted}) < 2e-5"
    )


def shown_error(page):
    return float(page.locator(".s2g-mixer").first.get_attribute("data-error"))


def agree(page):
    """Until Python believes what the page shows; on a busy machine news takes its time."""
    for _ in range(20):
        page.wait_for_timeout(300)
        error = shown_error(page)
        if run_in_kernel(page, f"assert abs(mixer.error - {error}) < 2e-5") is None:
            return
    raise AssertionError(f"Python never heard of the error {error}")


def slider(page, index):
    return page.locator(".s2g-mixer").first.locator("input[type=range]").nth(index)


def wait_for_gain(page, index, text):
    """Views are drawn anew with the next frame of the screen."""
    sliders = "document.querySelectorAll('.s2g-mixer input[type=range]')"
    shown = f"([k, text]) => {sliders}[k].getAttribute('aria-valuetext') === text"
    page.wait_for_function(shown, arg=[index, text])


def on_slider(page, index, share):
    """A place on a slider, 0 at its left end and 1 at its right one."""
    slider(page, index).scroll_into_view_if_needed()
    box = slider(page, index).bounding_box()
    return box["x"] + 8 + share * (box["width"] - 16), box["y"] + box["height"] / 2


def picture(page, view=0):
    """What the canvas of the mixture shows."""
    return pixels(page.locator(".s2g-mixer").nth(view).locator(".mix-pictures canvas").nth(2))


ORDERS = (
    "mixer.set(1, 2.5); mixer.set(4, -9.0); mixer.set(0, -3.0)",
    "mixer.set(2, 8.0); mixer.paint(True)",
    "mixer.solo(3)",
    "mixer.solo(8); mixer.paint(True)",
    "[mixer.set(k, -8.0) for k in range(9)]",
)


@pytest.mark.parametrize("order", ORDERS)
def test_the_page_mixes_what_python_mixes(page, twin, order):
    exec(order, {"mixer": twin})
    execute(page, order)
    wait_for_error(page, twin.error)
    found = page.evaluate("() => document.querySelector('.s2g-mixer').readPicture()")
    np.testing.assert_allclose(np.reshape(found, (3, 64, 64)), twin.picture, atol=1e-4)


def test_the_mouse_moves_a_gain_in_both_views_and_start_again_brings_the_network_back(page):
    before, own = (picture(page), picture(page, view=1)), shown_error(page)
    page.mouse.move(*on_slider(page, 2, 0.5))
    page.mouse.down()
    page.mouse.move(*on_slider(page, 2, 1.0), steps=8)
    page.mouse.up()
    wait_for_gain(page, 2, "+8")
    agree(page)
    execute(page, "assert mixer.gains[2] == 8.0, mixer.gains")
    for view in (0, 1):
        assert np.abs(picture(page, view) - before[view]).max() > 50
    page.get_by_role("button", name="Start again").first.click()
    wait_for_error(page, own)
    agree(page)
    execute(page, "assert abs(mixer.error - mixer.network_error) < 1e-6 and not any(mixer.gains)")


def test_keys_move_a_gain_and_turn_a_warp_off_without_moving_the_notebook(page):
    cell = page.evaluate("() => jupyterapp.shell.currentWidget.content.activeCellIndex")
    slider(page, 1).focus()
    for key in ("ArrowRight", "ArrowUp", "ArrowRight", "ArrowDown"):
        page.keyboard.press(key)
    wait_for_gain(page, 1, "+1")
    page.keyboard.press("Home")
    wait_for_gain(page, 1, "off")
    agree(page)
    execute(page, "assert mixer.gains[1] == -8.0, mixer.gains")
    assert page.evaluate("() => jupyterapp.shell.currentWidget.content.activeCellIndex") == cell


def test_keys_let_a_warp_count_alone_and_all_of_them_again(page):
    own = shown_error(page)
    slider(page, 5).focus()
    page.keyboard.press("Tab")
    page.keyboard.press("Space")
    page.wait_for_selector(".s2g-mixer button[aria-pressed=true] >> nth=1")
    agree(page)
    execute(page, "assert mixer.alone == 5, mixer.alone")
    assert page.locator("figcaption").nth(2).inner_text() == "warp 5 alone"
    page.keyboard.press("Enter")
    wait_for_error(page, own)
    execute(page, "assert mixer.alone is None, mixer.alone")


def test_a_finger_moves_a_gain(page):
    client = page.context.new_cdp_session(page)

    def touch(kind, *shares):
        places = [dict(zip("xy", on_slider(page, 3, share), strict=True)) for share in shares]
        client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": places})

    touch("touchStart", 0.5)
    for step in range(1, 5):
        touch("touchMove", 0.5 - 0.1 * step)
    touch("touchEnd")
    agree(page)
    execute(page, "assert -8 <= mixer.gains[3] <= -5, mixer.gains")


def test_the_network_paints_what_is_occluded_when_asked(page):
    unpainted = shown_error(page)
    page.get_by_label("Occlusion mask").first.check()
    page.wait_for_function(
        EVERYWHERE, arg="(root) => root.querySelector('[type=checkbox]').checked"
    )
    agree(page)
    execute(page, "assert mixer.painted and abs(mixer.error - mixer.network_error) < 1e-6")
    assert abs(shown_error(page) - unpainted) > 1e-3


def test_all_off_is_said_to_be_the_same_as_all_on(page):
    own = shown_error(page)
    for index in range(9):
        slider(page, index).focus()
        page.keyboard.press("Home")
    wait_for_error(page, own)
    assert "same as all on" in page.locator(".mix-note").first.inner_text()


def test_a_burst_of_moves_ends_where_the_last_one_did(page):
    for index, share in ((0, 0.1), (6, 0.9), (7, 0.2)):
        page.mouse.move(*on_slider(page, index, 0.5))
        page.mouse.down()
        page.mouse.move(*on_slider(page, index, share), steps=40)
        page.mouse.up()
    agree(page)
    gains = [float(slider(page, index).input_value()) for index in range(9)]
    execute(page, f"assert mixer.gains == {gains}, mixer.gains")


def test_controls_have_names_and_a_visible_focus(page):
    mixer = page.locator(".s2g-mixer").first
    for name in ("Gain of background", "Gain of warp 8"):
        assert mixer.get_by_role("slider", name=name, exact=True).count() == 1
    assert mixer.get_by_role("button", name="Solo: warp 3 alone").count() == 1
    assert mixer.get_by_role("img", name="The source").count() == 2 + 9
    slider(page, 4).focus()
    page.keyboard.press("Tab")
    outline = page.evaluate("() => getComputedStyle(document.activeElement).outlineWidth")
    assert float(outline.removesuffix("px")) >= 2


def test_nothing_was_complained_of_and_nobody_outside_was_asked(lab):
    assert lab.complaints == []
    assert lab.outside == []
