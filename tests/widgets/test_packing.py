import io
from dataclasses import replace

import numpy as np
import pytest
import soundfile
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.spatial.transform import Rotation
from stand_in import tone, waving_motion

from s2glib.body import forward_kinematics, joint_positions
from s2glib.widgets.packing import pack, pack_mesh, pack_motion, pack_sound, quantized_turns

SOME_ARRAY = arrays.arrays(
    st.sampled_from(["<f4", "<i2", "|i1", "<u4", "<u2", "|u1"]),
    arrays.array_shapes(min_dims=1, max_dims=4, min_side=0, max_side=5),
)


@settings(deadline=None, max_examples=30)
@given(st.dictionaries(st.text(max_size=5), SOME_ARRAY, max_size=4))
def test_the_container_gives_back_what_went_in(read, contents):
    found = read(pack(contents, {}))
    assert found.keys() == contents.keys()
    assert all(found[name].tobytes() == contents[name].tobytes() for name in contents)


@settings(deadline=None, max_examples=30)
@given(st.dictionaries(st.text(max_size=5), SOME_ARRAY, max_size=4))
def test_every_array_starts_where_a_typed_array_may(contents):
    data = pack(contents, {"fps": 30})
    assert (4 + int.from_bytes(data[:4], "little")) % 8 == 0
    assert len(data) % 8 == 0


@settings(deadline=None, max_examples=30)
@given(arrays.arrays(np.float64, (6, 3), elements=st.floats(-7, 7)))
def test_turns_are_sent_within_a_ten_thousandth_of_a_radian(poses):
    sent = quantized_turns(torch.tensor(poses[None]))[0]
    found = Rotation.from_quat(sent / 32767, scalar_first=True)
    assert (found * Rotation.from_rotvec(poses).inv()).magnitude().max() < 1e-4


def test_joints_from_the_sent_motion_are_within_half_a_millimetre(read, body, motion):
    sent = read(pack_motion({"": motion}, body))
    matrices = Rotation.from_quat(sent["turns"][0].reshape(-1, 4), scalar_first=True).as_matrix()
    turns = torch.tensor(matrices).float().unflatten(0, (motion.frames, 55))
    joints = forward_kinematics(turns, body.joints, body.parents).positions
    joints = joints + torch.tensor(sent["trans"][0])[:, None]
    assert (joints - joint_positions(motion, body)).norm(dim=-1).max() < 5e-4


def test_ten_seconds_of_two_bodies_and_speech_stay_below_a_megabyte(body):
    pair = {"source": waving_motion(300), "edited": waving_motion(300, reach=2.0)}
    assert len(pack_motion(pair, body)) + len(pack_sound(tone(10), 10.0)) < 1e6


def test_a_short_motion_keeps_its_last_frame(read, body):
    sent = read(pack_motion({"long": waving_motion(9), "short": waving_motion(4)}, body))
    assert (sent["turns"][1, 3:] == sent["turns"][1, 3]).all()
    assert (sent["turns"][0, :4] == sent["turns"][1, :4]).all()


def test_motions_of_two_rates_are_refused(body, motion):
    with pytest.raises(ValueError, match="one frame rate"):
        pack_motion({"a": motion, "b": replace(motion, fps=25)}, body)


def test_the_four_strongest_joints_share_all_of_a_vertex(read, body):
    many = torch.rand(len(body.vertices), 55, generator=torch.Generator().manual_seed(0)) ** 8
    sent = read(pack_mesh(replace(body, weights=many / many.sum(1, keepdim=True))))
    assert (sent["weights"].sum(1, dtype=int) == 65535).all()
    strongest = many.argsort(1, descending=True)[:, :4].numpy()
    assert (np.sort(sent["bones"]) == np.sort(strongest)).all()


def test_normals_of_a_ball_point_away_from_its_middle(read, body):
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=3)
    vertices = torch.tensor(ball.vertices).float()
    round_body = replace(
        body,
        vertices=vertices,
        faces=torch.tensor(ball.faces),
        weights=torch.eye(55)[:1].repeat(len(vertices), 1),
        colors=None,
        expression_directions=None,
    )
    sent = read(pack_mesh(round_body))
    assert np.abs(sent["normals"][:, :3] / 127 - ball.vertices).max() < 0.02
    assert sent["curves"] == 0


def test_the_face_is_sent_only_where_it_moves(read, body):
    sent = read(pack_mesh(body))
    places = sent["directions"][:, :, 0] * sent["reach"] / 32767  # (moving, curves, 3)
    rows = sent["morph"].astype(int)
    expected = body.expression_directions.permute(0, 2, 1).numpy()
    assert np.abs(places[rows[rows >= 0]] - expected[rows >= 0]).max() < 1e-6
    assert not expected[rows < 0].any()
    assert len(places) == (rows >= 0).sum() < len(rows) / 2


def test_the_sound_is_as_long_as_the_motion(waveform):
    samples, rate = soundfile.read(io.BytesIO(pack_sound(waveform, 4.0)), dtype="float32")
    assert (rate, len(samples)) == (16000, 64000)
    assert np.abs(samples[:48000] - waveform.samples).max() < 1e-4
    assert not samples[48000:].any()


def test_a_longer_sound_is_not_cut(waveform):
    assert pack_sound(waveform, 1.0) == pack_sound(waveform, 3.0)


def test_silence_is_no_sound_at_all():
    assert pack_sound(None, 3.0) == b""


def test_a_long_motion_is_quantised_block_by_block(motion, monkeypatch):
    whole = quantized_turns(motion.poses)
    monkeypatch.setattr("s2glib.widgets.packing.BLOCK", 7)
    assert np.array_equal(quantized_turns(motion.poses), whole)
