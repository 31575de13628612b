"""The player as one file: a page with body and sound inside, which plays offline by double click.

Paper:    -
Notebook: notebooks/14_emotion_swap_studio.ipynb
"""

import base64
import html
import json
import os
from collections.abc import Mapping
from pathlib import Path

from s2glib.audio.io import Waveform
from s2glib.body.motion import Motion
from s2glib.body.skinning import BodyModel
from s2glib.widgets.packing import pack_mesh, pack_motion, pack_sound
from s2glib.widgets.player import (
    HERE,
    SCRIPT,
    STYLE,
    check_body,
    check_waveform,
    named_motions,
)

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
    content = {
        "mesh": _as_text(pack_mesh(check_body(body))),
        "motion": _as_text(pack_motion(motions, body)),
        "sound": _as_text(pack_sound(waveform, seconds)),
        "view": view,
        "height": height,
    }
    page = PAGE.format(
        title=html.escape(title),
        text=html.escape(text),
        style=STYLE,
        content=json.dumps(content).replace("<", "\\u003c"),
        script=SCRIPT + (HERE / "page.js").read_text("utf-8"),
    )
    unfinished = Path(path).with_name(Path(path).name + ".part")
    unfinished.write_text(page, "utf-8")
    unfinished.replace(path)


def _as_text(data: bytes) -> str:
    return base64.b64encode(data).decode()
