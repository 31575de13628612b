"""BVH, the plain-text form of motion capture: a skeleton, then one line of numbers a frame.

Paper:    AM C.2, MDD B.5 (BEAT's motion files)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import itertools
import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.body.kinematics import check_parents
from s2glib.body.motion import Motion
from s2glib.body.rotations import axis_angle_to_matrix
from s2glib.body.skeleton import JOINT_NAMES
from s2glib.body.skinning import BodyModel
from s2glib.body.whole_file import whole_file

CHANNELS = tuple(f"{axis}{kind}" for kind in ("position", "rotation") for axis in "XYZ")
BLOCK = 512  # frames that are written together
END_LENGTH = 0.7  # a bone without a child is drawn this much as long as the bone before it


class Bvh(NamedTuple):
    """A motion file in the file's own units (ours: metres; most studios': centimetres).

    Libraries disagree on a root whose OFFSET is not zero: some add it to the position channels,
    some take these alone. Both stay apart here: `root` is the channels as they stand (OFFSET where
    the file has none), `offsets[0]` the OFFSET. Our own files have a zero there, so that all agree.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Float[Tensor, "j 3"]
    rotations: Float[Tensor, "frames j 3 3"]
    root: Float[Tensor, "frames 3"]
    fps: float


class _Joint(NamedTuple):
    name: str
    parent: int
    offset: list[float]
    channels: list[str]


class _Words:
    """The words of a file one by one; every complaint names the line."""

    def __init__(self, path: Path) -> None:
        self.path, self.line = path, 0
        try:
            self.lines = path.read_text(encoding="utf-8-sig").splitlines()
        except UnicodeDecodeError as error:
            raise ValueError(f"{path} is no text, so no BVH file: {error}") from error
        self.waiting: list[str] = []

    def complaint(self, text: str) -> ValueError:
        return ValueError(f"{self.path}, line {self.line}: {text}")

    def take(self, *expected: str) -> str:
        """The next word, which has to be one of those expected."""
        while not self.waiting:
            if self.line == len(self.lines):
                wanted = " or ".join(expected) or "a word"
                raise self.complaint(f"the file ends where {wanted} should follow")
            self.line += 1
            self.waiting = self.lines[self.line - 1].split()
        word = self.waiting.pop(0)
        if expected and word.lower() not in [other.lower() for other in expected]:
            raise self.complaint(f"expected {' or '.join(expected)}, got {word!r}")
        return word

    def number(self) -> float:
        """The next word as a finite number."""
        return self.finite([self.take()])[0]

    def whole(self) -> int:
        """The next word as a number that counts something."""
        word = self.take()
        if not word.isdigit():
            raise self.complaint(f"expected a whole number, got {word!r}")
        return int(word)

    def rows(self, width: int) -> Iterator[list[float]]:
        """The rest of the file, `width` numbers a line."""
        if self.waiting:
            raise self.complaint(f"expected the end of the line, got {self.waiting[0]!r}")
        for line in self.lines[self.line :]:
            self.line += 1
            if line.strip():
                numbers = self.finite(line.split())
                if len(numbers) != width:
                    raise self.complaint(f"expected {width} numbers, got {len(numbers)}")
                yield numbers

    def finite(self, words: list[str]) -> list[float]:
        """Words as numbers, none of them NaN or infinite."""
        try:
            numbers = [float(word) for word in words]
        except ValueError as error:
            raise self.complaint(f"expected numbers, got something else: {error}") from error
        if not np.isfinite(numbers).all():
            raise self.complaint("expected finite numbers, got NaN or infinity")
        return numbers


def read_bvh(path: str | os.PathLike[str]) -> Bvh:
    """Read a BVH file: any order of channels and line ends; End Sites are read over.

    Positions of joints other than the root, which some exporters repeat in every frame, are read
    over too: bones keep the length of their OFFSET.

    Raises:
        ValueError: if the file is no BVH file; names the line and what was expected there.
    """
    words = _Words(Path(path))
    joints = _read_hierarchy(words)
    widths = [len(joint.channels) for joint in joints]
    values, fps = _read_frames(words, sum(widths))
    columns = values.split(widths, dim=1)
    turns = [_rotation(part, joint.channels) for part, joint in zip(columns, joints, strict=True)]
    root = torch.tensor(joints[0].offset, dtype=torch.float64).repeat(len(values), 1)
    for axis in range(3):
        if CHANNELS[axis] in joints[0].channels:
            root[:, axis] = columns[0][:, joints[0].channels.index(CHANNELS[axis])]
    return Bvh(
        names=tuple(joint.name for joint in joints),
        parents=tuple(joint.parent for joint in joints),
        offsets=torch.tensor([joint.offset for joint in joints]),
        rotations=torch.stack(turns, dim=1).float(),
        root=root.float(),
        fps=fps,
    )


def _read_hierarchy(words: _Words) -> list[_Joint]:
    joints: list[_Joint] = []
    ancestors = [-1]
    words.take("HIERARCHY")
    word = words.take("ROOT")
    while len(joints) == 0 or len(ancestors) > 1:
        if word == "}":
            ancestors.pop()
        elif word.lower() == "end":
            words.take("Site")
            _read_offset(words)
            words.take("}")
        else:
            joints.append(_read_joint(words, ancestors[-1]))
            ancestors.append(len(joints) - 1)
        if len(ancestors) > 1:
            word = words.take("JOINT", "End", "}")
    return joints


