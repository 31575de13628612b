"""The script of the corpus: who says what, how, how often, and which clips are for what.

Every table that defines the factors stands here and in `bearing.py`; nothing else decides them.

Paper:    AM F (16 sentences, 30 speakers, 8 emotions), BEAT's emotion names
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import hashlib
from itertools import product
from typing import NamedTuple

EMOTIONS = ("neutral", "happiness", "anger", "sadness", "contempt", "surprise", "fear", "disgust")


class Sentence(NamedTuple):
    """One line of the script.

    `marks` names a gesture of `lexicon.GESTURES` for a word, by the word's place in the line.
    `emotion` is the emotion the line was written for: AMUSE's design A ties the two together.
    """

    emotion: str
    words: tuple[str, ...]
    marks: dict[int, str]

    @property
    def text(self) -> str:
        """The line as one string, ended by a full stop."""
        return " ".join(self.words) + "."


def _line(emotion: str, marked: str) -> Sentence:
    tokens = [token.partition("|") for token in marked.split()]
    marks = {place: mark for place, (_, _, mark) in enumerate(tokens) if mark}
    return Sentence(emotion, tuple(word for word, _, _ in tokens), marks)


SENTENCES = (
    _line(
        "neutral",
        "the meeting|hold starts at nine and we will walk|walk through the plan step|count"
        " by step until noon",
    ),
    _line(
        "neutral",
        "you|you can put the boxes|box over there|there and then close the window|down"
        " behind the desk",
    ),
    _line(
        "happiness",
        "we|self won the first prize|up and everybody|sweep was dancing|round around the"
        " whole garden all night",
    ),
    _line(
        "happiness",
        "the baby smiled at me|self and reached up|up with both tiny|small hands for a"
        " great|offer big hug|hug",
    ),
    _line(
        "anger",
        "I|self told you|you never|cut to touch my computer and you broke|break it into a"
        " thousand pieces|big",
    ),
    _line(
        "anger",
        "they pushed|push us out of the line again and nobody|cut here|here said a"
        " single|count word about it",
    ),
    _line(
        "sadness",
        "my|self old dog died in the winter and the house feels so empty|offer and so very"
        " large|big now",
    ),
    _line(
        "sadness",
        "she left the letter on the table|down and I|self have not heard|away from her"
        " since that long day",
    ),
    _line(
        "contempt",
        "he|there thinks that his little|small speech will change|cycle the world as if"
        " anyone|offer was listening",
    ),
    _line(
        "contempt",
        "oh please|stop they call that a castle|up but it is only a small|small shed beside"
        " the road|walk",
    ),
    _line(
        "surprise",
        "look|there at the size of that enormous|big cake it goes all the way up|up to the ceiling",
    ),
    _line(
        "surprise",
        "you|you mean the train|walk turned around|round in the middle of the tunnel and"
        " came back|away",
    ),
    _line(
        "fear",
        "something|there is moving|round behind the door and I|self can hear it coming"
        " closer|push every second",
    ),
    _line(
        "fear",
        "do not|stop look down|here because the bridge|walk is shaking and the rope will"
        " break|break soon",
    ),
    _line(
        "disgust",
        "there was a long|big green hair in my|self soup and they told us|away to eat"
        " around|round it",
    ),
    _line(
        "disgust",
        "the fridge smelled like rotten fish|small and slime|down was running over"
        " every|sweep single shelf|push",
    ),
)


class Prosody(NamedTuple):
    """How an emotion sounds at full strength, as a change of the neutral reading."""

    f0: float  # semitones
    range: float  # factor on the spread of F0
    rate: float  # factor on the speed of speech
    gain: float  # dB
    tilt: float  # dB per octave around 500 Hz
    breath: float  # share of the voiced sound that turns into noise
    tremor: float  # semitones at 6.2 Hz
    final: float  # semitones over the last quarter
    accent: float  # factor on the length of stressed phonemes
    formant: float  # factor on the frequency axis of the spectral envelope
    pause: float  # factor on the length of pauses


PROSODY = {
    "neutral": Prosody(0.0, 1.0, 1.00, 0, 0.0, 0.00, 0.0, 0, 1.00, 1.00, 1.0),
    "happiness": Prosody(3.0, 1.5, 1.08, 2, 1.0, 0.00, 0.0, 2, 1.15, 1.04, 0.8),
    "anger": Prosody(2.0, 1.4, 1.15, 6, 2.5, 0.00, 0.0, -2, 1.25, 1.00, 0.7),
    "sadness": Prosody(-2.0, 0.5, 0.80, -5, -2.0, 0.25, 0.2, -1, 1.00, 0.98, 1.6),
    "contempt": Prosody(-2.5, 0.8, 0.90, -1, -0.7, 0.05, 0.0, -4, 1.40, 0.97, 1.2),
    "surprise": Prosody(5.0, 1.9, 1.02, 2, 0.7, 0.10, 0.0, 6, 1.30, 1.01, 1.0),
    "fear": Prosody(5.5, 0.7, 1.20, -2, 0.3, 0.30, 0.9, 1, 0.95, 1.02, 0.9),
    "disgust": Prosody(-1.0, 1.1, 0.84, 0, -1.2, 0.15, 0.3, -3, 1.20, 0.93, 1.3),
}


class Voice(NamedTuple):
    """A speaker's voice: an espeak-ng variant, re-pitched and with another vocal tract."""

    variant: str
    f0: float  # Hz, median of the neutral reading
    vocal_tract: float  # factor on formant frequencies (applied as its square root)
    tilt: float  # dB per octave


