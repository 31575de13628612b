"""Films of one's own: every layout gives exact pictures, masks and keypoints."""

import numpy as np
import pytest
from film_folder import write_film, write_pictures
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from s2glib.corpus import appearances, parse_id, render_motion, render_video
from s2glib.data import Footage, read_film
from s2glib.data.films import View

T = 12


@pytest.fixture
def rng():
    return np.random.default_rng(0)


@pytest.fixture
def frames(rng):
    """Pictures 32 wide and 20 high, of 2 x 2 pixels of one colour."""
    small = rng.integers(256, size=(T, 10, 16, 3)).astype(np.uint8)
    return small.repeat(2, axis=1).repeat(2, axis=2)


@pytest.fixture
def masks(rng):
    return rng.random((T, 20, 32)) < 0.3


def test_only_frames_must_be_there(tmp_path, frames):
    write_film(tmp_path, frames)
    film = read_film(tmp_path, 10)
    assert film[1:] == (None, None, None)
    np.testing.assert_array_equal(film.frames, frames[:, ::2, 6:26:2])  # the middle square


def test_a_film_is_a_file_or_has_its_frames_in_one(tmp_path, frames):
    pictures = [Image.fromarray(frame) for frame in frames]
    (tmp_path / "film").mkdir()
    for path in (tmp_path / "film.webp", tmp_path / "film" / "frames.webp"):
        pictures[0].save(path, save_all=True, append_images=pictures[1:], lossless=True)
    np.save(tmp_path / "film" / "hands.npy", np.full((T, 1, 4), 5.0))
    alone, inside = read_film(tmp_path / "film.webp", 10), read_film(tmp_path / "film", 10)
    assert alone[1:] == (None, None, None)
    np.testing.assert_array_equal(alone.frames, frames[:, ::2, 6:26:2])
    np.testing.assert_array_equal(inside.frames, alone.frames)
    assert inside.hands is not None


def test_masks_are_the_nearest_pixels_of_their_pictures(tmp_path, frames, masks):
    write_film(tmp_path, frames, hands=masks, face=~masks)
    film = read_film(tmp_path, 10)
    np.testing.assert_array_equal(film.hands, masks[:, 1::2, 7:26:2])
    np.testing.assert_array_equal(film.face, ~masks[:, 1::2, 7:26:2])


@pytest.mark.parametrize("colour", [(1, 1, 1), (255, 255, 255), (0, 0, 90)])
def test_a_mask_is_what_is_not_black(colour):
    mask = np.zeros((4, 4, 3), np.uint8)
    mask[1, 2] = colour
    picked = View(4, 4, 4).pick(Image.fromarray(mask))
    assert np.argwhere(picked).tolist() == [[1, 2]]


def test_boxes_cover_the_pixels_whose_middle_is_inside(tmp_path, frames):
    boxes = np.full((T, 2, 4), np.nan)
    boxes[0, 0], boxes[1] = (6, 0, 7, 1), ((9, 3, 11, 3), (24.5, 18.9, 99, 20))
    write_film(tmp_path, frames, hands=boxes)
    film = read_film(tmp_path, 10)
    where = [(0, 0, 0), (1, 1, 1), (1, 1, 2), (1, 9, 9)]
    assert [tuple(place) for place in np.argwhere(film.hands).tolist()] == where
    assert film.face is None


CORNER = st.floats(-9, 40)


@given(st.tuples(CORNER, CORNER, CORNER, CORNER), st.integers(8, 30), st.integers(8, 30), st.data())
def test_a_box_and_a_picture_of_it_give_the_same_mask(corners, width, height, data):
    view = View(width, height, data.draw(st.integers(2, min(width, height))))
    x0, y0, x1, y1 = corners
    row, column = np.mgrid[:height, :width]
    inside = (x0 <= column) & (column <= x1) & (y0 <= row) & (row <= y1)
    picture = Image.fromarray(inside).convert("RGB")
    np.testing.assert_array_equal(view.fill(np.array([[corners]]))[0], view.pick(picture))


def test_keypoints_are_where_the_renderer_has_them_at_the_smaller_size():
    cell = parse_id("s04-voice_01-anger-t2")
    motion, look = render_motion(cell), appearances(cell.speaker)[0]
    large, small = (render_video(motion, look, size, 1) for size in (144, 48))
    pixels = (large.keypoints.astype(float) + 1) / 2 * 143
    assert View(144, 144, 48).place(pixels) == pytest.approx(small.keypoints, abs=1e-5)
    assert View(200, 144, 48).place(pixels + [28, 0]) == pytest.approx(small.keypoints, abs=1e-5)


