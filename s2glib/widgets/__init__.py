"""Things to look at and play with in a notebook: the body player, and demos on native controls."""

from s2glib.widgets.demo import Demo, Panel, Slider
from s2glib.widgets.emotion_swap import EmotionSwapDemo
from s2glib.widgets.page import write_html
from s2glib.widgets.player import Player

__all__ = ["Demo", "EmotionSwapDemo", "Panel", "Player", "Slider", "write_html"]
