"""Motions for other programs: npz in the layout of SMPL-X tools, and a moving body as GLB.

Paper:    AM C.2 (SMPL-X parameters)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import os
from collections.abc import Iterator
from zipfile import BadZipFile

import numpy as np
import pygltflib as gltf
import torch
from torch import Tensor

from s2glib.body.gltf import Buffer
from s2glib.body.motion import Motion
from s2glib.body.skeleton import FACE_CURVES, JOINT_NAMES
from s2glib.body.skinning import BodyModel
from s2glib.body.whole_file import whole_file

_FACE = "s2g_expressions"
_TRACKS = ("poses", "trans", "mocap_frame_rate", "mocap_framerate", _FACE)


def write_npz(path: str | os.PathLike[str], motion: Motion) -> None:
    """Write a motion as SMPL-X tools read it.

    `expressions` stays zero: our face curves are not SMPL-X's components and would give a grimace
    there. They stand apart, as `s2g_expressions` with `s2g_expression_names`.
    """
    with whole_file(path) as file:
        np.savez(
            file,
            allow_pickle=False,
            poses=_floats(motion.poses.flatten(1)),
            trans=_floats(motion.trans),
            mocap_frame_rate=np.array(motion.fps),
            betas=np.zeros(300, dtype=np.float32),
            gender=np.array("neutral"),
            expressions=np.zeros((motion.frames, 100), dtype=np.float32),
            s2g_expressions=_floats(motion.expression[:, : len(FACE_CURVES)]),
            s2g_expression_names=np.array(FACE_CURVES),
        )


def read_npz(path: str | os.PathLike[str]) -> Motion:
    """Read a motion that `write_npz` or another SMPL-X tool has written.

    A face is read where the file holds our face curves; SMPL-X's own components are left out.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if it is no npz, or lacks poses of 55 joints, their places or their frame rate.
    """
    if not os.path.isfile(path):
        raise FileNotFoundError(f"there is no motion file at {path}; check the path")
    try:
        with np.load(path, allow_pickle=False) as file:
            tracks = {name: file[name] for name in file.files if name in _TRACKS}
    except (ValueError, OSError, TypeError, BadZipFile) as error:
        raise ValueError(f"{path} is no npz of numbers; write one with write_npz") from error
    rate = tracks.get("mocap_frame_rate", tracks.get("mocap_framerate"))
    shapes = [tracks[name].shape[1:] for name in ("poses", "trans") if name in tracks]
    face = tracks.get(_FACE, np.zeros((len(tracks.get("poses", ())), 0)))
    whole = shapes == [(3 * len(JOINT_NAMES),), (3,)] and face.ndim == 2
    if rate is None or np.size(rate) != 1 or not whole:
        raise ValueError(
            f"{path} must hold poses (frames, {3 * len(JOINT_NAMES)}), trans (frames, 3) and "
            f"mocap_frame_rate; it has {', '.join(tracks) or 'none of them'}"
        )
    poses = torch.from_numpy(tracks["poses"].astype(np.float32)).unflatten(1, (-1, 3))
    trans = torch.from_numpy(tracks["trans"].astype(np.float32))
    expression = torch.zeros(len(face), 100)
    curves = torch.from_numpy(face[:, : len(FACE_CURVES)])
    expression[:, : curves.shape[1]] = curves
    return Motion(poses, trans, expression, float(np.ravel(rate)[0]))


def write_glb(path: str | os.PathLike[str], motion: Motion, body: BodyModel) -> None:
    """Write a skinned body that plays the motion: bones, skin, colours and face curves.

    Shape and pose directions stay behind: a GLB bends by linear blend skinning alone.

    Raises:
        ValueError: if the body has other joints than the motion, or no faces.
    """
    if len(body.joints) != len(JOINT_NAMES):
        raise ValueError(f"a motion has {len(JOINT_NAMES)} joints, the body {len(body.joints)}")
    if len(body.faces) == 0:
        raise ValueError("the body has no faces; a GLB shows a surface")
    buffer = Buffer()
    pelvis = motion.trans + body.joints[0].to(motion.trans)
    primitive = gltf.Primitive(
        attributes=_attributes(buffer, body),
        indices=buffer.add(_integers(body.faces), "SCALAR", use=gltf.ELEMENT_ARRAY_BUFFER),
        targets=[{"POSITION": buffer.add_sparse(_floats(step), "VEC3")} for step in _curves(body)],
        material=0,
    )
    curves = [*FACE_CURVES, *(f"curve_{number}" for number in range(len(FACE_CURVES), 100))]
    mesh = gltf.Mesh(
        primitives=[primitive],
        weights=[0.0] * len(primitive.targets),
        extras={"targetNames": curves[: len(primitive.targets)]},
    )
    joints = _floats(body.joints)
    inverse = np.tile(np.eye(4, dtype=np.float32), (len(joints), 1, 1))
    inverse[:, 3, :3] = -joints  # column-major, as glTF keeps matrices
    binds = buffer.add(inverse.reshape(-1, 16), "MAT4")
    bones = list(range(len(joints)))
    document = gltf.GLTF2(
        asset=gltf.Asset(generator="s2glib"),
        scene=0,
        scenes=[gltf.Scene(nodes=[0, len(bones)])],
        nodes=[*_bones(body, pelvis[0]), gltf.Node(name="body", mesh=0, skin=0)],
        meshes=[mesh],
        skins=[gltf.Skin(inverseBindMatrices=binds, skeleton=0, joints=bones)],
        materials=[_matte()],
        animations=[_animation(buffer, motion, pelvis, len(primitive.targets))],
    )
    with whole_file(path) as file:
        buffer.write(file, document)


def _floats(values: Tensor) -> np.ndarray:
    return values.detach().cpu().numpy().astype(np.float32, copy=False)


def _integers(faces: Tensor) -> np.ndarray:
    return faces.cpu().numpy().astype(np.uint32).ravel()


def _attributes(buffer: Buffer, body: BodyModel) -> gltf.Attributes:
    """Positions, normals, colours and the four strongest joints of each vertex."""
    weights, joints = body.weights.topk(min(4, body.weights.shape[1]), dim=1)
    weights = weights / weights.sum(1, keepdim=True)
    joints = torch.where(weights > 0, joints, 0)
    use = gltf.ARRAY_BUFFER
    attributes = gltf.Attributes(
        POSITION=buffer.add(_floats(body.vertices), "VEC3", use=use, bounds=True),
        NORMAL=buffer.add(_floats(_normals(body)), "VEC3", use=use),
        JOINTS_0=buffer.add(joints.cpu().numpy().astype(np.uint8), "VEC4", use=use),
        WEIGHTS_0=buffer.add(_floats(weights), "VEC4", use=use),
    )
    if body.colors is not None:
        attributes.COLOR_0 = buffer.add(_floats(_linear(body.colors)), "VEC3", use=use)
    return attributes


def _normals(body: BodyModel) -> Tensor:
    """Unit normals: the mean of the triangles around, larger ones counting more."""
    a, b, c = body.vertices[body.faces].unbind(1)
    around = torch.cross(b - a, c - a, dim=1).repeat_interleave(3, dim=0)
    normals = torch.zeros_like(body.vertices).index_add_(0, body.faces.flatten(), around)
    return torch.nn.functional.normalize(normals, dim=1)


def _linear(colors: Tensor) -> Tensor:
    """From sRGB, as on a screen, to the linear light that glTF wants."""
    return torch.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)


def _curves(body: BodyModel) -> list[Tensor]:
    """How the vertices move with each expression coefficient."""
    steps = body.expression_directions
    return [] if steps is None else list(steps.unbind(2))


def _bones(body: BodyModel, pelvis: Tensor) -> list[gltf.Node]:
    """One node a joint, at its place relative to its parent."""
    nodes = []
    for joint, (name, parent) in enumerate(zip(JOINT_NAMES, body.parents, strict=True)):
        place = pelvis if parent < 0 else body.joints[joint] - body.joints[parent]
        children = [child for child, holder in enumerate(body.parents) if holder == joint]
        nodes.append(gltf.Node(name=name, translation=place.tolist(), children=children))
    return nodes


def _matte() -> gltf.Material:
    """Cloth and skin: no shine, the colour of the vertices."""
    surface = gltf.PbrMetallicRoughness(metallicFactor=0.0, roughnessFactor=0.85)
    return gltf.Material(name="matte", pbrMetallicRoughness=surface)


def _animation(buffer: Buffer, motion: Motion, pelvis: Tensor, curves: int) -> gltf.Animation:
    """Channels for the turn of every joint, the place of the pelvis, and the face curves."""
    seconds = np.arange(motion.frames, dtype=np.float32) / np.float32(motion.fps)
    time = buffer.add(seconds[:, None], "SCALAR", bounds=True)
    animation = gltf.Animation(name="motion")
    for sampler, (node, path, values, kind) in enumerate(_tracks(motion, pelvis, curves)):
        output = buffer.add(values, kind)
        animation.samplers.append(gltf.AnimationSampler(input=time, output=output))
        target = gltf.AnimationChannelTarget(node=node, path=path)
        animation.channels.append(gltf.AnimationChannel(sampler=sampler, target=target))
    return animation


def _tracks(
    motion: Motion, pelvis: Tensor, curves: int
) -> Iterator[tuple[int, str, np.ndarray, str]]:
    """Node, what of it moves, the values and their kind; one at a time, to save memory."""
    yield 0, "translation", _floats(pelvis), "VEC3"
    for joint, poses in enumerate(motion.poses.unbind(1)):
        yield joint, "rotation", _floats(_quaternions(poses)), "VEC4"
    if curves:
        face = _floats(motion.expression[:, :curves]).reshape(-1, 1)
        yield len(JOINT_NAMES), "weights", face, "SCALAR"


def _quaternions(poses: Tensor) -> Tensor:
    """(x, y, z, w) of each turn; of q and -q, the same turn, the one nearer to the frame before."""
    half = torch.linalg.vector_norm(poses.double(), dim=-1, keepdim=True) / 2
    turns = torch.cat([poses.double() * torch.sinc(half / torch.pi) / 2, half.cos()], dim=-1)
    steps = (turns[1:] * turns[:-1]).sum(-1, keepdim=True)
    signs = torch.where(steps < 0, -1.0, 1.0).cumprod(dim=0)
    return torch.cat([turns[:1], signs * turns[1:]])
