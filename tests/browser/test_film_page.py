"""The page of a film, opened from the disk."""

import io

import numpy as np
import pytest
from browser.lab import open_browser
from browser.test_player_in_lab import NOW, REMEMBER_SOUNDS, views, wait_for_time
from PIL import Image
from stand_in import tone
from stand_in_film import moving_film

from s2glib.widgets import write_film_page

pytestmark = pytest.mark.browser
FILM = moving_film(50, 48, 64)


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    """A browser without a network."""
    with open_browser(tmp_path_factory.mktemp("browser")) as browser:
        browser.page.context.set_offline(True)
        browser.page.add_init_script(REMEMBER_SOUNDS)
        yield browser


@pytest.fixture(scope="module")
def write_page(tmp_path_factory):
    """Write a page of two films; the second runs backwards, and is shorter."""

    def write_page(waveform):
        films = {"forward": FILM, "backward": FILM[:9:-1]}
        path = tmp_path_factory.mktemp("page") / "film.html"
        write_film_page(path, films, 25, waveform, title="Two films", width=128)
        return path.as_uri()

    return write_page


@pytest.fixture
def page(browser, write_page):
    browser.page.goto(write_page(tone(2)))
    browser.page.wait_for_selector(".s2g-film[data-draws]")
    return browser.page


def where_is_the_disc(page, name):
    """How far right the disc stands in a film, 0 to 1."""
    png = page.get_by_role("img", name=name).screenshot()
    red, _, blue = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), float).transpose(2, 0, 1)
    lit = (red > 190) & (blue < 90)
    return np.nonzero(lit)[1].mean() / lit.shape[1]


def place_of(frame):
    """How far right it is in the frame, 0 to 1, as far as it is in the picture."""
    lit = (FILM[frame] == (235, 180, 60)).all(axis=-1)
    return (np.nonzero(lit)[1].mean() + 0.5) / lit.shape[1]


def test_it_plays_pictures_and_sound_in_time(page, browser):
    page.get_by_role("button", name="Play").click()
    wait_for_time(page, 0.8)
    page.get_by_role("button", name="Pause").click()
    page.wait_for_selector(".s2g-film[data-playing=false]")
    (heard,), (frame,) = page.evaluate(NOW), views(page, "frame")
    assert heard > 0.7
    assert frame == min(int(heard * 25 + 1e-3), 49)  # a busy machine may reach the end
    assert where_is_the_disc(page, "forward") == pytest.approx(place_of(int(frame)), abs=0.02)
    assert (browser.complaints, browser.outside) == ([], [])


def test_the_picture_follows_the_sound_while_it_plays(page):
    page.get_by_role("button", name="Play").click()
    wait_for_time(page, 0.3)
    late = page.evaluate(
        "async () => { const late = [];"
        "for (let k = 0; k < 20; k++) { await new Promise(requestAnimationFrame);"
        "late.push(sounds[0].currentTime * 25 - document.querySelector('.s2g-film').dataset.frame);"
        "} return late; }"
    )
    assert max(late) - min(late) > 0
    assert np.median(late) < 3


def test_films_play_in_step_and_a_shorter_one_waits_at_its_end(page):
    for frame, other in ((0, 49), (20, 29), (45, 10)):
        page.get_by_role("slider").fill(str((frame + 0.5) / 25))
        page.wait_for_selector(f".s2g-film[data-frame='{frame}']")
        page.wait_for_timeout(200)
        assert where_is_the_disc(page, "forward") == pytest.approx(place_of(frame), abs=0.02)
        assert where_is_the_disc(page, "backward") == pytest.approx(place_of(other), abs=0.02)
    assert page.locator("figcaption").all_inner_texts() == ["forward", "backward"]


def test_keys_step_frame_by_frame_play_and_return(page):
    page.locator(".s2g-screen").focus()
    for key in ("ArrowRight", "ArrowRight", "ArrowRight", "ArrowLeft"):
        page.keyboard.press(key)
    page.wait_for_selector(".s2g-film[data-frame='2']")
    page.keyboard.press("Space")
    wait_for_time(page, 0.4)
    page.keyboard.press("Space")
    page.wait_for_selector(".s2g-film[data-playing=false]")
    page.keyboard.press("Home")
    page.wait_for_selector(".s2g-film[data-frame='0']")
    page.keyboard.press("ArrowLeft")
    assert views(page, "frame") == [0]


def test_a_click_on_a_picture_plays_and_pauses(page):
    page.get_by_role("img", name="backward").click()
    wait_for_time(page, 0.2)
    page.get_by_role("img", name="forward").click()
    page.wait_for_selector(".s2g-film[data-playing=false]")
    assert page.evaluate(NOW)[0] > 0.15


def test_it_ends_at_the_end_and_plays_again(page):
    page.get_by_role("slider").fill("1.8")
    page.get_by_role("button", name="Play").click()
    page.wait_for_selector(".s2g-film[data-playing=false][data-frame='49']")
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("() => document.querySelector('.s2g-film').dataset.time < 1.5")
    assert page.locator(".s2g-film").get_attribute("data-playing") == "true"


def test_half_speed_is_half_as_fast_for_sound_and_pictures(page):
    page.get_by_role("combobox", name="Speed").select_option("0.5 ×")
    page.get_by_role("button", name="Play").click()
    wait_for_time(page, 0.2)
    assert page.evaluate("() => sounds[0].playbackRate") == 0.5


def test_without_sound_the_wall_clock_leads(browser, write_page):
    page = browser.page
    page.goto(write_page(None))
    page.get_by_role("button", name="Play").click()
    page.wait_for_selector(".s2g-film[data-playing=false][data-frame='49']")
    assert page.evaluate("() => sounds[0].currentTime") == 0


def test_where_the_sound_stands_still_the_wall_clock_takes_over(page):
    page.evaluate("() => { sounds[0].play = async () => {} }")
    page.get_by_role("button", name="Play").click()
    wait_for_time(page, 0.4)
    assert page.get_by_text("The sound does not start").is_visible()
    page.get_by_role("button", name="Pause").click()
    page.wait_for_selector(".s2g-film[data-playing=false]")
    assert page.evaluate(NOW)[0] > 0.4
    page.evaluate("() => { delete sounds[0].play }")
    page.get_by_role("button", name="Play").click()
    page.wait_for_selector(".s2g-film[data-playing=false][data-frame='49']")
    assert page.get_by_text("The sound does not start").count() == 0


def test_a_browser_that_cannot_open_the_pictures_says_so(browser, write_page):
    page = browser.page.context.new_page()
    page.add_init_script("createImageBitmap = async () => { throw new Error('too old') }")
    page.goto(write_page(None))
    page.get_by_text("The pictures do not open: too old").wait_for()
    assert page.get_by_role("button", name="Play").is_visible()
    page.close()


@pytest.mark.parametrize("width", [390, 1180])
def test_films_stay_beside_each_other_and_on_the_screen(page, width):
    page.set_viewport_size({"width": width, "height": 700})
    first, second = (page.get_by_role("img", name=name) for name in ("forward", "backward"))
    assert first.bounding_box()["y"] == second.bounding_box()["y"]
    assert page.evaluate("() => document.documentElement.scrollWidth") <= width
