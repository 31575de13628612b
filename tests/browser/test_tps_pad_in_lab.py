"""The pad in a real JupyterLab."""

import numpy as np
import pytest
import torch
from browser.lab import execute, open_browser, open_notebook, pixels, run_all_cells, write_notebook

from s2glib.warping import apply_tps, bending_energy, fit_tps, tps_grid, warp_image
from s2glib.widgets import TPSPad
from s2glib.widgets.tps_pad import sample_picture

pytestmark = pytest.mark.browser
POINTS = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [0.0, 0.1]]
CELLS = (
    f"from s2glib.widgets import TPSPad\npad = TPSPad({POINTS}, width=360)\npad",
    "pad",
)
FIRST = "() => document.querySelector('.s2g-pad')"


@pytest.fixture(scope="module")
def lab(lab_folder, lab_address, tmp_path_factory):
    """A notebook that shows one pad twice, all cells run."""
    write_notebook(lab_folder / "pad.ipynb", CELLS)
    with open_browser(tmp_path_factory.mktemp("browser")) as watched:
        open_notebook(watched.page, lab_address, "pad.ipynb")
        assert run_all_cells(watched.page) == []
        watched.page.wait_for_selector(".s2g-pad[data-drawn=true] >> nth=1")
        yield watched


@pytest.fixture
def page(lab):
    """The notebook with the points where they started."""
    execute(lab.page, "pad.ridge = 0; pad.reset()")
    wait_for_place(lab.page, 4, POINTS[4])
    return lab.page


def place(page, index, view=0):
    """Where a handle stands, in image coordinates."""
    return page.evaluate(
        "([view, index]) => { const pad = document.querySelectorAll('.s2g-pad')[view];"
        "const { left, top } = pad.querySelectorAll('.s2g-handle')[index].style;"
        "return [left, top].map((at) => parseFloat(at) / 50 - 1); }",
        [view, index],
    )


def wait_for_place(page, index, wanted):
    """Until both views show a point at a place."""
    page.wait_for_function(
        "([index, wanted]) => [...document.querySelectorAll('.s2g-pad')].every((pad) => {"
        "const { left, top } = pad.querySelectorAll('.s2g-handle')[index].style;"
        "return [left, top].every((at, k) => Math.abs(parseFloat(at) / 50 - 1 - wanted[k]) < 0.01);"
        "})",
        arg=[index, wanted],
    )


def on_screen(page, x, y):
    """Image coordinates in pixels of the first view's page."""
    box = page.locator(".s2g-field canvas").first.bounding_box()
    return box["x"] + (x + 1) / 2 * box["width"], box["y"] + (y + 1) / 2 * box["height"]


def drag(page, start, end, steps=8):
    page.mouse.move(*on_screen(page, *start))
    page.mouse.down()
    page.mouse.move(*on_screen(page, *end), steps=steps)
    page.mouse.up()


def picture(page, view=0):
    return pixels(page.locator(".s2g-field canvas").nth(view))


@pytest.mark.parametrize("ridge", [0.0, 0.01])
def test_the_page_solves_the_spline_that_python_fits(page, ridge):
    generator = torch.Generator().manual_seed(0)
    driving = 2 * torch.rand(5, 2, generator=generator, dtype=torch.float64) - 1
    queries = 2 * torch.rand(50, 2, generator=generator, dtype=torch.float64) - 1
    queries[:5] = driving
    moves = "".join(f"pad.move({k}, {x}, {y});" for k, (x, y) in enumerate(driving.tolist()))
    execute(page, f"pad.ridge = {ridge};{moves}")
    wait_for_place(page, 4, driving[4].tolist())
    found = page.evaluate(
        "(queries) => document.querySelector('.s2g-pad').readSpline(queries)", queries.tolist()
    )
    spline = fit_tps(driving, torch.tensor(POINTS, dtype=torch.float64), ridge=ridge)
    np.testing.assert_allclose(found, apply_tps(spline, queries), rtol=1e-9, atol=1e-10)
    energy = float(page.locator(".s2g-pad").first.get_attribute("data-energy"))
    assert energy == pytest.approx(bending_energy(spline).item(), rel=1e-9)


def test_the_mouse_drags_a_point_in_both_views_and_python_hears_of_it(page):
    before = picture(page), picture(page, view=1)
    drag(page, POINTS[4], (0.3, -0.2))
    wait_for_place(page, 4, [0.3, -0.2])
    page.wait_for_timeout(500)
    x, y = place(page, 4)
    execute(page, f"assert abs(pad.driving[4][0] - {x}) < 1e-3, pad.driving")
    execute(page, f"assert abs(pad.driving[4][1] - {y}) < 1e-3, pad.driving")
    assert np.abs(picture(page) - before[0]).max() > 50
    assert np.abs(picture(page, view=1) - before[1]).max() > 50


