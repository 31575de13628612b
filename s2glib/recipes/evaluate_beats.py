"""How much better than chance the gestures meet the beats of speech, beside real gestures.

Paper:    AM E (BA)
Notebook: notebooks/18_beats.ipynb
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from s2glib.body.skeleton import joint
from s2glib.metrics import BEAT_PRESETS, preset_beats, shuffled_alignment
from s2glib.metrics.beats import ShuffledAlignment
from s2glib.papers.amuse.front_end import MOTION_FPS
from s2glib.papers.amuse.motion_features import SEEN_JOINTS
from s2glib.recipes.report import Row, figure, ratio

_SEED = 11
_ARMS = [place for place, name in enumerate(SEEN_JOINTS) if name.endswith(("er", "ow", "wrist"))]


def beat_rows(
    real: Float[np.ndarray, "n frames 9 3"],
    made: Float[np.ndarray, "n frames 9 3"],
    audio_beats: Sequence[Float[np.ndarray, " _"]],
    kind: str,
    lengths: Int[np.ndarray, " n"] | None = None,
) -> list[Row]:
    """Beat alignment of real motion, and of generated motion once chance is taken away.

    Args:
        real: positions of `SEEN_JOINTS`.
        made: the same for generated motion.
        audio_beats: seconds, one array per clip; those after the motion's end do not count.
        kind: what the audio beats are.
        lengths: frames that the clips truly have; None: all. After them nothing moves.
    """
    frames = real.shape[1]
    ends = (
        np.full(len(real), frames) if lengths is None else lengths.clip(max=frames)
    ) / MOTION_FPS
    heard = [beats[beats < end] for beats, end in zip(audio_beats, ends, strict=True)]
    rows = []
    for way in ("motion to audio", "audio to motion"):
        own, generated = (_alignment(places, heard, ends, way) for places in (real, made))
        name = f"{way}, {kind}"
        rows += [
            figure(f"beat alignment of real motion, {name}", np.nan_to_num(own.scores)),
            figure(f"beat margin of real motion, {name}", np.nan_to_num(own.margins)),
            ratio(
                f"beat margin / real, {name}",
                np.nan_to_num(generated.margins),
                np.nan_to_num(own.margins),
            ),
        ]
    return rows


def _alignment(
    places: np.ndarray, heard: list[np.ndarray], ends: np.ndarray, way: str
) -> ShuffledAlignment:
    """A body without beats has nan, which counts as 0."""
    moved = [preset_beats(_body(clip), MOTION_FPS, preset="amuse")[0] for clip in places]
    first, second = (moved, heard) if way == "motion to audio" else (heard, moved)
    return shuffled_alignment(
        first,
        second,
        durations=ends,
        sigma=BEAT_PRESETS["amuse"].sigma,
        rng=np.random.default_rng(_SEED),
    )


def _body(places: Float[np.ndarray, "frames 9 3"]) -> Float[np.ndarray, "frames 22 3"]:
    """The arms at their places in the SMPL-X skeleton, as the preset wants them."""
    body = np.zeros((len(places), joint("right_wrist") + 1, 3))
    for place in _ARMS:
        body[:, joint(SEEN_JOINTS[place])] = places[:, place]
    return body
