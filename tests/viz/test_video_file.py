"""Video files, read back by ffmpeg and Pillow."""

import re
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from stand_in import tone
from stand_in_film import moving_film

from s2glib.viz import write_video
from s2glib.viz.video_file import _durations

FILM = moving_film(25, 128, 160)


def ffmpeg(*arguments):
    from imageio_ffmpeg import get_ffmpeg_exe

    return subprocess.run([get_ffmpeg_exe(), *arguments], capture_output=True, check=False)


def pictures_of(path, height, width):
    raw = ffmpeg("-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "rgb24", "-").stdout
    return np.frombuffer(raw, np.uint8).reshape(-1, height, width, 3).astype(float)


def sound_of(path):
    raw = ffmpeg("-v", "error", "-i", path, "-vn", "-ac", "1", "-f", "f32le", "-").stdout
    return np.frombuffer(raw, np.float32)


def facts_of(path):
    return ffmpeg("-i", path).stderr.decode()


def pillow(path):
    """Frames and milliseconds of a GIF or WebP."""
    frames, times = [], []
    with Image.open(path) as file:
        for frame in range(file.n_frames):
            file.seek(frame)
            frames.append(np.asarray(file.convert("RGB")).astype(float))
            times.append(file.info["duration"])
    return np.stack(frames), times


@pytest.fixture(scope="module")
def spoken(tmp_path_factory):
    """A second of film with a tone that is longer than it."""
    path = tmp_path_factory.mktemp("film") / "spoken.mp4"
    write_video(path, FILM, 25, tone(3))
    return path


def test_an_mp4_has_every_frame_in_its_place(spoken):
    found = pictures_of(spoken, 256, 320)
    small = found.reshape(25, 128, 2, 160, 2, 3).mean(axis=(2, 4))
    assert np.abs(small - FILM).mean() < 3
    error = np.abs(small[:, None] - FILM).mean(axis=(2, 3, 4))
    assert error.argmin(axis=1).tolist() == list(range(25))


def test_an_mp4_is_what_players_play(spoken):
    facts = facts_of(spoken)
    assert re.search(r"Video: h264 .*yuv420p\(tv, bt709.* 320x256, .* 25 fps", facts)
    assert re.search(r"Audio: aac .* 16000 Hz, mono", facts)
    assert spoken.read_bytes().index(b"moov") < spoken.read_bytes().index(b"mdat")


def test_an_mp4_lasts_as_long_as_its_pictures(spoken):
    assert "Duration: 00:00:01.00" in facts_of(spoken)
    assert len(sound_of(spoken)) == 16000


def test_the_sound_is_in_its_place(spoken):
    heard, said = sound_of(spoken), tone(1).samples
    assert np.corrcoef(heard, said)[0, 1] > 0.99


def test_after_a_shorter_sound_it_is_silent(tmp_path):
    write_video(tmp_path / "film.mp4", FILM, 25, tone(0.6))
    heard = sound_of(tmp_path / "film.mp4")
    assert len(heard) == 16000
    assert np.abs(heard[2000:8000]).max() > 0.05
    assert np.abs(heard[12000:]).max() < 1e-3


def test_without_a_waveform_there_is_no_sound(tmp_path):
    write_video(tmp_path / "film.mp4", FILM, 25)
    assert "Audio" not in facts_of(tmp_path / "film.mp4")


@pytest.mark.parametrize("rate", [Fraction(30000, 1001), Fraction(25, 2)])
def test_a_rate_that_is_no_whole_number_is_kept(tmp_path, rate):
    write_video(tmp_path / "film.mp4", FILM, float(rate))
    seconds = float(re.search(r"Duration: 00:00:(\S+),", facts_of(tmp_path / "film.mp4"))[1])
    assert seconds == pytest.approx(25 / rate, abs=0.006)  # ffmpeg prints hundredths


@pytest.mark.parametrize(
    ("height", "width", "size"), [(257, 301, (258, 302)), (33, 65, (264, 520)), (1, 1, (256, 256))]
)
def test_an_odd_or_small_picture_becomes_an_even_and_large_one(tmp_path, height, width, size):
    film = moving_film(2, height, width)
    write_video(tmp_path / "film.mp4", film, 25)
    found = pictures_of(tmp_path / "film.mp4", *size)
    assert len(found) == 2
    assert np.abs(found.mean(axis=(1, 2)) - film.mean(axis=(1, 2))).max() < 4


def test_values_from_zero_to_one_are_the_same_film(tmp_path):
    write_video(tmp_path / "bytes.webp", FILM, 25)
    write_video(tmp_path / "floats.webp", torch.from_numpy(FILM / 255).permute(0, 3, 1, 2), 25)
    first, second = ((tmp_path / f"{name}.webp").read_bytes() for name in ("bytes", "floats"))
    assert first == second


def test_a_webp_keeps_every_pixel_and_its_time(tmp_path):
    write_video(tmp_path / "film.webp", FILM, 30)
    frames, times = pillow(tmp_path / "film.webp")
    assert np.array_equal(frames, FILM)
    assert sum(times) == 833
    assert set(times) <= {33, 34}


def test_a_gif_keeps_its_colours_and_time_nearly(tmp_path):
    write_video(tmp_path / "film.gif", FILM, 30)
    frames, times = pillow(tmp_path / "film.gif")
    assert np.abs(frames - FILM).mean() < 4
    assert sum(times) == 830
    assert set(times) <= {30, 40}


@pytest.mark.parametrize("name", ["film.gif", "film.webp"])
def test_what_stands_still_lasts_as_long(tmp_path, name):
    still = np.repeat(FILM[:1], 10, axis=0)
    write_video(tmp_path / name, np.concatenate([still, FILM[-1:]]), 10)
    _, times = pillow(tmp_path / name)
    assert sum(times) == 1100


@given(st.integers(1, 500), st.floats(1, 120), st.sampled_from([1, 10]))
def test_no_frame_begins_off_by_more_than_half_a_step(frames, fps, step):
    ends = np.cumsum(_durations(frames, fps, step))
    assert np.abs(ends - 1000 * np.arange(1, frames + 1) / fps).max() <= step / 2 + 1e-6


@pytest.mark.parametrize("name", ["film.mp4", "film.gif", "film.webp", "FILM.MP4"])
def test_a_single_frame_is_a_film_and_nothing_else_is_left_in_the_folder(tmp_path, name):
    write_video(tmp_path / "new" / name, FILM[:1], 25)
    assert [path.name for path in (tmp_path / "new").iterdir()] == [name]
    assert (tmp_path / "new" / name).stat().st_size > 100


def refuse(path, error, fault, *arguments):
    with pytest.raises(error, match=fault):
        write_video(path, *arguments)
    assert not list(path.parent.iterdir())


@pytest.mark.parametrize("suffix", [".gif", ".webp"])
def test_a_silent_format_refuses_a_sound_and_names_those_that_have_it(tmp_path, suffix):
    fault = "has no sound; .mp4 and the page"
    refuse(tmp_path / f"film{suffix}", ValueError, fault, FILM, 25, tone(1))


@pytest.mark.parametrize("name", ["film", "film.avi", "film.html"])
def test_another_ending_is_refused(tmp_path, name):
    refuse(tmp_path / name, ValueError, "written as .mp4, .webp or .gif", FILM, 25)


def test_a_gif_that_browsers_would_slow_down_is_refused(tmp_path):
    refuse(tmp_path / "film.gif", ValueError, "from 1 to 50 here", FILM, 60)


@pytest.mark.parametrize("name", ["film.mp4", "film.gif", "film.webp"])
def test_a_film_of_nothing_is_refused(tmp_path, name):
    refuse(tmp_path / name, ValueError, "at least one", FILM[:0], 25)


@pytest.mark.usefixtures("without_type_hook")
def test_a_sound_without_a_rate_is_refused(tmp_path):
    refuse(tmp_path / "film.mp4", TypeError, "must be a Waveform", FILM, 25, tone(1).samples)


def test_without_the_extra_it_says_how_to_install_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    refuse(tmp_path / "film.mp4", ImportError, r"pip install s2glib\[video\].*without", FILM, 25)
    write_video(tmp_path / "film.gif", FILM[:2], 25)


def test_when_ffmpeg_fails_the_older_film_stays(tmp_path, monkeypatch):
    (tmp_path / "film.mp4").write_text("older")
    monkeypatch.setattr("imageio_ffmpeg.get_ffmpeg_exe", lambda: sys.executable)
    with pytest.raises(OSError, match="ffmpeg could not write"):
        write_video(tmp_path / "film.mp4", FILM, 25)
    assert (tmp_path / "film.mp4").read_text() == "older"
    assert len(list(tmp_path.iterdir())) == 1
