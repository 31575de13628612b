"""Where films lie, and that every way to keep pictures gives the same ones back."""

import subprocess
import sys

import numpy as np
import pytest
from film_folder import write_pictures
from PIL import Image

from s2glib.data.film_files import find_films, frames_of, read_pictures


@pytest.fixture
def frames():
    """A bright square that walks over stripes, in few colours; (12, 32, 48, 3)."""
    film = np.zeros((12, 32, 48, 3), np.uint8)
    film[:, ::8] = 80
    for t in range(12):
        film[t, 8:24, 2 * t : 2 * t + 16] = (200, 40, 120)
    return film


def save_animation(path, frames, **options):
    first, *others = (Image.fromarray(frame) for frame in frames)
    first.save(path, save_all=True, append_images=others, duration=40, loop=0, **options)


def save_video(path, frames):
    from imageio_ffmpeg import get_ffmpeg_exe

    height, width = frames.shape[1:3]
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", "25", "-i", "-"]
    coded = ["-pix_fmt", "yuv444p", "-c:v", "libx264", "-crf", "1", path]
    subprocess.run([get_ffmpeg_exe(), "-v", "error", *raw, *coded], input=frames.tobytes())


def read(path):
    return np.stack([np.asarray(picture) for picture in read_pictures(path)])


@pytest.mark.parametrize("ending", [".gif", ".webp"])
def test_an_animation_gives_its_pictures_back(tmp_path, frames, ending):
    path = tmp_path / f"film{ending}"
    save_animation(path, frames, **({"lossless": True} if ending == ".webp" else {}))
    np.testing.assert_array_equal(read(path), frames)


def test_a_video_gives_its_pictures_back_but_for_its_coding(tmp_path, frames):
    save_video(tmp_path / "a film: one.mp4", frames)
    film = read(tmp_path / "a film: one.mp4")
    assert film.shape == frames.shape
    assert np.abs(film.astype(int) - frames).mean() < 4


def test_a_video_can_be_left_half_read(tmp_path, frames):
    save_video(tmp_path / "film.mp4", np.repeat(frames, 20, axis=0))
    pictures = read_pictures(tmp_path / "film.mp4")
    assert next(pictures).size == (48, 32)
    pictures.close()


def test_pictures_come_in_the_order_of_their_numbers(tmp_path, frames):
    write_pictures(tmp_path / "frames", frames)
    (tmp_path / "frames" / ".hidden.png").write_text("no picture")
    (tmp_path / "frames" / "notes.txt").write_text("no picture")
    np.testing.assert_array_equal(read(tmp_path / "frames"), frames)


def test_grey_and_indexed_pictures_become_colours(tmp_path, frames):
    grey = Image.fromarray(frames[0]).convert("L")
    grey.save(tmp_path / "0.png")
    grey.convert("P").save(tmp_path / "1.png")
    for picture in read(tmp_path):
        np.testing.assert_array_equal(picture, np.asarray(grey)[..., None].repeat(3, axis=-1))


def test_films_are_sub_folders_and_film_files(tmp_path):
    for name in ("film10", "film9", ".cache"):
        (tmp_path / name).mkdir()
    for name in ("a.MP4", "b.gif", "speech.wav", "README"):
        (tmp_path / name).touch()
    assert [path.name for path in find_films(tmp_path)] == ["a.MP4", "b.gif", "film9", "film10"]


def test_frames_are_a_folder_or_a_file_or_the_film_itself(tmp_path):
    (tmp_path / "one" / "frames").mkdir(parents=True)
    (tmp_path / "two").mkdir()
    (tmp_path / "two" / "frames.webm").touch()
    assert frames_of(tmp_path / "one").name == "frames"
    assert frames_of(tmp_path / "two").name == "frames.webm"
    assert frames_of(tmp_path / "three.mp4").name == "three.mp4"


def test_no_folder_and_no_films_are_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no folder of films at .*nowhere; check the path"):
        find_films(tmp_path / "nowhere")
    (tmp_path / "speech.wav").touch()
    with pytest.raises(ValueError, match=r"holds no film; put in a sub-folder with frames/\*\.png"):
        find_films(tmp_path)


@pytest.mark.parametrize(
    ("names", "got"), [([], "none of them"), (["frames", "frames.gif"], "frames and frames.gif")]
)
def test_no_frames_and_two_kinds_of_frames_are_refused(tmp_path, names, got):
    for name in names:
        (tmp_path / name).touch()
    with pytest.raises(ValueError, match=rf"either a folder frames .* or one file .* got {got}"):
        frames_of(tmp_path)


@pytest.mark.parametrize("name", ["film.mp4", "film.gif", "film.webp", "folder/0.png"])
def test_what_is_no_picture_is_refused(tmp_path, name):
    (tmp_path / "folder").mkdir()
    (tmp_path / name).write_text("a letter")
    with pytest.raises(ValueError, match=r"cannot be read as a .*; export it again"):
        read(tmp_path / name.removesuffix("/0.png"))


def test_a_film_that_is_not_there(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no film at .*none.gif; check the path"):
        read(tmp_path / "none.gif")


def test_a_video_without_the_extra_says_what_to_do(tmp_path, monkeypatch):
    (tmp_path / "film.mp4").touch()
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(ImportError, match=r"film.mp4 needs ffmpeg; install .* s2glib\[video\], or"):
        read(tmp_path / "film.mp4")
