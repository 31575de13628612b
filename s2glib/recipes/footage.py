"""Which films the video stages see: clips of the corpus, or a reader's own.

Paper:    MDD 4.1 (films of four speakers, some held out)
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from pathlib import Path

import numpy as np
from tqdm import tqdm

from s2glib.corpus import KEYPOINT_NAMES, Part
from s2glib.data import Footage, find_films, read_film
from s2glib.recipes.video_data import TEST_CLIPS, TRAIN_CLIPS, Film, VideoFrames, films, scenes

HELD_OUT = 8  # of a reader's own films every 8th is for the test, or the last of fewer
WITHOUT = {
    "hands": "there refinement gives hands no weight of their own, nor are they measured",
    "face": "there refinement gives the face no weight of its own, nor is it measured",
    "keypoints": "so whether the model knows where wrists are is not measured",
}


def train_and_test(data: Path | None, size: int) -> tuple[VideoFrames, VideoFrames]:
    """Films to train on, and others to be measured with: of the corpus, or of a folder.

    Args:
        data: the folder, laid out as `s2glib.data.films` says; None: the corpus.
        size: height and width in pixels.

    Raises:
        FileNotFoundError: if there is no such folder.
        ValueError: if it holds fewer than two films, or one that `read_film` refuses.
    """
    if data is None:
        shots = scenes("train", TRAIN_CLIPS), scenes("test", TEST_CLIPS)
        train, test = (films(some, size) for some in shots)
    else:
        train, test = own_films(data, size)
    return VideoFrames(train), VideoFrames(test)


def own_films(folder: Path, size: int) -> tuple[list[Film], list[Film]]:
    """The films of a folder, and those of them that are held out; says what was not given."""
    paths = find_films(folder)
    if len(paths) < 2:
        raise ValueError(f"{folder} holds one film; put in another, since one is held out")
    footage = [
        read_film(path, size)
        for path in tqdm(paths, desc=f"reading films at {size} pixels", unit="film")
    ]
    rows = range(len(paths))
    held_out = rows[HELD_OUT - 1 :: HELD_OUT] or rows[-1:]
    print(f"Held out of {len(paths)} films:", ", ".join(paths[k].name for k in held_out))
    for what, so in WITHOUT.items():
        lacking = [paths[k].name for k in rows if getattr(footage[k], what) is None]
        if lacking:
            print(f"No {what} in {len(lacking)} of them ({lacking[0]} first): {so}.")
    train = [film_of(footage[k]) for k in rows if k not in held_out]
    return train, [film_of(footage[k]) for k in held_out]


def film_of(footage: Footage) -> Film:
    """A film as the corpus has them; hands, whose side is unknown, count as left ones.

    Where hand and face overlap, as boxes may, the hand counts.
    """
    parts = np.zeros(footage.frames.shape[:3], np.uint8)
    for part, mask in ((Part.FACE, footage.face), (Part.LEFT_HAND, footage.hands)):
        if mask is not None:
            parts[mask] = part
    keypoints = np.full((len(parts), len(KEYPOINT_NAMES), 2), np.nan, np.float16)
    if footage.keypoints is not None:
        keypoints[:] = footage.keypoints
    return Film(footage.frames, parts, keypoints)