_VOICES = (
    Voice("quincy", 84, 1.00, 0.0),
    Voice("Mike", 90, 1.03, 0.5),
    Voice("Gene", 96, 0.94, -0.5),
    Voice("john", 101, 1.06, 0.0),
    Voice("shelby", 178, 1.08, 0.3),
    Voice("Jacky", 205, 1.12, -0.3),
    Voice("linda", 228, 1.16, 0.5),
    Voice("steph", 184, 1.04, -1.0),
    Voice("paul", 87, 0.97, 0.2),
    Voice("boris", 109, 0.98, -0.2),
    Voice("Nguyen", 150, 1.05, 0.0),
    Voice("aunty", 170, 1.10, 0.2),
    Voice("belinda", 216, 1.13, -0.4),
    Voice("Annie", 238, 1.15, 0.2),
    Voice("m1", 93, 1.02, -0.3),
    Voice("adam", 113, 0.96, 0.4),
    Voice("Denis", 99, 1.00, -0.6),
    Voice("Andrea", 196, 1.08, 0.4),
    Voice("Michael", 105, 1.04, -0.1),
    Voice("Andy", 118, 0.99, 0.3),
    Voice("anika", 211, 1.10, 0.0),
    Voice("pablo", 126, 1.01, 0.1),
    Voice("grandma", 191, 1.06, -0.5),
    Voice("zac", 250, 1.18, 0.0),
    Voice("f1", 166, 1.07, 0.0),
    Voice("m3", 103, 0.95, 0.2),
    Voice("Hugo", 121, 0.98, -0.4),
    Voice("f4", 181, 1.09, 0.5),
    Voice("max", 91, 1.00, 0.6),
    Voice("ed", 134, 1.03, 0.3),
)
VOICES = {f"voice_{number:02d}": voice for number, voice in enumerate(_VOICES, start=1)}
SPEAKERS = tuple(VOICES)

UNSEEN_SENTENCES = (7, 12)
UNSEEN_SPEAKERS = SPEAKERS[24:]
TRAIN_SENTENCES = tuple(s for s in range(len(SENTENCES)) if s not in UNSEEN_SENTENCES)
TRAIN_SPEAKERS = SPEAKERS[:24]
SPEECH_TAKES = (0, 1)
TEST_TAKE = 2
MOTION_TAKES = tuple(range(10, 20))
SHIPPED_SENTENCES = (1, 3, 4, 10)
SHIPPED_SPEAKERS = ("voice_01", "voice_03", "voice_05", "voice_13")
TEST_CLIPS = 672


