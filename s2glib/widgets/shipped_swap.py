"""The emotion swap on the shipped clips: every sentence, voice and emotion, with AMUSE behind it.

Paper:    AM A (emotion editing), Fig. A.4
Notebook: notebooks/00_start_here.ipynb
"""

from functools import cache

import torch

from s2glib.body import BodyModel, Motion
from s2glib.corpus import EMOTIONS, SENTENCES, Cell, parse_id
from s2glib.data import clips, load_clip
from s2glib.papers.amuse import Amuse, Heard
from s2glib.widgets.emotion_swap import EmotionSwapDemo


def corpus_swap(amuse: Amuse, body: BodyModel) -> EmotionSwapDemo:
    """Make the demo. What was computed once is kept.

    Source and edit start from the same noise, so that only the emotion tells them apart.

    Raises:
        FileNotFoundError: if the shipped clips are not there.
    """
    cells = [parse_id(name) for name in clips()]
    (take,) = {cell.take for cell in cells}

    def find(sentence: int, speaker: str, emotion: str) -> str:
        return Cell(sentence, speaker, emotion, take).id

    def gesture(heard: Heard) -> Motion:
        return amuse.gesture(heard, generator=torch.Generator().manual_seed(0))

    @cache
    def hear(clip: str) -> Heard:
        sound = load_clip(clip).waveform
        assert sound is not None  # every shipped clip has one
        return amuse.hear(sound)

    @cache
    def generate(clip: str) -> Motion:
        return gesture(hear(clip))

    @cache
    def edit(clip: str, emotion: str) -> Motion:
        return gesture(hear(clip).with_emotion(amuse.emotion_centre(EMOTIONS.index(emotion))))

    return EmotionSwapDemo(
        body,
        [(SENTENCES[number].text, number) for number in sorted({c.sentence for c in cells})],
        sorted({cell.speaker for cell in cells}),
        EMOTIONS,
        find=find,
        load=load_clip,
        generate=generate,
        edit=edit,
    )
