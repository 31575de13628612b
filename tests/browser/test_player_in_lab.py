"""The player in a real JupyterLab."""

from pathlib import Path

import numpy as np
import pytest
from browser.lab import execute, open_browser, open_notebook, pixels, run_all_cells, write_notebook
from stand_in import capsule_body, waving_motion

from s2glib.body import skin_motion

pytestmark = pytest.mark.browser
CELLS = (
    f"import sys; sys.path.insert(0, {str(Path(__file__).parents[1])!r})\n"
    "from stand_in import capsule_body, tone, waving_motion\n"
    "from s2glib.widgets import Player\n"
    "body, sound, motion = capsule_body(), tone(4), waving_motion(120)",
    "player = Player(motion, sound, body, height=240)\nplayer",
    "player",
)
REMEMBER_SOUNDS = """
    window.sounds = [];
    window.Audio = class extends Audio { constructor(...a) { super(...a); sounds.push(this); } };
"""
NOW = "() => sounds.map(sound => sound.currentTime)"


@pytest.fixture(scope="module")
def lab(lab_folder, lab_address, tmp_path_factory):
    """A notebook that shows one player twice, all cells run."""
    write_notebook(lab_folder / "player.ipynb", CELLS)
    with open_browser(tmp_path_factory.mktemp("browser")) as watched:
        watched.page.add_init_script(REMEMBER_SOUNDS)
        open_notebook(watched.page, lab_address, "player.ipynb")
        assert run_all_cells(watched.page) == []
        watched.page.wait_for_selector(".s2g-player[data-draws] >> nth=1")
        yield watched


@pytest.fixture
def page(lab):
    """The notebook, at rest at the start of its first clip."""
    execute(lab.page, "player.pause(); player.show(motion, sound); player.seek(0)")
    lab.page.wait_for_function(
        "() => [...document.querySelectorAll('.s2g-player')].every("
        "view => view.dataset.playing === 'false' && view.dataset.frame === '0')"
    )
    return lab.page


def views(page, name):
    return [float(view.get_attribute(f"data-{name}")) for view in page.locator(".s2g-player").all()]


def picture(page, view=0):
    return pixels(page.locator(".s2g-player canvas").nth(view))


def wait_for_time(page, seconds):
    page.wait_for_function(
        f"() => document.querySelector('.s2g-player').dataset.time > {seconds}", timeout=20_000
    )


def test_sound_from_python_before_any_click_asks_for_one(page):
    page.evaluate(
        "() => sounds[0].play = async () => { throw new DOMException('', 'NotAllowedError') }"
    )
    execute(page, "player.play()")
    page.wait_for_selector("text=press Play once")
    page.wait_for_selector(".s2g-player[data-playing=false]")
    assert page.get_by_text("press Play once").first.is_visible()
    page.evaluate("() => { delete sounds[0].play }")


def test_the_body_follows_the_sound_in_both_views(page):
    page.locator(".s2g-play").first.click()
    wait_for_time(page, 1.0)
    heard = page.evaluate(NOW)
    first, second = views(page, "time")
    assert len(heard) == 1  # one widget, one sound
    assert heard[0] > 0.9
    assert abs(first - heard[0]) < 0.6
    assert abs(second - heard[0]) < 0.6


def test_python_hears_where_the_body_is(page):
    page.locator(".s2g-play").first.click()
    wait_for_time(page, 0.5)
    page.locator(".s2g-play").nth(1).click()
    page.wait_for_selector(".s2g-player[data-playing=false]")
    seen = int(views(page, "frame")[0])
    page.wait_for_timeout(300)
    execute(page, f"assert player.frame == {seen} and not player.playing, player.frame")


def test_playing_moves_the_picture(page):
    before = picture(page)
    page.locator(".s2g-play").first.click()
    wait_for_time(page, 0.5)
    assert np.abs(picture(page) - before).max() > 50


