import numpy as np
import pygltflib
import pytest
import torch
from stand_in import capsule_body, waving_motion

from s2glib.body import (
    FACE_CURVES,
    JOINT_NAMES,
    BodyModel,
    Motion,
    axis_angle_to_matrix,
    mannequin,
    read_npz,
    skin_motion,
    write_glb,
    write_npz,
)

WIDTH = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}
TYPES = {5121: "u1", 5125: "u4", 5126: "f4"}


class Glb:
    """A GLB read back by its specification, and played by its own arithmetic: an oracle."""

    def __init__(self, path):
        self.document = pygltflib.GLTF2().load(path)
        self.blob = self.document.binary_blob()

    def view(self, number, kind, count, width):
        start = self.document.bufferViews[number].byteOffset
        return np.frombuffer(self.blob, kind, count * width, start).reshape(count, width)

    def read(self, number):
        accessor = self.document.accessors[number]
        kind, width = TYPES[accessor.componentType], WIDTH[accessor.type]
        if accessor.sparse is None:
            return self.view(accessor.bufferView, kind, accessor.count, width)
        values, sparse = np.zeros((accessor.count, width)), accessor.sparse
        rows = self.view(sparse.indices.bufferView, "u4", sparse.count, 1)[:, 0]
        values[rows] = self.view(sparse.values.bufferView, kind, sparse.count, width)
        return values

    def track(self, node, path):
        (animation,) = self.document.animations
        (channel,) = [
            channel
            for channel in animation.channels
            if (channel.target.node, channel.target.path) == (node, path)
        ]
        return self.read(animation.samplers[channel.sampler].output)

    def vertices(self, frame):
        """Morph, then bend: what a viewer draws in one frame."""
        document, (primitive,) = self.document, self.document.meshes[0].primitives
        points = self.read(primitive.attributes.POSITION).astype(float)
        if primitive.targets:
            shares = self.track(document.skins[0].joints[-1] + 1, "weights")
            shares = shares.reshape(-1, len(primitive.targets))[frame]
            steps = [self.read(target["POSITION"]) for target in primitive.targets]
            points = points + np.tensordot(shares, np.array(steps), 1)
        maps = self.joint_maps(frame) @ self.inverse_binds()
        indices = self.read(primitive.attributes.JOINTS_0)
        blended = (self.read(primitive.attributes.WEIGHTS_0)[..., None, None] * maps[indices]).sum(
            1
        )
        return np.einsum("vij,vj->vi", blended[:, :3, :3], points) + blended[:, :3, 3]

    def inverse_binds(self):
        columns = self.read(self.document.skins[0].inverseBindMatrices)
        return columns.reshape(-1, 4, 4).transpose(0, 2, 1)

    def joint_maps(self, frame):
        nodes, world = self.document.nodes, {}
        holder = {child: number for number, node in enumerate(nodes) for child in node.children}
        for number in self.document.skins[0].joints:
            local = np.eye(4)
            x, y, z, w = self.track(number, "rotation")[frame].astype(float)
            local[:3, :3] = (
                (w * w - x * x - y * y - z * z) * np.eye(3)
                + 2 * np.outer((x, y, z), (x, y, z))
                + 2 * w * np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            )
            local[:3, 3] = nodes[number].translation
            if number == 0:
                local[:3, 3] = self.track(0, "translation")[frame]
            world[number] = world[holder[number]] @ local if number in holder else local
        return np.array([world[number] for number in self.document.skins[0].joints])


@pytest.fixture(scope="module")
def body() -> BodyModel:
    return mannequin()


@pytest.fixture(scope="module")
def glb(body, tmp_path_factory) -> Glb:
    path = tmp_path_factory.mktemp("glb") / "motion.glb"
    write_glb(path, waving_motion(20), body)
    return Glb(path)


@pytest.mark.parametrize("make", [mannequin, capsule_body])
def test_a_viewer_draws_what_we_skin(make, tmp_path):
    motion, body = waving_motion(20), make()
    write_glb(tmp_path / "motion.glb", motion, body)
    expected = skin_motion(motion, body).vertices.numpy()
    for frame in (0, 7, 19):
        drawn = Glb(tmp_path / "motion.glb").vertices(frame)
        np.testing.assert_allclose(drawn, expected[frame], atol=1e-4)


def test_bones_and_curves_keep_their_names(glb):
    nodes = glb.document.nodes
    assert [nodes[number].name for number in glb.document.skins[0].joints] == list(JOINT_NAMES)
    assert glb.document.meshes[0].extras["targetNames"] == list(FACE_CURVES)


def test_time_is_in_seconds(glb):
    seconds = glb.read(glb.document.animations[0].samplers[0].input)[:, 0]
    np.testing.assert_allclose(seconds, np.arange(20) / 30, atol=1e-6)


def test_colours_are_linear_light(glb, body):
    stored = glb.read(glb.document.meshes[0].primitives[0].attributes.COLOR_0)
    linear = body.colors.numpy()
    screen = np.where(stored > 0.0031308, 1.055 * stored ** (1 / 2.4) - 0.055, 12.92 * stored)
    np.testing.assert_allclose(screen, linear, atol=1e-5)


def test_quaternions_do_not_jump(body, tmp_path):
    turns = torch.linspace(0, 4 * torch.pi, 60)
    poses = torch.zeros(60, 55, 3)
    poses[:, :, 1] = torch.where(turns > torch.pi, turns - 2 * torch.pi, turns)[:, None]
    motion = Motion(poses, torch.zeros(60, 3), torch.zeros(60, 100), 30)
    write_glb(tmp_path / "turn.glb", motion, body)
    track = Glb(tmp_path / "turn.glb").track(5, "rotation")
    assert (track[1:] * track[:-1]).sum(1).min() > 0.9
    assert axis_angle_to_matrix(poses).diff(dim=0).abs().max() < 0.5  # nor did the motion