def test_a_finger_drags_a_point(page):
    client = page.context.new_cdp_session(page)

    def touch(kind, *points):
        places = [dict(zip("xy", on_screen(page, *point), strict=True)) for point in points]
        client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": places})

    touch("touchStart", POINTS[0])
    for step in range(1, 6):
        touch("touchMove", (-0.5, -0.5 + 0.1 * step))
    touch("touchEnd")
    wait_for_place(page, 0, [-0.5, 0.0])
    page.wait_for_timeout(500)
    execute(page, "assert abs(pad.driving[0][1]) < 0.01, pad.driving")


def test_keys_go_from_point_to_point_and_move_them_without_moving_the_notebook(page):
    cell = page.evaluate("() => jupyterapp.shell.currentWidget.content.activeCellIndex")
    page.locator(".s2g-handle").first.focus()
    page.keyboard.press("Tab")
    for key in ("ArrowRight", "ArrowRight", "ArrowUp", "Shift+ArrowDown"):
        page.keyboard.press(key)
    wait_for_place(page, 1, [0.54, -0.42])
    assert page.locator(".s2g-spoken").first.inner_text() == "Point 2: x 0.54, y −0.42"
    page.keyboard.press("Home")
    wait_for_place(page, 1, POINTS[1])
    assert page.evaluate("() => jupyterapp.shell.currentWidget.content.activeCellIndex") == cell


def test_the_picture_is_looked_up_where_the_spline_says(page):
    """The GPU's picture against the preview that Python draws from the same points."""
    execute(page, "pad.move(4, 0.3, 0.3); pad.move(0, -0.6, -0.3)")
    wait_for_place(page, 0, [-0.6, -0.3])
    wait_for_place(page, 4, [0.3, 0.3])
    pad = TPSPad(POINTS)
    pad.move(4, 0.3, 0.3)
    pad.move(0, -0.6, -0.3)
    shown = picture(page)
    expected = warped(pad, *shown.shape[:2])
    typical = np.median(np.abs(shown - expected).max(-1))  # lines and handles lie over the rest
    assert typical < 6
    assert np.median(np.abs(picture(page, view=1) - expected).max(-1)) < 6


def warped(pad, height, width):
    image = torch.from_numpy(sample_picture())[None]
    shown = warp_image(image, tps_grid(pad.spline, height, width)[None], padding="border")
    return 255 * shown[0].permute(1, 2, 0).numpy()


def test_points_on_each_other_are_said_to_hold_no_plate_and_a_ridge_helps(page):
    execute(page, "pad.move(0, 0.5, -0.5)")
    page.wait_for_selector("text=No plate passes")
    execute(page, "pad.ridge = 0.01")
    page.wait_for_selector("text=No plate passes", state="hidden")
    assert float(page.locator(".s2g-pad").first.get_attribute("data-energy")) > 0


def test_a_burst_of_drags_ends_where_the_last_one_did(page):
    start = POINTS[4]
    for end in ((0.4, 0.4), (-0.4, 0.2), (0.25, -0.25)):
        drag(page, start, end, steps=60)
        start = end
    wait_for_place(page, 4, [0.25, -0.25])
    page.wait_for_timeout(800)
    x, _ = place(page, 4)
    execute(page, f"assert abs(pad.driving[4][0] - {x}) < 1e-3, pad.driving")
    page.get_by_role("button", name="Start again").first.click()
    wait_for_place(page, 4, POINTS[4])


def test_controls_have_names_and_a_visible_focus(page):
    pad = page.locator(".s2g-pad").first
    assert pad.get_by_role("button", name="Point 3, x 0.50, y 0.50").count() == 1
    assert pad.get_by_role("img", name="A picture that bends").count() == 1
    page.locator(".s2g-handle").first.focus()
    page.keyboard.press("Tab")
    outline = page.evaluate("() => getComputedStyle(document.activeElement).outlineWidth")
    assert float(outline.removesuffix("px")) >= 2


def test_a_view_that_is_closed_gives_its_canvas_back(page):
    for _ in range(10):  # a browser keeps about 16 contexts alive
        run_all_cells(page)
    page.wait_for_selector(".s2g-pad[data-drawn=true] >> nth=1")
    assert page.locator(".s2g-pad canvas").count() == 2
    assert picture(page).std() > 5


def test_nothing_was_complained_of_and_nobody_outside_was_asked(lab):
    assert lab.complaints == []
    assert lab.outside == []