class Cell(NamedTuple):
    """One cell of the factorial design."""

    sentence: int
    speaker: str
    emotion: str
    take: int

    @property
    def id(self) -> str:
        """A readable name, such as `s04-voice_01-anger-t2`."""
        return f"s{self.sentence:02d}-{self.speaker}-{self.emotion}-t{self.take}"


def parse_id(clip_id: str) -> Cell:
    """The cell that a clip's name stands for.

    Raises:
        ValueError: if the name is not of the form `s04-voice_01-anger-t2`, or names a factor
            that the script does not have.
    """
    parts = clip_id.split("-")
    well_formed = len(parts) == 4 and parts[0][:1] == "s" and parts[3][:1] == "t"
    if not (well_formed and parts[0][1:].isdecimal() and parts[3][1:].isdecimal()):
        raise ValueError(f"a clip is named like 's04-voice_01-anger-t2', got {clip_id!r}")
    cell = Cell(int(parts[0][1:]), parts[1], parts[2], int(parts[3][1:]))
    check_cell(cell)
    return cell


def check_cell(cell: Cell) -> None:
    """Refuse a cell that the script does not have.

    Raises:
        ValueError: naming the factor and its allowed values.
    """
    if not 0 <= cell.sentence < len(SENTENCES):
        raise ValueError(f"sentences are 0 to {len(SENTENCES) - 1}, got {cell.sentence}")
    if cell.speaker not in VOICES:
        raise ValueError(f"speakers are voice_01 to voice_{len(VOICES)}, got {cell.speaker!r}")
    if cell.emotion not in EMOTIONS:
        raise ValueError(f"emotions are {', '.join(EMOTIONS)}; got {cell.emotion!r}")
    if cell.take < 0:
        raise ValueError(f"takes are counted from 0, got {cell.take}")


def speech_take(take: int) -> int:
    """The take whose speech a take shares.

    Motion takes (10 and up) are further performances of the speech of takes 0 and 1: the same
    clock and the same intensity, another gesture.
    """
    return take if take < MOTION_TAKES[0] else take % len(SPEECH_TAKES)


def _block(sentences, speakers, takes) -> list[Cell]:
    return [Cell(*factors) for factors in product(sentences, speakers, EMOTIONS, takes)]


def _hash(cell: Cell) -> int:
    return int.from_bytes(hashlib.sha256(cell.id.encode()).digest()[:8], "big")


def split(name: str) -> list[Cell]:
    """The cells of a split.

    `train`, `validation`: takes 0 and 1 of 14 sentences x 24 voices x 8 emotions; every tenth
    cell by hash validates. `test`: 672 cells of the same block's take 2, by hash.
    `unseen-sentences`, `unseen-speakers`: take 2 of what no training clip has. `motion`: the
    further performances of the training cells. `shipped`: what `data_samples` holds.

    Raises:
        ValueError: for any other name.
    """
    speech = _block(TRAIN_SENTENCES, TRAIN_SPEAKERS, SPEECH_TAKES)
    take_2 = (TEST_TAKE,)
    makers = {
        "train": lambda: [cell for cell in speech if _hash(cell) % 10],
        "validation": lambda: [cell for cell in speech if not _hash(cell) % 10],
        "test": lambda: sorted(_block(TRAIN_SENTENCES, TRAIN_SPEAKERS, take_2), key=_hash)[
            :TEST_CLIPS
        ],
        "unseen-sentences": lambda: _block(UNSEEN_SENTENCES, TRAIN_SPEAKERS, take_2),
        "unseen-speakers": lambda: _block(TRAIN_SENTENCES, UNSEEN_SPEAKERS, take_2),
        "motion": lambda: _block(TRAIN_SENTENCES, TRAIN_SPEAKERS, MOTION_TAKES),
        "shipped": lambda: _block(SHIPPED_SENTENCES, SHIPPED_SPEAKERS, take_2),
    }
    if name not in makers:
        raise ValueError(f"splits are {', '.join(makers)}; got {name!r}")
    return makers[name]()
