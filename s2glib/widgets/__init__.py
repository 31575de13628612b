"""Things to look at and play with in a notebook: players of bodies and films, demos."""

from s2glib.widgets.codebook_explorer import CodebookExplorer
from s2glib.widgets.demo import Demo, Panel, Slider
from s2glib.widgets.emotion_swap import EmotionSwapDemo
from s2glib.widgets.film_player import FilmPlayer
from s2glib.widgets.loss_mixer import LossMixer
from s2glib.widgets.mask_mixer import MaskMixer
from s2glib.widgets.mask_painter import MaskPainter
from s2glib.widgets.page import write_film_page, write_html
from s2glib.widgets.player import Player
from s2glib.widgets.shipped_swap import corpus_swap
from s2glib.widgets.toy_arm import ToyArm
from s2glib.widgets.tps_pad import TPSPad
from s2glib.widgets.unmasking_stepper import UnmaskingStepper

__all__ = [
    "CodebookExplorer",
    "Demo",
    "EmotionSwapDemo",
    "FilmPlayer",
    "LossMixer",
    "MaskMixer",
    "MaskPainter",
    "Panel",
    "Player",
    "Slider",
    "TPSPad",
    "ToyArm",
    "UnmaskingStepper",
    "corpus_swap",
    "write_film_page",
    "write_html",
]
