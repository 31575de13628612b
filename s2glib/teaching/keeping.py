"""Players that outlive their kernel: a built notebook keeps what they play, and the book plays it.

A player's motion and sound go, compressed, into the metadata of its output, which nbval does not
compare. The body is left out, because the book has the mannequin.

Paper:    -
Notebook: -
"""

import base64
import io
import zlib

from nbformat import NotebookNode

KEPT = "s2g-player"  # key in an output's metadata
PLAYER = "s2glib.widgets.player.Player"
WIDGET_STATE = "application/vnd.jupyter.widget-state+json"
WIDGET_VIEW = "application/vnd.jupyter.widget-view+json"


def keep_players(notebook: NotebookNode) -> None:
    """Note, in place, what each shown player plays, at its own output.

    Only the mannequin's players are kept; others stay words in the book.
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
    if model["state"].get("_anywidget_id") == PLAYER:
        return model
    children = (child.removeprefix("IPY_MODEL_") for child in model["state"].get("children", []))
    return next(filter(None, (find_player(models, child) for child in children)), None)


def kept_player(player: dict) -> dict | None:
    """What a player plays, as text that a notebook can hold; None if its body is not ours."""
    from s2glib.body import mannequin
    from s2glib.widgets.packing import pack_mesh

    files = {each["path"][0]: base64.b64decode(each["data"]) for each in player["buffers"]}
    if files["mesh"] != pack_mesh(mannequin()):
        return None
    return {
        "motion": as_text(zlib.compress(files["motion"], 9)),
        "sound": as_text(_recoded(files["sound"], "MP3")),
        **{name: player["state"][name] for name in ("view", "height")},
    }


def content_of(kept: dict) -> dict:
    """What the player's script reads, from what a notebook kept; without the body."""
    motion = zlib.decompress(base64.b64decode(kept["motion"]))
    sound = _recoded(base64.b64decode(kept["sound"]), "WAV")
    return {**kept, "motion": as_text(motion), "sound": as_text(sound)}


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
