"""Does the set-up work? Each part is tried, and what fails says in plain words how to mend it.

Paper:    -
Notebook: -
"""

import importlib.metadata
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from packaging.requirements import Requirement

AGAIN = "run `python3 workbook.py setup`, then restart this notebook"
RESTORE = "restore the folder data_samples from the repository"
EXTENSIONS = ("@jupyter-widgets/jupyterlab-manager", "anywidget")
SHIPPED = 128
SLOWEST, FASTEST = 0.1, 2.0  # metres per second, mean of a wrist


def check_packages() -> None:
    """Every package that readers need is there and new enough."""
    for wanted in map(Requirement, importlib.metadata.requires("s2glib") or []):
        optional = wanted.marker is not None and not wanted.marker.evaluate({"extra": ""})
        if not optional and importlib.metadata.version(wanted.name) not in wanted.specifier:
            raise RuntimeError(f"{wanted.name} is too old")


def check_widgets() -> None:
    """JupyterLab has what draws sliders and players; else they appear as plain text."""
    from jupyter_core.paths import jupyter_path

    for extension in EXTENSIONS:
        if not any(Path(folder, extension).is_dir() for folder in jupyter_path("labextensions")):
            raise RuntimeError(f"JupyterLab lacks {extension}")


def check_sound() -> None:
    """A tone of 440 Hz is found at 440 Hz."""
    import librosa

    tone = np.sin(2 * np.pi * 440 * np.arange(16000) / 16000)
    strength = np.abs(librosa.stft(tone, n_fft=1024)).mean(axis=1)
    found = strength.argmax() * 16000 / 1024
    if abs(found - 440) > 16:
        raise RuntimeError(f"a tone of 440 Hz was heard at {found:.0f} Hz")


def check_learning() -> None:
    """The gradient of a sum of squares is twice the point."""
    import torch

    point = torch.ones(3, requires_grad=True)
    point.square().sum().backward()
    if point.grad is None or not point.grad.equal(torch.full((3,), 2.0)):
        raise RuntimeError("a gradient is wrong")


def check_clips() -> None:
    """All shipped clips are listed, and the first one can be read."""
    from s2glib.data import clips, load_clip

    names = clips()
    if len(names) != SHIPPED:
        raise RuntimeError(f"{len(names)} clips of {SHIPPED} are there")
    load_clip(names[0])


def check_body() -> None:
    """The mannequin can be read."""
    from s2glib.body import mannequin

    mannequin()


def check_networks() -> None:
    """The trained networks hear a clip and move a body neither slower nor faster than people do."""
    import torch

    from s2glib.audio import load
    from s2glib.body import joint, joint_positions, mannequin
    from s2glib.data import clips
    from s2glib.folders import data_folder
    from s2glib.papers.amuse import Amuse

    amuse = Amuse.load(data_folder() / "checkpoints")
    heard = amuse.hear(load(data_folder() / "clips" / f"{clips()[0]}.flac"))
    motion = amuse.gesture(heard, generator=torch.Generator().manual_seed(0))
    wrist = joint_positions(motion, mannequin())[:, joint("right_wrist")]
    speed = wrist.diff(dim=0).norm(dim=-1).mean().item() * motion.fps
    if not SLOWEST < speed < FASTEST:  # nor is nan
        raise RuntimeError(f"the wrist moves at {speed:.2f} m/s")


PARTS: Mapping[str, tuple[Callable[[], None], str]] = {
    "packages": (check_packages, AGAIN),
    "widgets": (check_widgets, AGAIN),
    "sound": (check_sound, AGAIN),
    "learning": (check_learning, AGAIN),
    "clips": (check_clips, RESTORE),
    "body": (check_body, RESTORE),
    "networks": (check_networks, RESTORE),
}


def check_environment(parts: Mapping[str, tuple[Callable[[], None], str]] = PARTS) -> bool:
    """Try every part and print one line on each.

    Args:
        parts: by name, what to try and how to mend it.

    Returns:
        Whether everything works.
    """
    failures = 0
    for name, (attempt, cure) in parts.items():
        try:
            attempt()
            print(f"{name:<10}works")
        except Exception as fault:  # whatever it is, a reader needs to know the cure
            failures += 1
            print(f"{name:<10}DOES NOT WORK ({fault}): {cure}")
    print("Mend the lines in capitals." if failures else "Everything works.")
    return failures == 0
