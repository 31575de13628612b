"""The players as one file: a page with all that it plays inside, which needs nothing but a browser.

A minute of two motions and their sound is 5 MB; browsers open ten minutes in seconds.

Paper:    -
Notebook: notebooks/14_emotion_swap_studio.ipynb
"""

import base64
import html
import json
import os
from collections.abc import Iterator, Mapping

from s2glib.audio.io import Waveform
from s2glib.body.motion import Motion
from s2glib.body.skinning import BodyModel
from s2glib.body.whole_file import whole_file
from s2glib.viz.film import Frames
from s2glib.widgets import film_player, player
from s2glib.widgets.film_packing import pack_films
from s2glib.widgets.packing import pack_mesh, pack_motion, pack_sound
from s2glib.widgets.parts import read_parts
from s2glib.widgets.playback import Playback, check_waveform

PIECE = 3 << 20  # bytes that are turned into text together; a multiple of three
PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<link rel="icon" href="data:,">
<title>{title}</title>
<style>body {{ margin: 0; background: #f5eadc; }}
{style}</style>
<main class="s2g-page">
<h1>{title}</h1>
<p>{text}</p>
<div id="player"></div>
</main>
<script type="application/json" id="content">{content}</script>
<script type="module">
{script}</script>
</html>
"""
OPEN = """
const content = JSON.parse(document.getElementById("content").textContent);
{opener}(content, document.getElementById("player"));
"""


def write_html(
    path: str | os.PathLike,
    motion: Motion | Mapping[str, Motion],
    waveform: Waveform | None,
    body: BodyModel,
    *,
    title: str,
    text: str = "",
    view: str = "",
    height: int = 520,
) -> None:
    """Write a page that plays motion and sound with nothing but a browser.

    Args:
        path: the file to write; it appears whole or not at all.
        motion: what the body does, or several motions by name, with a button each.
        waveform: what is heard, or None for silence.
        body: who does it.
        title: heading of the page.
        text: a sentence or two below it, for example what was swapped.
        view: the motion to show first; all side by side if empty.
        height: of the picture, in pixels.

    Raises:
        TypeError: if something else than a motion, a waveform and a body comes.
        ValueError: if there is no motion, `view` names none, or they differ in frames per second.
    """
    motions = player.named_motions(motion)
    check_waveform(waveform)
    if view not in ("", *motions):
        raise ValueError(f"no motion is called {view!r}; there are {tuple(motions)}")
    seconds = max(each.duration for each in motions.values())
    packed = {
        "mesh": pack_mesh(player.check_body(body)),
        "motion": pack_motion(motions, body),
        "sound": pack_sound(waveform, seconds),
    }
    facts = {"view": view, "height": height}
    _write(path, (title, text), facts, packed, player.Player, "openPlayer")


def write_film_page(
    path: str | os.PathLike,
    frames: Frames | Mapping[str, Frames],
    fps: float | int,
    waveform: Waveform | None = None,
    *,
    title: str,
    text: str = "",
    width: int = 256,
) -> None:
    """Write a page that plays films, side by side if several, and their sound.

    Args:
        path: the file to write; it appears whole or not at all.
        frames: bytes (t, h, w, 3) or values in 0 .. 1 (t, 3, h, w); or several films by name.
        fps: frames per second, of all films.
        waveform: what is heard, or None for silence.
        title: heading of the page.
        text: a sentence or two below it.
        width: of one film, in pixels.

    Raises:
        TypeError: as `FilmPlayer`.
        ValueError: as `FilmPlayer`.
    """
    film, sheets, sound = pack_films(film_player.named_films(frames), fps, waveform)
    facts = {"film": film, "width": width, "title": ""}
    packed = {"sheets": sheets, "sound": sound}
    _write(path, (title, text), facts, packed, film_player.FilmPlayer, "openFilm")


def _write(
    path: str | os.PathLike,
    words: tuple[str, str],
    facts: Mapping[str, object],
    packed: Mapping[str, bytes],
    widget: type[Playback],
    opener: str,
) -> None:
    """A page with a title and a text, in which a script opens facts and bytes as a widget does."""
    before, after = PAGE.split("{content}")
    title, text = map(html.escape, words)
    known = json.dumps(facts).replace("<", "\\u003c")
    script = widget._esm + read_parts("local.js") + OPEN.format(opener=opener)
    with whole_file(path) as file:
        file.write(before.format(title=title, text=text, style=widget._css).encode())
        file.write(known.removesuffix("}").encode())
        for name, data in packed.items():
            file.writelines(_member(name, data))
        file.write(("}" + after.format(script=script)).encode())


def _member(name: str, data: bytes) -> Iterator[bytes]:
    """One more entry of a JSON object, bytes as base64, a piece at a time."""
    yield f', "{name}": "'.encode()
    for start in range(0, len(data), PIECE):
        yield base64.b64encode(data[start : start + PIECE])
    yield b'"'
