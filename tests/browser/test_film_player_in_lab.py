"""The film player in a real JupyterLab."""

from pathlib import Path

import pytest
from browser.lab import open_browser, open_notebook, run_all_cells, write_notebook
from browser.test_player_in_lab import NOW, REMEMBER_SOUNDS, execute, views, wait_for_time

pytestmark = pytest.mark.browser
CELLS = (
    f"import sys; sys.path.insert(0, {str(Path(__file__).parents[1])!r})\n"
    "from stand_in import tone\n"
    "from stand_in_film import moving_film\n"
    "from s2glib.widgets import FilmPlayer\n"
    "film = moving_film(100)\n"
    "player = FilmPlayer({'driving': film, 'made': film[::-1]}, 25, tone(4), title='Two films')",
    "player",
    "player",
)


@pytest.fixture(scope="module")
def lab(lab_folder, lab_address, tmp_path_factory):
    """A notebook that shows one player twice, all cells run."""
    write_notebook(lab_folder / "film.ipynb", CELLS)
    with open_browser(tmp_path_factory.mktemp("browser")) as watched:
        watched.page.add_init_script(REMEMBER_SOUNDS)
        open_notebook(watched.page, lab_address, "film.ipynb")
        assert run_all_cells(watched.page) == []
        watched.page.wait_for_selector(".s2g-film[data-draws] >> nth=1")
        yield watched


@pytest.fixture
def page(lab):
    """The notebook, at rest at the start of the film."""
    execute(lab.page, "player.pause(); player.seek(0)")
    lab.page.wait_for_function(
        "() => [...document.querySelectorAll('.s2g-film')].every("
        "view => view.dataset.playing === 'false' && view.dataset.frame === '0')"
    )
    return lab.page


def test_both_views_follow_one_sound_and_python_hears_where_they_are(page):
    page.locator(".s2g-play").first.click()
    wait_for_time(page, 0.5)
    page.locator(".s2g-play").nth(1).click()
    page.wait_for_selector(".s2g-player[data-playing=false] >> nth=1")
    assert len(page.evaluate(NOW)) == 1
    first, second = views(page, "frame")
    assert first == second == min(int(page.evaluate(NOW)[0] * 25 + 1e-3), 99)
    page.wait_for_timeout(300)
    execute(page, f"assert player.frame == {int(first)} and not player.playing, player.frame")


def test_a_burst_of_orders_ends_with_the_last_one(page):
    orders = "player.seek(k / 25); player.pause() if k % 2 else player.play()"
    execute(page, f"for k in range(100): {orders}\nplayer.pause(); player.seek(77 / 25)")
    page.wait_for_selector(".s2g-film[data-frame='77'][data-playing=false] >> nth=1")
    page.wait_for_timeout(300)
    assert views(page, "frame") == [77, 77]


def test_keys_step_without_moving_the_notebook(page):
    page.locator(".s2g-film .s2g-screen").first.focus()
    cell = page.evaluate("() => jupyterapp.shell.currentWidget.content.activeCellIndex")
    for key in ("ArrowRight", "ArrowRight", "ArrowLeft"):
        page.keyboard.press(key)
    page.wait_for_selector(".s2g-film[data-frame='1']")
    assert page.evaluate("() => jupyterapp.shell.currentWidget.content.activeCellIndex") == cell


def test_controls_have_names_and_a_visible_focus(page):
    film = page.get_by_role("group", name="Two films").first
    for role, name in (("slider", "Time"), ("combobox", "Speed"), ("button", "Play")):
        assert film.get_by_role(role, name=name).count() == 1
    page.locator(".s2g-film .s2g-play").first.focus()
    page.keyboard.press("Tab")
    outline = page.evaluate("() => getComputedStyle(document.activeElement).outlineWidth")
    assert float(outline.removesuffix("px")) >= 2


def test_nothing_was_complained_of_and_nobody_outside_was_asked(lab):
    assert (lab.complaints, lab.outside) == ([], [])
