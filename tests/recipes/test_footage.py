"""Films of a reader's own, from files to what the video stages train on."""

import numpy as np
import pytest
import torch
from film_folder import write_film
from small_video import noise_film

from s2glib.corpus import Part, render_motion, render_video
from s2glib.data import read_film
from s2glib.recipes import footage
from s2glib.recipes.footage import HELD_OUT, film_of, own_films, train_and_test
from s2glib.recipes.video_data import Film, VideoFrames, scenes


def write(folder, film, *given):
    """A film of the corpus as the files that one could have made of it."""
    masks = {"hands": film.parts >= Part.LEFT_HAND, "face": film.parts == Part.FACE}
    pixels = (film.keypoints.astype(float) + 1) / 2 * (film.frames.shape[1] - 1)
    layout = masks | {"keypoints": pixels}
    write_film(folder, film.frames, **{name: layout[name] for name in given})


def test_a_film_of_the_corpus_survives_the_way_through_files(tmp_path):
    (scene,) = scenes("test", 1)[:1]
    video = render_video(render_motion(scene.cell), scene.appearance, 32, 5)
    film = Film(video.frames, video.parts, video.keypoints.astype(np.float16))
    write(tmp_path, film, "hands", "face", "keypoints")
    before, after = VideoFrames([film]), VideoFrames([film_of(read_film(tmp_path, 32))])
    rows = np.arange(len(video.frames))
    assert torch.equal(after.frames, before.frames)
    assert torch.equal(after.hands(rows), before.hands(rows))
    assert torch.equal(after.faces(rows), before.faces(rows))
    assert torch.equal(after.keypoints, before.keypoints)
    assert before.hands(rows).any()


def test_what_is_not_given_is_not_known(tmp_path, rng):
    write(tmp_path, noise_film(rng))
    video = VideoFrames([film_of(read_film(tmp_path, 32))])
    assert not video.parts.any()
    assert video.keypoints.isnan().all()
    assert not video.has_keypoints


def test_hands_are_in_front_of_the_face(tmp_path, rng):
    everywhere = np.ones((12, 32, 32), bool)
    write_film(tmp_path, noise_film(rng).frames, hands=everywhere, face=everywhere)
    assert (film_of(read_film(tmp_path, 32)).parts == Part.LEFT_HAND).all()


@pytest.mark.parametrize(("count", "held_out"), [(2, [1]), (7, [6]), (8, [7]), (17, [7, 15])])
def test_every_eighth_film_is_held_out_and_at_least_one(tmp_path, rng, capsys, count, held_out):
    made = [noise_film(rng) for _ in range(count)]
    for number, film in enumerate(made):
        write(tmp_path / f"film{number}", film)
    train, test = own_films(tmp_path, 32)
    kept = [film.frames for k, film in enumerate(made) if k not in held_out]
    np.testing.assert_array_equal(
        [film.frames for film in test], [made[k].frames for k in held_out]
    )
    np.testing.assert_array_equal([film.frames for film in train], kept)
    names = ", ".join(f"film{k}" for k in held_out)
    assert f"Held out of {count} films: {names}\n" in capsys.readouterr().out
    assert HELD_OUT == 8


def test_it_says_what_is_missing_and_what_that_means(tmp_path, rng, capsys):
    write(tmp_path / "a", noise_film(rng), "hands")
    write(tmp_path / "b", noise_film(rng), "face", "hands")
    own_films(tmp_path, 32)
    _, *lines = capsys.readouterr().out.splitlines()
    assert lines == [
        "No face in 1 of them (a first): there refinement gives the face no weight of its own, nor "
        "is it measured.",
        "No keypoints in 2 of them (a first): so whether the model knows where wrists are is not "
        "measured.",
    ]


def test_one_film_is_not_enough(tmp_path, rng):
    write(tmp_path / "alone", noise_film(rng))
    with pytest.raises(ValueError, match="holds one film; put in another, since one is held out"):
        train_and_test(tmp_path, 32)


def test_without_a_folder_the_corpus_is_seen(rng, monkeypatch):
    asked = []
    monkeypatch.setattr(
        footage, "films", lambda shots, size: asked.append(shots) or [noise_film(rng)]
    )
    train_and_test(None, 32)
    assert asked == [scenes("train", footage.TRAIN_CLIPS), scenes("test", footage.TEST_CLIPS)]
