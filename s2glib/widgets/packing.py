"""Packing: a body, its motions and their sound as the few bytes that the player in the page reads.

The mesh travels once; after it ten seconds of motion and speech are about half a megabyte, because
only joint turns (16-bit quaternions), places and face curves are sent and the GPU does the rest.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import io
import json
from collections.abc import Mapping

import numpy as np
import torch
from jaxtyping import Float, Int, Int16
from torch import Tensor

from s2glib.audio.io import Waveform
from s2glib.body.motion import Motion
from s2glib.body.skeleton import JOINT_NAMES
from s2glib.body.skinning import BodyModel

BLOCK = 1024  # frames whose turns are quantised together
INFLUENCES = 4  # joints that one vertex follows at most
NORMAL_SCALE = 4096  # 16-bit steps in a normal of length one
CLAY = 0.72  # red, green and blue of a body without colours
FEET = tuple(joint for joint, name in enumerate(JOINT_NAMES) if name.endswith(("_ankle", "_foot")))


def pack(arrays: Mapping[str, np.ndarray], facts: Mapping[str, object]) -> bytes:
    """Join named arrays and plain facts into one container, which `unpack` in pose.js reads.

    Layout: the header's length (uint32), the header (JSON), then each array from a multiple of 8.
    """
    entries, offset = [], 0
    blocks: list[memoryview | bytes] = []
    for name, array in arrays.items():
        kind = array.dtype.newbyteorder("<").str[1:]
        entries.append({"name": name, "kind": kind, "shape": array.shape, "offset": offset})
        blocks += [np.ascontiguousarray(array).data, bytes(-array.nbytes % 8)]
        offset += array.nbytes + len(blocks[-1])
    header = json.dumps({"facts": dict(facts), "arrays": entries}).encode()
    header += b" " * (-(len(header) + 4) % 8)
    return len(header).to_bytes(4, "little") + header + b"".join(blocks)


def pack_mesh(body: BodyModel) -> bytes:
    """The rest surface, how it follows joints and face, and nothing that changes in time.

    Shape and pose corrections of a licensed body are left out: the player draws the mean shape.
    """
    vertices, faces = body.vertices.double(), body.faces
    bones, weights = _strongest_influences(body.weights)
    moving, directions = _face_directions(body)
    morph = np.full(len(vertices), -1, np.float32)
    morph[moving] = np.arange(len(moving))
    reach = float(np.abs(directions[:, :, 0]).max(initial=1e-6))
    steps = np.array([32767 / reach, NORMAL_SCALE])[:, None]
    arrays = {
        "vertices": vertices.numpy().astype(np.float32),
        "normals": _padded(np.round(127 * _normals(vertices, faces).numpy()), np.int8),
        "colors": _padded(np.round(255 * _colors(body)), np.uint8),
        "bones": bones.astype(np.uint8),
        "weights": weights,
        "morph": morph,
        "directions": np.round(directions * steps).astype(np.int16),
        "faces": faces.numpy().astype(np.uint32),
        "joints": body.joints.numpy().astype(np.float32),
    }
    height = float(vertices[:, 1].max() - vertices[:, 1].min())
    facts = {"parents": body.parents, "curves": directions.shape[1], "reach": reach}
    return pack(arrays, {**facts, "height": height, "feet": FEET})


def pack_motion(motions: Mapping[str, Motion], body: BodyModel) -> bytes:
    """Named motions of one clock; where one is shorter, its last frame stays.

    Raises:
        ValueError: if the motions differ in frames per second.
    """
    rates = {motion.fps for motion in motions.values()}
    if len(rates) != 1:
        raise ValueError(f"motions must share one frame rate, got {sorted(rates)}; resample them")
    known = 0 if body.expression_directions is None else body.expression_directions.shape[-1]
    names = list(motions)
    arrays = {
        "turns": _stacked([quantized_turns(motions[name].poses) for name in names]),
        "trans": _stacked([motions[name].trans.float().numpy() for name in names]),
        "curves": _stacked([motions[name].expression[:, :known].float().numpy() for name in names]),
    }
    floor = float(arrays["trans"][0, 0, 1] + body.vertices[:, 1].min())
    return pack(arrays, {"fps": rates.pop(), "names": names, "floor": floor})


def pack_sound(waveform: Waveform | None, seconds: float) -> bytes:
    """A 16-bit WAV file, as long as the motion or longer; nothing for None."""
    if waveform is None:
        return b""
    import soundfile

    short = max(0, round(seconds * waveform.sample_rate) - len(waveform.samples))
    file = io.BytesIO()
    with soundfile.SoundFile(file, "w", waveform.sample_rate, 1, "PCM_16", format="WAV") as wav:
        wav.write(waveform.samples)
        wav.write(np.zeros(short, np.float32))
    return file.getvalue()


def quantized_turns(poses: Float[Tensor, "frames j 3"]) -> Int16[np.ndarray, "frames j 4"]:
    """Axis-angles as unit quaternions (w, x, y, z) in steps of 1 / 32767: within 1e-4 rad."""
    return np.concatenate([_quantized(block) for block in poses.split(BLOCK)])


def _quantized(poses: Tensor) -> np.ndarray:
    half = poses.double().numpy() / 2
    angle = np.linalg.norm(half, axis=-1, keepdims=True)
    quaternions = np.concatenate([np.cos(angle), half * np.sinc(angle / np.pi)], axis=-1)
    return np.round(32767 * quaternions).astype(np.int16)


def _stacked(tracks: list[np.ndarray]) -> np.ndarray:
    """One array of tracks that may differ in length: the last frame of a short one stays."""
    frames = max(map(len, tracks))
    stack = np.empty((len(tracks), frames, *tracks[0].shape[1:]), tracks[0].dtype)
    for place, track in zip(stack, tracks, strict=True):
        place[: len(track)] = track
        place[len(track) :] = track[-1]
    return stack


def _padded(values: np.ndarray, kind: type) -> np.ndarray:
    """Four columns instead of three, which the GPU reads faster."""
    return np.pad(values, [(0, 0), (0, 1)]).astype(kind)


def _colors(body: BodyModel) -> np.ndarray:
    if body.colors is None:
        return np.full(body.vertices.shape, CLAY)
    return body.colors.double().clamp(0, 1).numpy()


def _strongest_influences(weights: Float[Tensor, "v j"]) -> tuple[np.ndarray, np.ndarray]:
    """The strongest joints of each vertex, and their shares as whole numbers that sum to 65535."""
    shares, bones = weights.double().topk(INFLUENCES, dim=-1)
    steps = (65535 * shares / shares.sum(-1, keepdim=True)).round().long()
    steps[:, 0] += 65535 - steps.sum(-1)
    return bones.numpy(), steps.numpy().astype(np.uint16)


def _normals(vertices: Float[Tensor, "v 3"], faces: Int[Tensor, "f 3"]) -> Float[Tensor, "v 3"]:
    """The mean direction of the faces around each vertex, large faces counting more."""
    a, b, c = vertices[faces].unbind(-2)
    facing = torch.linalg.cross(b - a, c - a)
    total = torch.zeros_like(vertices)
    for corner in range(3):
        total.index_add_(0, faces[:, corner], facing)
    return torch.nn.functional.normalize(total, dim=-1)


def _face_directions(body: BodyModel) -> tuple[np.ndarray, np.ndarray]:
    """Vertices that any face curve moves, and how: (moving, curves, place and normal, 3)."""
    if body.expression_directions is None:
        return np.zeros(0, int), np.zeros((0, 0, 2, 3))
    vertices, places = body.vertices.double(), body.expression_directions.double()
    rest = _normals(vertices, body.faces)
    normals = [_normals(vertices + place, body.faces) - rest for place in places.unbind(-1)]
    both = torch.stack([places, torch.stack(normals, dim=-1)], dim=1)  # (v, 2, 3, curves)
    moving = both.flatten(1).abs().amax(-1).gt(1e-6).nonzero().squeeze(-1)
    return moving.numpy(), both[moving].permute(0, 3, 1, 2).numpy()
