"""Players that outlive their kernel: a built notebook keeps what they play, and the book plays it.

What a player plays goes, compressed, into the metadata of its output, which nbval does not compare.
The body is left out, because the book has the mannequin.

Paper:    -
Notebook: -
"""

import base64
import io
import itertools
import zlib

from nbformat import NotebookNode

KEPT = "s2g-player"  # key in an output's metadata
PLAYER = "s2glib.widgets.player.Player"
FILM_PLAYER = "s2glib.widgets.film_player.FilmPlayer"
WIDGET_STATE = "application/vnd.jupyter.widget-state+json"
WIDGET_VIEW = "application/vnd.jupyter.widget-view+json"
FILM_QUALITY = 60  # of the sheets of a film; a frame of 64 pixels takes some 700 bytes


def keep_players(notebook: NotebookNode) -> None:
    """Note, in place, what each shown player plays, at its own output.

    Of bodies, only the mannequin's players are kept; others stay words in the book.
    """
    models = notebook.metadata.get("widgets", {}).get(WIDGET_STATE, {}).get("state", {})
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            view = output.get("data", {}).get(WIDGET_VIEW)
            player = find_player(models, view["model_id"]) if view else None
            if player and (kept := kept_player(player)):
                output.metadata[KEPT] = kept


def find_player(models: dict, name: str) -> dict | None:
    """The widget of this name if it is a player, else the first player among its children."""
    model = models[name]
    if model["state"].get("_anywidget_id") in (PLAYER, FILM_PLAYER):
        return model
    children = (child.removeprefix("IPY_MODEL_") for child in model["state"].get("children", []))
    return next(filter(None, (find_player(models, child) for child in children)), None)


def kept_player(player: dict) -> dict | None:
    """What a player plays, as text that a notebook can hold; None if its body is not ours."""
    files = {each["path"][0]: base64.b64decode(each["data"]) for each in player["buffers"]}
    sound = as_text(_recoded(files["sound"], "MP3"))
    if player["state"]["_anywidget_id"] == FILM_PLAYER:
        return {**kept_film(player["state"], files["sheets"]), "sound": sound}
    return kept_body(player["state"], files, sound)


def kept_body(state: dict, files: dict[str, bytes], sound: str) -> dict | None:
    """The motions of a player, if the mannequin makes them."""
    from s2glib.body import mannequin
    from s2glib.widgets.packing import pack_mesh

    if files["mesh"] != pack_mesh(mannequin()):
        return None
    motion = as_text(zlib.compress(files["motion"], 9))
    return {"motion": motion, "sound": sound, "view": state["view"], "height": state["height"]}


def kept_film(state: dict, sheets: bytes) -> dict:
    """The films of a player, as AVIF: a third of the size, and colours as fine as before."""
    from PIL import Image

    ends = list(itertools.accumulate(state["film"]["lengths"], initial=0))
    small = []
    for start, end in itertools.pairwise(ends):
        file = io.BytesIO()
        picture = Image.open(io.BytesIO(sheets[start:end]))
        picture.save(file, "AVIF", quality=FILM_QUALITY, subsampling="4:4:4", max_threads=1)
        small.append(file.getvalue())
    film = {**state["film"], "kind": "image/avif", "lengths": list(map(len, small))}
    words = {"width": state["width"], "title": state["title"]}
    return {"film": film, "sheets": as_text(b"".join(small)), **words}


def content_of(kept: dict) -> dict:
    """What the player's script reads, from what a notebook kept; without the body."""
    sound = as_text(_recoded(base64.b64decode(kept["sound"]), "WAV"))
    if "film" in kept:
        return {**kept, "sound": sound}
    motion = zlib.decompress(base64.b64decode(kept["motion"]))
    return {**kept, "motion": as_text(motion), "sound": sound}


def as_text(data: bytes) -> str:
    """Bytes as base64."""
    return base64.b64encode(data).decode()


def _recoded(sound: bytes, kind: str) -> bytes:
    """The same sound as WAV, or as MP3: a fifth of the size, and equal bytes in every build."""
    import soundfile

    if not sound:
        return sound
    file = io.BytesIO()
    samples, rate = soundfile.read(io.BytesIO(sound), dtype="float32")
    soundfile.write(file, samples, rate, format=kind)
    return file.getvalue()
