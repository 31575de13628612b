import base64
import io
import json
import re

import matplotlib
import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure
from PIL import Image
from stand_in import tone
from stand_in_film import moving_film

from s2glib.widgets import FilmPlayer, write_film_page
from s2glib.widgets.film_packing import pack_films

matplotlib.use("Agg")
FILM, SMALL = moving_film(20, 48, 64), moving_film(15, 32, 32)
SILENT = FilmPlayer(FILM, 25)


def frames_of(packed, name):
    """A film found on its sheets, the way film_player.js does."""
    film = packed.film
    ends = np.cumsum(film["lengths"])
    pieces = np.split(np.frombuffer(packed.sheets, np.uint8), ends[:-1])
    sheets = [np.asarray(Image.open(io.BytesIO(piece.tobytes()))) for piece in pieces]
    (place,) = (place for place in film["films"] if place["name"] == name)
    found = []
    for frame in range(film["frames"]):
        sheet, spot = divmod(frame, film["columns"] * film["rows"])
        row, column = divmod(spot, film["columns"])
        left = column * film["size"][0] + place["left"]
        top = row * film["size"][1]
        found.append(sheets[sheet][top:, left:][: place["height"], : place["width"]])
    return np.stack(found).astype(float)


@pytest.mark.parametrize("side", [4096, 128, 96])
def test_every_frame_is_found_on_its_sheet(monkeypatch, side):
    monkeypatch.setattr("s2glib.widgets.film_packing.SIDE", side)
    packed = pack_films({"a": FILM, "b": SMALL}, 25)
    first, second = (frames_of(packed, name) for name in "ab")
    assert np.abs(first - FILM).mean() < 2
    assert np.abs(second[:15] - SMALL).mean() < 2
    assert np.abs(second[15:] - SMALL[-1]).mean() < 2
    assert sum(packed.film["lengths"]) == len(packed.sheets)


@settings(max_examples=20)
@given(st.integers(1, 40), st.integers(1, 20), st.integers(1, 20))
def test_any_size_and_length_will_do(frames, height, width):
    film = moving_film(frames, height, width)
    assert frames_of(pack_films({"": film}, 25), "").shape == film.shape


def test_a_thousand_small_frames_stay_below_three_megabytes():
    packed = pack_films({"": moving_film(1000, 64, 64)}, 25)
    assert len(packed.sheets) < 3e6
    assert len(packed.film["lengths"]) == 1


@pytest.mark.parametrize("side", ["height", "width"])
def test_a_film_too_large_for_a_browser_is_refused(side):
    film = np.zeros((1, *((5000, 1) if side == "height" else (1, 5000)), 3), np.uint8)
    with pytest.raises(ValueError, match="more than a browser holds"):
        FilmPlayer(film, 25)


def test_a_film_too_long_for_a_browser_is_refused():
    film = np.broadcast_to(np.zeros(3, np.uint8), (130_000, 32, 33, 3))
    with pytest.raises(ValueError, match="130000 frames of 33 x 32"):
        pack_films({"": film}, 25)


@given(st.lists(st.integers(-100, 100), min_size=1, max_size=20))
def test_a_burst_of_frames_ends_inside_the_film(frames):
    for frame in frames:
        SILENT.seek(frame / 25)
    assert SILENT.frame == min(max(frames[-1], 0), 19)
    assert SILENT.time == SILENT.frame / 25


def test_what_the_page_says_is_heard():
    player = FilmPlayer(FILM, 25, tone(1))
    player.play()
    player.heard = {"frame": (0, 7), "playing": (1, False)}
    assert (player.frame, player.playing) == (7, False)


def test_floats_and_tensors_will_do():
    floats = torch.from_numpy(FILM / 255).permute(0, 3, 1, 2)
    assert FilmPlayer(floats, 25).sheets == FilmPlayer(FILM, 25).sheets == SILENT.sheets


def test_the_sound_lasts_as_long_as_the_longest_film():
    import soundfile

    player = FilmPlayer({"a": FILM, "b": SMALL}, 25, tone(0.5))
    samples, rate = soundfile.read(io.BytesIO(player.sound))
    assert len(samples) / rate == 20 / 25
    assert SILENT.sound == b""


def test_drawn_it_shows_moments_from_first_to_last():
    axes = Figure().add_subplot()
    assert FilmPlayer({"a": FILM, "b": SMALL}, 25).draw(axes) is axes
    strip = np.asarray(axes.images[0].get_array())
    assert np.array_equal(strip[:, :64], FILM[0])
    assert np.array_equal(strip[:, -64:], FILM[-1])
    assert [label.get_text() for label in axes.get_yticklabels()] == ["a", "b"]


def test_a_film_of_one_frame_is_drawn_once():
    axes = FilmPlayer(FILM[:1], 25).draw(Figure().add_subplot())
    assert np.array_equal(np.asarray(axes.images[0].get_array()), FILM[0])


def test_its_words_never_change():
    assert repr(SILENT) == repr(FilmPlayer({"a": SMALL}, 30, tone(1)))
    assert len(repr(SILENT)) < 110


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("arguments", "error", "fault"),
    [
        (({}, 25), ValueError, "there is no film"),
        (("film.mp4", 25), TypeError, "must be bytes"),
        (({"a": FILM, "b": FILM[:0]}, 25), ValueError, "at least one"),
        ((FILM, 0), ValueError, "fps must be"),
        ((FILM, 25, "sound.wav"), TypeError, "waveform must be a Waveform"),
    ],
)
def test_what_it_cannot_play_is_refused(arguments, error, fault):
    with pytest.raises(error, match=fault):
        FilmPlayer(*arguments)


@pytest.fixture
def write(tmp_path):
    def write_page(**options):
        films, path = {"a": FILM, "b": SMALL}, tmp_path / "film.html"
        write_film_page(path, films, 25, tone(1), **{"title": "A title", **options})
        return path.read_text()

    return write_page


def test_the_page_holds_what_the_widget_sends_and_runs_its_script(write):
    page = write(width=200)
    player = FilmPlayer({"a": FILM, "b": SMALL}, 25, tone(1))
    content = json.loads(re.search(r'id="content">(.*?)</script>', page, re.DOTALL)[1])
    sent = json.loads(json.dumps(player.film))
    assert (content["film"], content["width"]) == (sent, 200)
    for name in ("sheets", "sound"):
        assert base64.b64decode(content[name]) == getattr(player, name)
    assert FilmPlayer._esm in page


def test_the_page_names_no_other_place_and_its_words_are_no_markup(write, tmp_path):
    page = write(title="<b>x</b>", text="</script><script>alert(1)</script>")
    assert not re.search(r"https?://|src=|@import|url\(", page)
    assert "<b>x" not in page
    assert "alert(1)</script>" not in page
    assert [path.name for path in tmp_path.iterdir()] == ["film.html"]


def test_a_page_of_no_film_is_refused_before_anything_is_written(tmp_path):
    with pytest.raises(ValueError, match="there is no film"):
        write_film_page(tmp_path / "film.html", {}, 25, title="Nothing")
    assert not list(tmp_path.iterdir())
