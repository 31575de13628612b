"""The player as one file: a page with body and sound inside, which plays offline by double click.

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
from s2glib.widgets.packing import pack_mesh, pack_motion, pack_sound
from s2glib.widgets.player import (
    HERE,
    SCRIPT,
    STYLE,
    check_body,
    check_waveform,
    named_motions,
)

LOCAL_SCRIPT = SCRIPT + (HERE / "local.js").read_text("utf-8")
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
<div id="choices" class="s2g-choices" role="group" aria-label="Which motion"></div>
<div id="player"></div>
</main>
<script type="application/json" id="content">{content}</script>
<script type="module">
{script}</script>
</html>
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
    motions = named_motions(motion)
    check_waveform(waveform)
    if view not in ("", *motions):
        raise ValueError(f"no motion is called {view!r}; there are {tuple(motions)}")
    seconds = max(each.duration for each in motions.values())
    mesh = pack_mesh(check_body(body))
    before, after = PAGE.split("{content}")
    words = {"title": html.escape(title), "text": html.escape(text)}
    facts = json.dumps({"view": view, "height": height}).replace("<", "\\u003c")
    script = LOCAL_SCRIPT + (HERE / "page.js").read_text("utf-8")
    with whole_file(path) as file:
        file.write((before.format(**words, style=STYLE) + facts.removesuffix("}")).encode())
        file.writelines(_member("mesh", mesh))
        file.writelines(_member("motion", pack_motion(motions, body)))
        file.writelines(_member("sound", pack_sound(waveform, seconds)))
        file.write(("}" + after.format(script=script)).encode())


def _member(name: str, data: bytes) -> Iterator[bytes]:
    """One more entry of a JSON object, bytes as base64, a piece at a time."""
    yield f', "{name}": "'.encode()
    for start in range(0, len(data), PIECE):
        yield base64.b64encode(data[start : start + PIECE])
    yield b'"'
