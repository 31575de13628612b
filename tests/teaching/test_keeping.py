"""Players in a built notebook: what they play outlives the kernel."""

import base64
import io

import ipywidgets
import nbformat
import numpy as np
import pytest
import soundfile
from ipywidgets.embed import dependency_state
from PIL import Image
from stand_in import capsule_body, tone, waving_motion
from stand_in_film import moving_film

from s2glib.body import mannequin
from s2glib.teaching.keeping import KEPT, WIDGET_STATE, WIDGET_VIEW, content_of, keep_players
from s2glib.widgets import FilmPlayer, Player

MOTION, SOUND = waving_motion(30), tone(1)


def keep(*widgets):
    """The metadata of the outputs of a notebook that showed these widgets."""
    views = [{"text/plain": "", WIDGET_VIEW: {"model_id": each.model_id}} for each in widgets]
    outputs = [nbformat.v4.new_output("display_data", view) for view in views]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(outputs=outputs)])
    states = dependency_state(widgets, drop_defaults=False)
    notebook.metadata.widgets = {WIDGET_STATE: {"state": states}}
    keep_players(notebook)
    nbformat.validate(notebook)
    return [output.metadata for output in outputs]


@pytest.fixture(scope="module")
def player():
    return Player({"source": MOTION, "edited": MOTION}, SOUND, mannequin(), height=300)


@pytest.fixture(scope="module")
def content(player):
    (metadata,) = keep(player)
    return content_of(metadata[KEPT])


def test_the_motion_stays_as_it_is(content, player):
    assert base64.b64decode(content["motion"]) == player.motion
    assert (content["height"], content["view"]) == (300, "")


def test_the_sound_stays_in_its_place(content):
    samples, rate = soundfile.read(io.BytesIO(base64.b64decode(content["sound"])))
    assert (rate, len(samples)) == (SOUND.sample_rate, len(SOUND.samples))
    assert np.corrcoef(samples, SOUND.samples)[0, 1] > 0.99


def test_keeping_repeats_to_the_byte(player):
    assert keep(player) == keep(player)


def test_a_player_inside_a_demo_is_kept(player):
    inside = ipywidgets.VBox([ipywidgets.HTML("words"), ipywidgets.HBox([player])])
    assert keep(inside) == keep(player)


def test_silence_stays_silence():
    (metadata,) = keep(Player(MOTION, None, mannequin()))
    assert content_of(metadata[KEPT])["sound"] == ""


@pytest.fixture(scope="module")
def film_player():
    films = {"a": moving_film(30, 64, 64), "b": moving_film(30, 64, 64)[::-1]}
    return FilmPlayer(films, 25, SOUND, width=200, title="Two films")


def test_a_film_is_kept_smaller_and_looks_the_same(film_player):
    (metadata,) = keep(film_player)
    kept = content_of(metadata[KEPT])
    assert (kept["width"], kept["title"]) == (200, "Two films")
    assert kept["film"]["films"] == film_player.film["films"]
    sheets = base64.b64decode(kept["sheets"])
    assert kept["film"]["lengths"] == [len(sheets)]
    assert len(sheets) < 0.5 * len(film_player.sheets)
    small, sent = (
        np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), float)
        for data in (sheets, film_player.sheets)
    )
    assert np.abs(small - sent).mean() < 4


def test_a_film_keeps_its_sound_and_keeping_it_repeats_to_the_byte(film_player):
    (metadata,) = keep(film_player)
    assert keep(film_player) == [metadata]
    kept = base64.b64decode(content_of(metadata[KEPT])["sound"])
    samples, rate = soundfile.read(io.BytesIO(kept))
    assert len(samples) / rate == 30 / 25


def test_other_widgets_and_other_bodies_leave_no_trace():
    assert keep(ipywidgets.IntSlider(7), Player(MOTION, SOUND, capsule_body())) == [{}, {}]
