"""A film in the book: kept in a notebook, opened from the disk."""

import nbformat
import pytest
from browser.test_player_in_lab import NOW, REMEMBER_SOUNDS, views, wait_for_time
from ipywidgets.embed import dependency_state
from stand_in import tone
from stand_in_film import moving_film

from s2glib.teaching.book import write_book
from s2glib.teaching.keeping import WIDGET_STATE, WIDGET_VIEW, keep_players
from s2glib.widgets import FilmPlayer

pytestmark = pytest.mark.browser


@pytest.fixture
def address(tmp_path):
    """A book of one notebook, which showed a film and kept it."""
    player = FilmPlayer(moving_film(50), 25, tone(2))
    shown = nbformat.v4.new_output("display_data", {WIDGET_VIEW: {"model_id": player.model_id}})
    cells = [
        nbformat.v4.new_markdown_cell("# Films: do they play?"),
        nbformat.v4.new_code_cell("player", outputs=[shown]),
    ]
    state = dependency_state([player], drop_defaults=False)
    header = {"id": "04", "minutes": 1, "papers": {}}
    notebook = nbformat.v4.new_notebook(cells=cells, metadata={"s2g": header})
    notebook.metadata.widgets = {WIDGET_STATE: {"state": state}}
    keep_players(notebook)
    del notebook.metadata["widgets"]
    nbformat.write(notebook, tmp_path / "04_films.ipynb")
    book = write_book([tmp_path / "04_films.ipynb"], tmp_path / "book")
    return book.with_name("04_films.html").as_uri()


def test_a_film_plays_to_its_sound_in_the_book(watched, address, tmp_path):
    page = watched.page
    page.context.set_offline(True)
    page.add_init_script(REMEMBER_SOUNDS)
    page.goto(address)
    page.locator(".place").scroll_into_view_if_needed()
    page.wait_for_selector(".s2g-film[data-draws]")
    page.get_by_role("button", name="Play").click()
    wait_for_time(page, 0.5)
    assert views(page, "frame")[0] >= 12
    assert page.evaluate(NOW)[0] > 0.4
    page.screenshot(path=tmp_path / "book.png")
    assert (watched.complaints, watched.outside) == ([], [])