def _read_joint(words: _Words, parent: int) -> _Joint:
    name = [words.take()]
    while (word := words.take()) != "{":  # some names have blanks
        name.append(word)
    words.waiting.insert(0, word)
    offset = _read_offset(words)
    words.take("CHANNELS")
    known = {channel.lower(): channel for channel in CHANNELS}
    channels = [known[words.take(*CHANNELS).lower()] for _ in range(words.whole())]
    if len(set(channels)) < len(channels):
        raise words.complaint(f"{' '.join(name)} has a channel twice: {', '.join(channels)}")
    return _Joint(" ".join(name), parent, offset, channels)


def _read_offset(words: _Words) -> list[float]:
    words.take("{")
    words.take("OFFSET")
    return [words.number() for _ in range(3)]


def _read_frames(words: _Words, width: int) -> tuple[Tensor, float]:
    words.take("MOTION")
    words.take("Frames:")
    count = words.whole()
    words.take("Frame")
    words.take("Time:")
    seconds = words.number()
    if seconds <= 0:
        raise words.complaint(f"expected a frame time above zero, got {seconds}")
    rows = list(words.rows(width))
    if len(rows) != count or count == 0:
        raise words.complaint(f"expected {count} frames (at least one), got {len(rows)}")
    rate = 1 / seconds
    near = abs(rate - round(rate)) < 1e-4 * rate  # 0.033333 means 30 frames a second
    return torch.tensor(rows, dtype=torch.float64), float(round(rate)) if near else rate


def _rotation(values: Tensor, channels: list[str]) -> Tensor:
    """Turns about each axis in the order of the channels, the first of them outermost."""
    rotation = torch.eye(3, dtype=torch.float64).expand(len(values), 3, 3)
    for column, channel in zip(values.unbind(1), channels, strict=True):
        if channel.endswith("rotation"):
            axis = torch.zeros(len(values), 3, dtype=torch.float64)
            axis[:, "XYZ".index(channel[0])] = column.deg2rad()
            rotation = rotation @ axis_angle_to_matrix(axis)
    return rotation


def write_bvh(path: str | os.PathLike[str], motion: Motion, body: BodyModel) -> None:
    """Write a motion on the body's skeleton, in metres and degrees, joints from parent to child.

    Where the pelvis is stands in its position channels alone; its OFFSET is zero (see `Bvh`).

    Raises:
        ValueError: if the body has other joints than the motion.
    """
    if len(body.joints) != len(JOINT_NAMES):
        raise ValueError(f"a motion has {len(JOINT_NAMES)} joints, the body {len(body.joints)}")
    check_parents(body.parents, len(body.joints))
    order: list[int] = []
    head = ["HIERARCHY", *_written_joint(0, body, order), "MOTION"]
    head += [f"Frames: {motion.frames}", f"Frame Time: {1 / motion.fps:.10f}"]
    with whole_file(path) as file:
        for line in itertools.chain(head, _written_frames(motion, body, order)):
            file.write(f"{line}\n".encode())


def _written_joint(joint: int, body: BodyModel, order: list[int]) -> Iterator[str]:
    """The lines of a joint and all below it; `order` collects the joints as they come."""
    order.append(joint)
    children = [child for child, parent in enumerate(body.parents) if parent == joint]
    parent = body.parents[joint]
    offset = body.joints[joint] - body.joints[parent] if joint else torch.zeros(3)
    positions = "6 Xposition Yposition Zposition" if joint == 0 else "3"
    yield f"{'JOINT' if joint else 'ROOT'} {JOINT_NAMES[joint]}"
    yield "{"
    yield "OFFSET " + _triple(offset)
    yield f"CHANNELS {positions} Zrotation Xrotation Yrotation"
    for child in children:
        yield from _written_joint(child, body, order)
    if not children:
        yield from ("End Site", "{", "OFFSET " + _triple(END_LENGTH * offset), "}")
    yield "}"


def _written_frames(motion: Motion, body: BodyModel, order: list[int]) -> Iterator[str]:
    """One line a frame; a block of frames is worked out at a time."""
    pelvis = body.joints[0].double()
    for poses, trans in zip(motion.poses.split(BLOCK), motion.trans.split(BLOCK), strict=True):
        degrees = _euler_zxy(axis_angle_to_matrix(poses.double())).rad2deg()[:, order]
        places = trans.double() + pelvis
        for row in torch.cat([places, degrees.flatten(1)], dim=1).cpu().tolist():
            yield " ".join(f"{value:.6f}" for value in row)


def _triple(vector: Tensor) -> str:
    return " ".join(f"{value:.6f}" for value in vector.tolist())


def _euler_zxy(rotation: Tensor) -> Tensor:
    """Angles (z, x, y) with R = Rz Rx Ry; where x is a right angle, y is taken to be zero."""
    (a, b, _), (c, d, _), (e, f, g) = (row.unbind(-1) for row in rotation.unbind(-2))
    cos_x = torch.hypot(b, d)
    locked = cos_x < 1e-7
    z = torch.where(locked, torch.atan2(c, a), torch.atan2(-b, d))
    y = torch.where(locked, torch.zeros_like(e), torch.atan2(-e, g))
    return torch.stack([z, torch.atan2(f, cos_x), y], dim=-1)