def test_a_body_without_face_or_colours_can_be_written(body, tmp_path):
    plain = BodyModel(body.vertices, body.faces, body.weights, body.joints, body.parents)
    motion = waving_motion(2)
    write_glb(tmp_path / "plain.glb", motion, plain)
    drawn = Glb(tmp_path / "plain.glb").vertices(1)
    np.testing.assert_allclose(drawn, skin_motion(motion, plain).vertices[1].numpy(), atol=1e-4)


def test_a_glb_is_small(body, tmp_path):
    write_glb(tmp_path / "motion.glb", waving_motion(300), body)
    assert (tmp_path / "motion.glb").stat().st_size < 1_500_000


def test_another_skeleton_is_refused_and_nothing_is_left(tmp_path):
    joints = torch.zeros(2, 3)
    stick = BodyModel(joints, torch.zeros(0, 3, dtype=torch.int64), torch.eye(2), joints, (-1, 0))
    with pytest.raises(ValueError, match="55 joints, the body 2"):
        write_glb(tmp_path / "stick.glb", waving_motion(2), stick)
    assert list(tmp_path.iterdir()) == []


def test_a_body_without_a_surface_is_refused(body, tmp_path):
    bare = BodyModel(
        body.joints, torch.zeros(0, 3, dtype=torch.int64), torch.eye(55), body.joints, body.parents
    )
    with pytest.raises(ValueError, match="no faces"):
        write_glb(tmp_path / "bare.glb", waving_motion(2), bare)


def test_an_npz_has_the_keys_of_smplx_tools(tmp_path):
    motion = waving_motion(7)
    write_npz(tmp_path / "motion.npz", motion)
    with np.load(tmp_path / "motion.npz") as stored:
        shapes = {name: stored[name].shape for name in stored.files}
        np.testing.assert_array_equal(stored["poses"].reshape(7, 55, 3), motion.poses)
        np.testing.assert_array_equal(stored["s2g_expressions"], motion.expression[:, :12])
        assert stored["s2g_expression_names"].tolist() == list(FACE_CURVES)
        assert stored["mocap_frame_rate"] == 30
        assert str(stored["gender"]) == "neutral"
        assert not stored["expressions"].any()
    assert shapes == {
        "poses": (7, 165),
        "trans": (7, 3),
        "mocap_frame_rate": (),
        "betas": (300,),
        "gender": (),
        "expressions": (7, 100),
        "s2g_expressions": (7, 12),
        "s2g_expression_names": (12,),
    }


def test_a_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "motion.npz"
    write_npz(path, waving_motion(7))
    before = path.read_bytes()

    def full_disk(file, **_):
        file.write(before[:100])
        raise OSError("no space left")

    monkeypatch.setattr("numpy.savez", full_disk)
    with pytest.raises(OSError, match="no space"):
        write_npz(path, waving_motion(9))
    assert path.read_bytes() == before
    assert [left.name for left in tmp_path.iterdir()] == ["motion.npz"]


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_an_npz_comes_back_as_it_was_written(tmp_path, dtype):
    written = waving_motion(20)
    written = Motion(*(getattr(written, name).to(dtype) for name in TRACKS), written.fps)
    write_npz(tmp_path / "motion.npz", written)
    read = read_npz(tmp_path / "motion.npz")
    assert read.fps == written.fps
    assert torch.equal(read.poses, written.poses.float())
    assert torch.equal(read.trans, written.trans.float())
    curves = len(FACE_CURVES)
    assert torch.equal(read.expression[:, :curves], written.expression[:, :curves].float())
    assert not read.expression[:, curves:].any()


TRACKS = ("poses", "trans", "expression")


def test_an_npz_of_other_smplx_tools_has_no_face_of_ours(tmp_path):
    path = tmp_path / "amass.npz"
    poses = np.random.default_rng(0).normal(size=(7, 165))
    np.savez(path, poses=poses, trans=np.ones((7, 3)), mocap_framerate=25, expressions=poses)
    read = read_npz(path)
    np.testing.assert_allclose(read.poses.flatten(1), poses, rtol=1e-6)
    assert read.fps == 25
    assert not read.expression.any()


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({}, "none of them"),
        ({"poses": np.zeros((4, 165)), "trans": np.zeros((4, 3))}, "it has poses, trans"),
        ({"poses": np.zeros((4, 156)), "trans": np.zeros((4, 3)), "mocap_frame_rate": 30}, "165"),
        ({"poses": np.zeros((0, 165)), "trans": np.zeros((0, 3)), "mocap_frame_rate": 30}, "no fr"),
        (
            {"poses": np.zeros((4, 165)), "trans": np.zeros((3, 3)), "mocap_frame_rate": 30},
            "differ",
        ),
        (
            {"poses": np.full((4, 165), np.nan), "trans": np.zeros((4, 3)), "mocap_frame_rate": 30},
            "NaN",
        ),
    ],
)
def test_an_npz_that_holds_no_motion(without_type_hook, tmp_path, fields, reason):
    path = tmp_path / "motion.npz"
    np.savez(path, **fields)
    with pytest.raises(ValueError, match=reason):
        read_npz(path)


def test_what_is_no_npz(tmp_path):
    with pytest.raises(FileNotFoundError, match="no motion file at"):
        read_npz(tmp_path / "none.npz")
    (tmp_path / "text.npz").write_text("a letter")
    with pytest.raises(ValueError, match="no npz"):
        read_npz(tmp_path / "text.npz")
    np.save(tmp_path / "one.npy", np.zeros(3))
    with pytest.raises(ValueError, match="no npz"):
        read_npz(tmp_path / "one.npy")
