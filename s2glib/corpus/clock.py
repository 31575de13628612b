"""The phoneme clock: one timing for a (sentence, emotion, take), shared by every speaker.

All variants of one espeak-ng language speak the same phonemes, so their mean durations are a
canonical reading. Emotion and take bend it; the speaker does not. That is what makes clips of
different speakers correspond frame by frame.

Paper:    AM F ("perfect temporal correspondence between the audios of the same sentences")
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import json
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from s2glib.corpus.script import PROSODY, SENTENCES
from s2glib.folders import data_folder

LEAD_IN = 0.35  # seconds of silence before the first phoneme
TAIL = 0.25  # seconds of silence after the last
SEED = 20240617
PRIMARY_STRESS = "ˈ"
_PHONEME_JITTER, _TEMPO_JITTER = 0.06, 0.03  # standard deviations of log durations


class Reading(NamedTuple):
    """The canonical reading of one sentence: phonemes, their mean durations, words' places."""

    phonemes: tuple[str, ...]  # IPA, "" for a pause
    durations: Float[np.ndarray, " n"]  # seconds
    word_places: tuple[int, ...]  # index of each word's first phoneme


class Timing(NamedTuple):
    """When everything happens in one clip (seconds from its start)."""

    phonemes: tuple[str, ...]
    boundaries: Float[np.ndarray, " bounds"]
    stressed: Bool[np.ndarray, " n"]
    words: tuple[str, ...]
    word_starts: Float[np.ndarray, " w"]
    word_ends: Float[np.ndarray, " w"]

    @property
    def duration(self) -> float:
        """Length of the clip in seconds, from the start of the lead-in to the end of the tail."""
        return float(self.boundaries[-1]) + TAIL

    @property
    def stress_times(self) -> Float[np.ndarray, " s"]:
        """Starts of the stressed vowels: the beats that gestures keep."""
        return self.boundaries[:-1][self.stressed]


@cache
def readings(path: Path | None = None) -> tuple[Reading, ...]:
    """The canonical readings of all sentences, from the shipped clock.

    Raises:
        FileNotFoundError: if the data folder has no `clock.json`.
    """
    path = path or data_folder() / "clock.json"
    entries = json.loads(path.read_text(encoding="utf8"))
    return tuple(
        Reading(tuple(e["phonemes"]), np.array(e["durations"]), tuple(e["word_places"]))
        for e in entries
    )


def word_places(
    words: tuple[str, ...],
    spoken: tuple[tuple[str, float], ...],
    starts: Float[np.ndarray, " n"],
) -> tuple[int, ...]:
    """The first phoneme of every word of the script.

    espeak-ng joins some short words ("do not") into one; their phonemes are shared out by the
    number of letters.

    Args:
        words: the line's words.
        spoken: the words that espeak-ng reports, with their starts in seconds.
        starts: starts of the phonemes in seconds.
    """
    heads: list[tuple[int, int]] = []
    at = 0
    for name, start in spoken:
        at = words.index(name, at)
        heads.append((at, int(np.searchsorted(starts, start - 1e-3))))
        at += 1
    places: list[int] = []
    for (word, place), (next_word, next_place) in pairwise([*heads, (len(words), len(starts))]):
        letters = np.cumsum([0] + [len(w) for w in words[word:next_word]])
        shares = letters[:-1] / letters[-1] * (next_place - place)
        places += [place + round(share) for share in shares]
    return tuple(places)


def timing(reading: Reading, sentence: int, emotion: str, take: int) -> Timing:
    """Bend a canonical reading by an emotion's tempo and a take's jitter."""
    prosody = PROSODY[emotion]
    rng = np.random.default_rng([SEED, sentence, take])
    jitter = np.exp(rng.normal(0, _PHONEME_JITTER, len(reading.durations)))
    tempo = np.exp(rng.normal(0, _TEMPO_JITTER))
    stressed = np.array([PRIMARY_STRESS in phoneme for phoneme in reading.phonemes])
    silent = np.array([phoneme == "" for phoneme in reading.phonemes])
    durations = reading.durations / prosody.rate * tempo * jitter
    durations *= np.where(stressed, prosody.accent, 1) * np.where(silent, prosody.pause, 1)
    boundaries = LEAD_IN + np.concatenate([[0.0], np.cumsum(durations)])
    starts = boundaries[list(reading.word_places)]
    last_sound = boundaries[np.flatnonzero(~silent)[-1] + 1]
    return Timing(
        phonemes=reading.phonemes,
        boundaries=boundaries,
        stressed=stressed,
        words=SENTENCES[sentence].words,
        word_starts=starts,
        word_ends=np.append(starts[1:], last_sound),
    )
