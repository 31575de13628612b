"""gesture.html, opened from the disk."""

import pytest
from browser.test_player_in_lab import NOW, REMEMBER_SOUNDS, picture, wait_for_time
from stand_in import capsule_body, tone, waving_motion

from s2glib.widgets import write_html

pytestmark = pytest.mark.browser


@pytest.fixture
def address(tmp_path):
    motions = {"source": waving_motion(), "edited": waving_motion(reach=-2.0)}
    words = {"title": "A sentence", "text": "Its emotion was swapped.", "view": "source"}
    write_html(tmp_path / "gesture.html", motions, tone(), capsule_body(), **words)
    return (tmp_path / "gesture.html").as_uri()


def test_it_plays_body_and_sound_offline(watched, address):
    page = watched.page
    page.context.set_offline(True)
    page.add_init_script(REMEMBER_SOUNDS)
    page.goto(address)
    before = picture(page)
    page.get_by_role("button", name="Play").click()
    wait_for_time(page, 0.8)
    assert page.evaluate(NOW)[0] > 0.7
    assert abs(picture(page) - before).max() > 50
    assert (watched.complaints, watched.outside) == ([], [])


def test_it_ends_at_the_end_and_plays_again(watched, address):
    page = watched.page
    page.goto(address)
    page.get_by_role("slider").fill("2.8")
    page.get_by_role("button", name="Play").click()
    page.wait_for_selector(".s2g-player[data-playing=false][data-frame='89']")
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("() => document.querySelector('.s2g-player').dataset.time < 2.5")
    assert page.locator(".s2g-player").get_attribute("data-playing") == "true"


def test_buttons_choose_the_body(watched, address):
    page = watched.page
    page.goto(address)
    source = picture(page)
    page.get_by_role("button", name="edited").click()
    page.wait_for_timeout(300)
    edited = picture(page)
    page.get_by_role("button", name="side by side").click()
    page.wait_for_timeout(300)
    assert abs(edited - source).max() > 50
    assert abs(picture(page) - edited).max() > 50
    assert page.locator(".s2g-names span").all_inner_texts() == ["source", "edited"]


def test_without_webgl_it_says_so(watched, address):
    page = watched.page
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.goto(address)
    page.wait_for_selector("text=This browser offers no WebGL2")
    assert watched.complaints == []
