"""The film player: films side by side, in step with their sound, in a notebook cell.

Paper:    -
Notebook: notebooks/04_repairing_pixels.ipynb
"""

from collections.abc import Mapping

import numpy as np
import traitlets
from matplotlib.axes import Axes

from s2glib.audio.io import Waveform
from s2glib.viz.film import Frames, draw_films, film_bytes
from s2glib.widgets.film_packing import pack_films
from s2glib.widgets.parts import read_parts
from s2glib.widgets.playback import STYLE, Playback

PARTS = ("entry.js", "playback.js", "film_player.js")
FILM_STYLE = read_parts("film_player.css")
MOMENTS = 8  # that are drawn


class FilmPlayer(Playback):
    """Plays one film, or several side by side in step, with their sound as the clock.

    Space or a click plays and pauses, the arrow keys step frame by frame, Home returns to the
    start. What Python can ask for is in `Playback`.

    Args:
        frames: bytes (t, h, w, 3) or values in 0 .. 1 (t, 3, h, w); or several films by name. Where
            one is shorter, its last frame stays.
        fps: frames per second, of all films.
        waveform: what is heard, or None for silence.
        width: of one film, in pixels of the page.
        title: what stands above the films.

    Raises:
        TypeError: if something else than films and a waveform comes.
        ValueError: if there is no film, a film is none, or it is more than a browser can hold.
    """

    _esm = read_parts(*PARTS) + "export default createFilmPlayer;\n"
    _css = STYLE + FILM_STYLE
    film: traitlets.Dict = traitlets.Dict().tag(sync=True)
    sheets = traitlets.Bytes().tag(sync=True)
    width = traitlets.Int(256, min=16).tag(sync=True)
    title = traitlets.Unicode("").tag(sync=True)

    def __init__(
        self,
        frames: Frames | Mapping[str, Frames],
        fps: float | int,
        waveform: Waveform | None = None,
        *,
        width: int = 256,
        title: str = "",
    ) -> None:
        self._films = named_films(frames)
        packed = pack_films(self._films, fps, waveform)
        self.fps, self.frames = float(fps), max(map(len, self._films.values()))
        super().__init__(**packed._asdict(), width=width, title=title)

    def draw(self, axes: Axes) -> Axes:
        """Draw moments from the first frame to the last: what is seen where no kernel runs."""
        shown = np.linspace(0, self.frames - 1, min(MOMENTS, self.frames)).round()
        return draw_films(axes, self._films, self.fps, (shown / self.fps).tolist())

    def __repr__(self) -> str:
        return (
            "FilmPlayer: films that play in step. Needs a running kernel; without one, .draw(axes)"
        )


def named_films(frames: Frames | Mapping[str, Frames]) -> dict[str, np.ndarray]:
    """Films by name, as bytes; a single one has no name."""
    films = dict(frames) if isinstance(frames, Mapping) else {"": frames}
    if not films:
        raise ValueError("there is no film to show; give one, or several by name")
    return {name: film_bytes(each) for name, each in films.items()}
