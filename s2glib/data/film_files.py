"""The files of films: found in a folder, and read picture by picture.

Paper:    -
Notebook: notebooks/22_capstone.ipynb
"""

import os
import re
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import BinaryIO, cast

from PIL import Image, ImageSequence

PICTURES = (".png", ".jpg", ".jpeg")
ANIMATIONS = (".gif", ".webp")
VIDEOS = (".mp4", ".mov", ".webm", ".mkv", ".avi")
NO_FFMPEG = (
    "{} needs ffmpeg; install the extra: pip install s2glib[video], or save the pictures of the "
    "film as frames/*.png"
)


def find_films(folder: str | os.PathLike[str]) -> list[Path]:
    """All films of a folder, in the order of their names: sub-folders and film files.

    Raises:
        FileNotFoundError: if there is no such folder.
        ValueError: if it holds no film.
    """
    if not os.path.isdir(folder):
        raise FileNotFoundError(f"there is no folder of films at {folder}; check the path")
    films = [
        path for path in _in_order(folder) if path.is_dir() or path.suffix.lower() in _FILM_FILES
    ]
    if not films:
        raise ValueError(
            f"{folder} holds no film; put in a sub-folder with frames/*.png for each, or files "
            f"that end in {', '.join(_FILM_FILES)}"
        )
    return films


def frames_of(film: Path) -> Path:
    """Where the pictures of a film are: a folder of them, or one file.

    Raises:
        ValueError: if there is none, or more than one.
    """
    if not film.is_dir():
        return film
    found = [film / f"frames{ending}" for ending in ("", *_FILM_FILES)]
    found = [path for path in found if path.exists()]
    if len(found) != 1:
        raise ValueError(
            f"{film} must hold either a folder frames with pictures or one file frames.mp4, .gif "
            f"or .webp, got {' and '.join(path.name for path in found) or 'none of them'}"
        )
    return found[0]


def read_pictures(path: Path, endings: Sequence[str] = PICTURES) -> Iterator[Image.Image]:
    """Yield the pictures of a folder, in the order of their names, or of a film file, as RGB.

    Args:
        path: a folder or a film file.
        endings: of the files that are read in a folder.

    Raises:
        FileNotFoundError: if there is no such file.
        ImportError: for a video without the extra `video`.
        ValueError: if something cannot be read as a picture.
    """
    if not path.exists():
        raise FileNotFoundError(f"there is no film at {path}; check the path")
    if path.is_dir():
        for file in _in_order(path):
            if file.suffix.lower() in endings:
                yield next(_images(file))
    else:
        yield from (_video if path.suffix.lower() in VIDEOS else _images)(path)


_FILM_FILES = (*ANIMATIONS, *VIDEOS)


def _in_order(folder: str | os.PathLike[str]) -> list[Path]:
    """What is in a folder, hidden files left out; 9 comes before 10."""
    seen = [path for path in Path(folder).iterdir() if not path.name.startswith(".")]
    return sorted(seen, key=lambda path: re.sub(r"\d+", lambda m: m[0].zfill(20), path.name))


def _images(file: Path) -> Iterator[Image.Image]:
    try:
        with Image.open(file) as opened:
            for image in ImageSequence.Iterator(opened):
                yield image.convert("RGB")
    except (OSError, SyntaxError, ValueError) as error:  # SyntaxError: broken PNG
        raise ValueError(f"{file} cannot be read as a picture; export it again") from error


def _video(file: Path) -> Iterator[Image.Image]:
    """All pictures that are stored, none twice or left out to keep a rate; turned upright."""
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
    except ImportError as error:
        raise ImportError(NO_FFMPEG.format(file)) from error
    command = [
        *(get_ffmpeg_exe(), "-i", f"file:{file}", "-map", "0:v:0", "-fps_mode", "passthrough"),
        *("-f", "image2pipe", "-c:v", "ppm", "-"),
    ]
    quiet = subprocess.DEVNULL
    with subprocess.Popen(command, stdin=quiet, stdout=subprocess.PIPE, stderr=quiet) as ffmpeg:
        pictures = cast(BinaryIO, ffmpeg.stdout)
        while pictures.readline() == b"P6\n":
            width, height = map(int, pictures.readline().split())
            pictures.readline()  # the brightest value, 255
            yield Image.frombytes("RGB", (width, height), pictures.read(3 * width * height))
    if ffmpeg.returncode:
        raise ValueError(f"{file} cannot be read as a film; export it again")
