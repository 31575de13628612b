"""Video files: a film as mp4 with its sound, as WebP or as GIF.

Paper:    -
Notebook: notebooks/22_capstone.ipynb
"""

import os
import subprocess
from fractions import Fraction
from pathlib import Path

import numpy as np
from PIL import Image

from s2glib.audio.io import Waveform, save
from s2glib.body.whole_file import whole_file
from s2glib.viz.film import FASTEST, Frames, check_fps, film_bytes

FASTEST_GIF = 50  # frames per second; browsers slow a faster one down
GIF_COLOURS = 255  # and one that means: as before
SMALLEST_MP4 = 256  # pixels along the shorter side
PALETTE_FRAMES = 16  # that are looked at for the colours of a GIF
NO_FFMPEG = (
    "an .mp4 needs ffmpeg; install the extra: pip install s2glib[video]. A .gif, a .webp and a "
    "page (s2glib.widgets.write_film_page) work without"
)


def write_video(
    path: str | os.PathLike[str],
    frames: Frames,
    fps: float | int,
    waveform: Waveform | None = None,
) -> None:
    """Write a film as one file, which appears whole or not at all.

    An .mp4 (H.264, AAC) carries the sound and plays everywhere, but holds colours only for every
    second pixel: small pictures are enlarged, by a whole number, to 256 pixels at least, and one
    of an odd size repeats its last row or column. A .webp keeps every pixel, a .gif 255 colours;
    both are silent and of the size of the frames.

    Args:
        path: ends in .mp4, .webp or .gif.
        frames: bytes (t, h, w, 3), or values in 0 .. 1 (t, 3, h, w).
        fps: frames per second, 1 to 120; in a .gif up to 50.
        waveform: what is heard, or None for silence. The film lasts as long as its pictures: a
            longer sound is cut, and after a shorter one it is silent.

    Raises:
        ImportError: for an .mp4 without the extra `video`.
        OSError: if the file cannot be written.
        TypeError: if frames or waveform are something else.
        ValueError: if a shape, a value or a number is out of range, the path ends otherwise, or a
            .gif or .webp should carry sound.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in (".mp4", ".webp", ".gif"):
        raise ValueError(f"a film is written as .mp4, .webp or .gif, got {Path(path).name}")
    film = film_bytes(frames)
    check_fps(fps, FASTEST_GIF if suffix == ".gif" else FASTEST)
    if waveform is not None and not isinstance(waveform, Waveform):
        raise TypeError(f"waveform must be a Waveform or None, got {type(waveform).__name__}")
    if suffix == ".mp4":
        _write_mp4(path, film, fps, waveform)
    elif waveform is not None:
        raise ValueError(
            f"a {suffix} has no sound; .mp4 and the page of s2glib.widgets.write_film_page have. "
            "Write one of these, or leave the waveform out"
        )
    else:
        _write_pictures(path, film, fps)


def _write_mp4(path, film, fps, waveform) -> None:
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
    except ImportError as error:
        raise ImportError(NO_FFMPEG) from error
    times = -(-SMALLEST_MP4 // min(film.shape[1:3]))
    film = _even(film, times)
    height, width = film.shape[1:3]
    rate = Fraction(fps).limit_denominator(1001)
    heard = []
    with whole_file(path) as file:
        if waveform is not None:
            sound = Path(file.name).with_name("sound.wav")
            save(sound, _lasting(waveform, len(film) / rate))
            heard = ["-i", sound, "-c:a", "aac", "-b:a", "96k"]
        command = [
            *(get_ffmpeg_exe(), "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24"),
            *("-s", f"{width}x{height}", "-framerate", str(rate), "-i", "-", *heard),
            *("-vf", _to_yuv(width * times, height * times), "-c:v", "libx264", "-crf", "17"),
            *("-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"),
            *("-movflags", "+faststart", file.name),
        ]
        done = subprocess.run(command, input=film.data.cast("B"), capture_output=True, check=False)
        if done.returncode:
            raise OSError(f"ffmpeg could not write {path}: {done.stderr.decode().strip()}")


def _even(film: np.ndarray, times: int) -> np.ndarray:
    """The film with one more row or column where its enlarged size would be odd."""
    more = [(0, side * times % 2) for side in film.shape[1:3]]
    return np.pad(film, [(0, 0), *more, (0, 0)], mode="edge")


def _to_yuv(width: int, height: int) -> str:
    """What filter gives ffmpeg a size, and the colours that every player knows."""
    careful = "bicubic+accurate_rnd+full_chroma_int"
    return f"scale={width}:{height}:flags={careful}:out_color_matrix=bt709,format=yuv420p"


def _lasting(waveform: Waveform, seconds: float | Fraction) -> Waveform:
    """The sound cut, or followed by silence, to a length."""
    wanted = max(1, round(seconds * waveform.sample_rate))
    samples = waveform.samples[:wanted]
    return Waveform(np.pad(samples, (0, wanted - len(samples))), waveform.sample_rate)


def _write_pictures(path, film, fps) -> None:
    pictures = [Image.fromarray(frame) for frame in film]
    if Path(path).suffix.lower() == ".gif":
        pictures, kind, step, options = _of_few_colours(film), "GIF", 10, {}
    else:
        kind, step, options = "WEBP", 1, {"lossless": True, "method": 0}
    following = {"save_all": True, "append_images": pictures[1:], "loop": 0}
    with whole_file(path) as file:
        duration = _durations(len(film), fps, step)
        pictures[0].save(file, kind, duration=duration, **following, **options)


def _durations(frames: int, fps: float | int, step: int) -> list[int]:
    """Milliseconds of each frame, in whole steps, so that none begins off by more than half one."""
    starts = step * np.round(np.arange(frames + 1) * 1000 / fps / step)
    return np.diff(starts).astype(int).tolist()


def _of_few_colours(film: np.ndarray) -> list[Image.Image]:
    """Pictures in colours of one palette, so that what stands still does not flicker."""
    some = film[:: -(-len(film) // PALETTE_FRAMES)]
    palette = Image.fromarray(np.concatenate(some)).quantize(GIF_COLOURS)
    plain = Image.Dither.NONE
    return [Image.fromarray(frame).quantize(palette=palette, dither=plain) for frame in film]
