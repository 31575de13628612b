"""The corpus with known factors: who says what, how it sounds, moves and looks."""

from s2glib.corpus.appearance import HELD_OUT, PORTRAIT, Appearance, appearances
from s2glib.corpus.bearing import BEARINGS, MANNERS
from s2glib.corpus.build import (
    MotionSet,
    Request,
    SpeechSet,
    face_set,
    motion_set,
    onset_set,
    render_clip,
    render_motion,
    speech_set,
    timing_of,
)
from s2glib.corpus.clock import Timing
from s2glib.corpus.intensity import intensity
from s2glib.corpus.lexicon import GESTURES
from s2glib.corpus.puppet import KEYPOINT_NAMES, Part
from s2glib.corpus.script import (
    EMOTIONS,
    PROSODY,
    SENTENCES,
    SPEAKERS,
    VOICES,
    Cell,
    Sentence,
    parse_id,
    speech_take,
    split,
)
from s2glib.corpus.video import Video, render_frames, render_video, resample_motion

__all__ = [
    "BEARINGS",
    "EMOTIONS",
    "GESTURES",
    "HELD_OUT",
    "KEYPOINT_NAMES",
    "MANNERS",
    "PORTRAIT",
    "PROSODY",
    "SENTENCES",
    "SPEAKERS",
    "VOICES",
    "Appearance",
    "Cell",
    "MotionSet",
    "Part",
    "Request",
    "Sentence",
    "SpeechSet",
    "Timing",
    "Video",
    "appearances",
    "face_set",
    "intensity",
    "motion_set",
    "onset_set",
    "parse_id",
    "render_clip",
    "render_frames",
    "render_motion",
    "render_video",
    "resample_motion",
    "speech_set",
    "speech_take",
    "split",
    "timing_of",
]
