"""The mannequin: our own body, shipped as one small file and sculpted anew on request.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import json
import os
import pathlib

import numpy as np
import torch
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from s2glib.body.skeleton import FACE_CURVES, JOINT_NAMES, PARENTS
from s2glib.body.skinning import BodyModel
from s2glib.body.whole_file import whole_file

FORMAT = "s2glib-mannequin/1"


def mannequin(path: str | os.PathLike | None = None) -> BodyModel:
    """Load the mannequin: 55 SMPL-X joints, colours, and the face curves of `FACE_CURVES`.

    Args:
        path: a file of `save_mannequin`; without it, the one in the data folder (`S2G_DATA`,
            by default `data_samples` beside the package).

    Raises:
        ValueError: if the file is missing, or is no mannequin.
    """
    beside = pathlib.Path(__file__).parents[2] / "data_samples"
    folder = pathlib.Path(os.environ.get("S2G_DATA", beside))
    path = folder / "mannequin.safetensors" if path is None else pathlib.Path(path)
    try:
        with safe_open(path, framework="numpy") as file:
            header = file.metadata() or {}
            stored = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except (OSError, SafetensorError) as error:
        raise ValueError(
            f"no mannequin in {path}; point S2G_DATA at the folder data_samples, "
            "or write the file with `python -m s2glib.body.sculpture`"
        ) from error
    if header.get("format") != FORMAT:
        raise ValueError(f"{path} has the format {header.get('format')}, expected {FORMAT}")
    return _unpacked(stored)


def build_mannequin() -> BodyModel:
    """Sculpt the mannequin anew, in a few seconds; needs manifold3d from the `dev` extra."""
    from s2glib.body.sculpture import assemble

    return assemble()


def save_mannequin(body: BodyModel, path: str | os.PathLike) -> None:
    """Write a body of at most 4 joints a vertex: tensors, and names as JSON in the header."""
    header = {
        "format": FORMAT,
        "joints": json.dumps(JOINT_NAMES),
        "parents": json.dumps(PARENTS),
        "face_curves": json.dumps(FACE_CURVES),
    }
    with whole_file(path) as file:
        file.write(save(_packed(body), metadata=header))


def _packed(body: BodyModel) -> dict[str, np.ndarray]:
    """Weights as their four largest, face curves of moving vertices only."""
    if body.colors is None or body.expression_directions is None:
        raise ValueError("a mannequin has colors and expression_directions; this body lacks them")
    largest = body.weights.topk(4, dim=1)
    directions = body.expression_directions.numpy()
    moving = np.flatnonzero(np.abs(directions).max((1, 2)) > 1e-5)
    return {
        "vertices": body.vertices.numpy(),
        "faces": body.faces.numpy().astype(np.uint16),
        "weights": largest.values.numpy().astype(np.float16),
        "weight_joints": largest.indices.numpy().astype(np.uint8),
        "joints": body.joints.numpy(),
        "colors": (255 * body.colors.numpy()).round().astype(np.uint8),
        "moving": moving.astype(np.uint16),
        "directions": directions[moving].astype(np.float16),
    }


def _unpacked(stored: dict[str, np.ndarray]) -> BodyModel:
    count = len(stored["vertices"])
    weights = np.zeros((count, len(JOINT_NAMES)), dtype=np.float32)
    np.put_along_axis(weights, stored["weight_joints"].astype(int), stored["weights"], axis=1)
    directions = np.zeros((count, 3, len(FACE_CURVES)), dtype=np.float32)
    directions[stored["moving"]] = stored["directions"]
    return BodyModel(
        vertices=torch.from_numpy(stored["vertices"]),
        faces=torch.from_numpy(stored["faces"].astype(np.int64)),
        weights=torch.from_numpy(weights / weights.sum(1, keepdims=True)),
        joints=torch.from_numpy(stored["joints"]),
        parents=PARENTS,
        colors=torch.from_numpy(stored["colors"].astype(np.float32) / 255),
        expression_directions=torch.from_numpy(directions),
    )