def test_keypoints_are_aligned_as_the_paper_says_and_give_the_masks(tmp_path, frames, rng):
    points = rng.uniform(2, 18, (T, 55, 2)) + [6, 0]
    points[3, 13:34] = np.nan
    points[4] = np.nan
    write_film(tmp_path, frames, keypoints=points)
    film = read_film(tmp_path, 10)
    view = View(32, 20, 10)
    np.testing.assert_allclose(film.keypoints[0, :13], view.place(points[0, :13]), atol=1e-6)
    np.testing.assert_array_equal(film.keypoints[:, 13], film.keypoints[:, 9])  # hand and wrist
    assert (film.keypoints[3, 13:34] == film.keypoints[3, 9]).all()
    assert (film.keypoints[4] == 0).all()
    assert film.hands.any(axis=(1, 2)).tolist() == film.face.any(axis=(1, 2)).tolist()
    assert np.flatnonzero(~film.hands.any(axis=(1, 2))).tolist() == [4]


def test_masks_that_are_given_count_more_than_keypoints(tmp_path, frames, masks, rng):
    points = rng.uniform(2, 18, (T, 133, 3))
    face = np.full((T, 1, 4), np.nan)
    write_film(tmp_path, frames, hands=masks, face=face, keypoints=points)
    film = read_film(tmp_path, 10)
    np.testing.assert_array_equal(film.hands, masks[:, 1::2, 7:26:2])
    assert not film.face.any()


def fewer(frames, masks):
    return {"frames": frames, "hands": masks[:-1]}


def of_another_size(frames, masks):
    return {"frames": frames, "face": masks[:, :, :-1]}


def short(frames, masks):
    return {"frames": frames[:9]}


def still(frames, masks):
    return {"frames": frames[:1].repeat(T, axis=0)}


def wrong_rows(frames, masks):
    return {"frames": frames, "hands": np.full((T + 1, 1, 4), 5)}


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (fewer, r"hands: expected 12 masks \(.png\), one for each frame, got 11; put in a black"),
        (of_another_size, "face: expected pictures of 32 x 20 pixels, .* got 31 x 20 at number 0"),
        (short, "frames: expected 10 pictures or more, got 9; give a longer film"),
        (still, "frames: nothing moves in this film; leave it out"),
        (wrong_rows, r"hands.npy: expected \(t, n, 4\) with t = 12, .* got \(13, 1, 4\)"),
    ],
)
def test_films_that_do_not_fit_are_refused(tmp_path, frames, masks, make, reason):
    write_film(tmp_path, **make(frames, masks))
    with pytest.raises(ValueError, match=reason):
        read_film(tmp_path, 10)


def test_frames_of_several_sizes_are_refused(tmp_path, frames):
    write_film(tmp_path, frames)
    Image.fromarray(frames[5, 1:]).save(tmp_path / "frames" / "5.png")
    with pytest.raises(
        ValueError, match=r"of 32 x 20 pixels, .* got 32 x 19 at number 5; make the"
    ):
        read_film(tmp_path, 10)


def test_pictures_smaller_than_the_stage_are_refused(tmp_path, frames):
    write_film(tmp_path, frames)
    with pytest.raises(
        ValueError, match="pictures of 21 x 21 pixels or more, got 32 x 20; give la"
    ):
        read_film(tmp_path, 21)


def test_an_empty_folder_of_frames_is_refused(tmp_path):
    (tmp_path / "frames").mkdir()
    with pytest.raises(ValueError, match="frames: expected 10 pictures or more, got 0"):
        read_film(tmp_path, 10)


def test_two_answers_to_one_question_are_refused(tmp_path, frames, masks):
    write_film(tmp_path, frames, hands=np.full((T, 1, 4), 5))
    write_pictures(tmp_path / "hands", masks)
    with pytest.raises(ValueError, match=r"hands.npy say the same thing twice; remove one of them"):
        read_film(tmp_path, 10)


def test_what_a_reader_meets_without_type_checks(tmp_path, frames, without_type_hook):
    write_film(tmp_path / "film", frames)
    assert isinstance(read_film(str(tmp_path / "film"), 10), Footage)
    with pytest.raises(FileNotFoundError, match=r"no film at .*; check the path"):
        read_film(tmp_path / "none", 10)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("size", [0, -64, 7, 64.0, "64", None])
def test_a_size_that_is_none_is_refused(tmp_path, size):
    with pytest.raises(ValueError, match="size must be a whole number of pixels, 8 or more"):
        read_film(tmp_path, size)