def test_a_swap_while_playing_shows_the_other_body_and_plays_on(page):
    page.locator(".s2g-play").first.click()
    wait_for_time(page, 0.5)
    execute(page, "player.show(waving_motion(120, reach=-3), sound)")
    wait_for_time(page, 1.0)
    page.locator(".s2g-play").first.click()
    execute(page, "player.pause(); player.seek(40 / 30)")
    page.wait_for_selector(".s2g-player[data-frame='40']")
    edited = picture(page)
    execute(page, "player.show(motion, sound)")
    page.wait_for_timeout(500)
    assert np.abs(picture(page) - edited).max() > 50
    assert views(page, "frame") == [40, 40]


def test_a_burst_of_orders_ends_with_the_last_one(page):
    execute(
        page,
        "for k in range(120):\n"
        "    player.seek(k / 30)\n"
        "    player.pause() if k % 2 else player.play()\n"
        "    if k % 10 == 0: player.show(waving_motion(60 + k), tone(2 + k / 60))\n"
        "player.show(motion, sound)\n"
        "player.pause()\n"
        "player.seek(77 / 30)\n",
    )
    page.wait_for_selector(".s2g-player[data-frame='77'][data-playing=false]")
    page.wait_for_timeout(500)
    assert views(page, "frame") == [77, 77]
    execute(page, "assert (player.frame, player.playing) == (77, False)")


def test_keys_play_step_and_return_without_moving_the_notebook(page):
    cell = page.evaluate("() => jupyterapp.shell.currentWidget.content.activeCellIndex")
    page.locator(".s2g-player canvas").first.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowLeft")
    page.wait_for_selector(".s2g-player[data-frame='1']")
    page.keyboard.press("Space")
    wait_for_time(page, 0.3)
    page.keyboard.press("Space")
    page.keyboard.press("Home")
    page.wait_for_selector(".s2g-player[data-frame='0'][data-playing=false]")
    assert page.evaluate("() => jupyterapp.shell.currentWidget.content.activeCellIndex") == cell


@pytest.mark.parametrize("frame", [0, 41, 119])
def test_the_gpu_skins_as_linear_blend_skinning_does(page, frame):
    found = page.evaluate(
        f"() => [...document.querySelector('.s2g-player').readVertices({frame} / 30, 0)]"
    )
    expected = skin_motion(waving_motion(120), capsule_body()).vertices[frame].numpy()
    assert np.abs(np.reshape(found, (-1, 3)) - expected).max() < 5e-4  # metres


def test_between_two_frames_the_body_is_between_them(page):
    read = "time => [...document.querySelector('.s2g-player').readVertices(time, 0)]"
    first, half, second = (np.array(page.evaluate(read, k / 30)) for k in (20, 20.5, 21))
    assert np.abs(half - (first + second) / 2).max() < 1e-3
    assert np.abs(second - first).max() > 1e-2


def test_a_view_that_is_closed_gives_its_canvas_back(page):
    open_canvases = "() => document.querySelectorAll('.s2g-player canvas').length"
    for _ in range(12):  # a browser keeps about 16 contexts alive
        run_all_cells(page)
    page.wait_for_selector(".s2g-player[data-draws] >> nth=1")
    assert page.evaluate(open_canvases) == 2
    assert picture(page).std() > 5


def test_controls_have_names_and_a_visible_focus(page):
    page.locator(".s2g-play").first.focus()
    page.keyboard.press("Tab")
    outline = page.evaluate("() => getComputedStyle(document.activeElement).outlineWidth")
    assert float(outline.removesuffix("px")) >= 2
    bar = page.locator(".s2g-player").first
    assert bar.get_by_role("button", name="Play").count() == 1
    assert bar.get_by_role("slider", name="Time").count() == 1
    assert bar.get_by_role("combobox", name="Speed").count() == 1


def test_nothing_was_complained_of_and_nobody_outside_was_asked(lab):
    assert lab.complaints == []
    assert lab.outside == []
