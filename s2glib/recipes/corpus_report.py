"""A page that shows the corpus: its factors, how it sounds, how it moves, how it is measured.

Paper:    AM E, F, Fig. A.9-A.10
Notebook: -
"""

import html
from collections.abc import Sequence
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from s2glib.body import joint_positions, mannequin
from s2glib.checkpoint import load_checkpoint
from s2glib.corpus.bearing import BEARINGS, MANNERS
from s2glib.corpus.build import render_clip, render_motion
from s2glib.corpus.clock import LEAD_IN
from s2glib.corpus.script import EMOTIONS, PROSODY, SENTENCES, VOICES, Cell, split
from s2glib.data.samples import Clip
from s2glib.data.windows import speech_window
from s2glib.folders import data_folder
from s2glib.metrics import kinematic_beats, shuffled_alignment
from s2glib.papers.amuse import MotionExtractor
from s2glib.recipes.amuse_extractor import gesture_accuracy
from s2glib.recipes.motion_data import motion_windows
from s2glib.viz import draw_strip

SHOWN_SENTENCE, SHOWN_TAKE, SHOWN_SPEAKERS = 4, 2, ("voice_01", "voice_05", "voice_10", "voice_14")
ARMS = tuple(range(16, 22))  # shoulders, elbows, wrists
MEASURED_CLIPS = 200


def write_report(folder: Path) -> Path:
    """Render examples and measure; write `corpus.html` and its pictures.

    Raises:
        ImportError: without the extra `corpus`.
    """
    by_emotion = [
        render_clip(SHOWN_SENTENCE, SHOWN_SPEAKERS[0], emotion, SHOWN_TAKE) for emotion in EMOTIONS
    ]
    by_speaker = [
        render_motion(Cell(SHOWN_SENTENCE, speaker, "happiness", SHOWN_TAKE))
        for speaker in SHOWN_SPEAKERS
    ]
    pictures = {
        "Poses by emotion, one speaker, one sentence": _strips(
            by_emotion, [clip.emotion for clip in by_emotion]
        ),
        "Poses by speaker, happiness, the same sentence": _strips(
            by_speaker, [clip.speaker for clip in by_speaker]
        ),
        "Log-mel filterbanks by emotion (dark is quiet)": _spectrograms(by_emotion),
    }
    parts = ["<h1>The corpus</h1>", f"<p>{html.escape(_measured())}</p>"]
    for number, (caption, figure) in enumerate(pictures.items()):
        name = f"corpus-{number}.png"
        figure.savefig(folder / name, dpi=80)
        plt.close(figure)
        parts.append(f"<h2>{caption}</h2><img src='{name}' alt='{caption}' width='1100'>")
    parts += [
        _table("Sentences", ("text", "marked words"), [_sentence_row(s) for s in SENTENCES]),
        _table(
            "Prosody at full strength",
            ("emotion", *next(iter(PROSODY.values()))._fields),
            [(name, *values) for name, values in PROSODY.items()],
        ),
        _table(
            "Bearing at full strength",
            ("emotion", *next(iter(BEARINGS.values()))._fields),
            [(name, *values) for name, values in BEARINGS.items()],
        ),
        _table(
            "Speakers",
            ("name", *next(iter(VOICES.values()))._fields, *next(iter(MANNERS.values()))._fields),
            [(name, *voice, *_rounded(MANNERS[name])) for name, voice in VOICES.items()],
        ),
    ]
    path = folder / "corpus.html"
    style = "<style>body{font:15px sans-serif;margin:2em}td,th{padding:2px 8px}</style>"
    head = f"<!doctype html><html lang='en'><meta charset='utf8'><title>The corpus</title>{style}"
    path.write_text(head + "\n".join(parts) + "</html>\n", encoding="utf8")
    return path


def positions_of(clip: Clip) -> np.ndarray:
    """(frames, 55, 3) joint positions of a clip, metres."""
    return joint_positions(clip.motion, mannequin()).numpy()


def _strips(clips: Sequence[Clip], titles: Sequence[str]) -> Figure:
    figure, axes = plt.subplots(len(clips), 1, figsize=(14, 1.7 * len(clips)), layout="tight")
    for place, clip, title in zip(axes, clips, titles, strict=True):
        times = np.linspace(LEAD_IN, clip.motion.duration - 0.3, 10)
        draw_strip(place, positions_of(clip), clip.motion.fps, [float(t) for t in times])
        place.set_ylabel(title)
    return figure


def _spectrograms(clips: Sequence[Clip]) -> Figure:
    figure, axes = plt.subplots(4, 2, figsize=(14, 9), layout="tight", sharex=True)
    for place, clip in zip(axes.flat, clips, strict=True):
        assert clip.waveform is not None
        window = speech_window(clip.waveform.samples, n_mels=64, frames=352, pool=2)
        place.imshow(
            window.T, origin="lower", aspect="auto", extent=(0, 7.04, 0, 64), cmap="cividis"
        )
        place.set_title(clip.emotion)
        place.set_xlabel("time in s")
        place.set_ylabel("mel filter")
    return figure


def beat_figures(clips: Sequence[Clip], rng: np.random.Generator) -> tuple[float, float]:
    """Beat alignment of true motion to stressed vowels, and of shuffled beats.

    Audio to motion: how near the next motion beat is, for every stressed vowel. Sigma is 0.1 s.
    """
    stresses = [clip.stress_times for clip in clips]
    moves = [
        kinematic_beats(positions_of(clip), clip.motion.fps, joints=ARMS, order=2, smooth=1)
        for clip in clips
    ]
    durations = np.array([clip.motion.duration for clip in clips])
    scores = shuffled_alignment(stresses, moves, durations=durations, sigma=0.1, rng=rng)
    return float(np.nanmean(scores.scores)), float(np.nanmean(scores.shuffled))


def _measured() -> str:
    rng = np.random.default_rng(0)
    cells = split("test")
    chosen = rng.choice(len(cells), MEASURED_CLIPS, replace=False)
    clips = [render_motion(cells[number]) for number in chosen]
    true, shuffled = beat_figures(clips, rng)
    extractor = load_checkpoint(
        data_folder() / "checkpoints" / "amuse-extractor.safetensors", MotionExtractor
    )
    windows = motion_windows(cells, extractor.features, extractor.config.frames)
    return (
        f"Measured on {MEASURED_CLIPS} test clips: beat alignment {true:.3f} (audio to motion, "
        f"sigma 0.1 s, stressed vowels), {shuffled:.3f} for shuffled beats. "
        f"Measured on all {len(cells)} test clips: the motion extractor recognises the emotion of "
        f"{gesture_accuracy(extractor, windows):.1f} % of true gestures. That figure is set by the "
        "dials in s2glib/corpus/bearing.py, not found."
    )


def _rounded(values: Sequence[object]) -> list[object]:
    def short(value: object) -> object:
        if isinstance(value, tuple):
            return ", ".join(f"{x:.2f}" for x in value)
        return round(value, 3) if isinstance(value, float) else value

    return [short(value) for value in values]


def _sentence_row(sentence) -> tuple[str, str]:
    marks = ", ".join(f"{sentence.words[place]}: {name}" for place, name in sentence.marks.items())
    return sentence.text, marks


def _table(title: str, names: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    head = "".join(f"<th>{html.escape(name)}</th>" for name in names)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(str(value))}</td>" for value in row) + "</tr>"
        for row in rows
    )
    return f"<h2>{title}</h2><table><tr>{head}</tr>{body}</table>"
