import numpy as np
import pytest
import torch

from s2glib.body import (
    FACE_CURVES,
    JOINT_NAMES,
    PELVIS_HEIGHT,
    Motion,
    axis_angle_to_matrix,
    joint,
    skin_motion,
)
from s2glib.body.mannequin import mannequin
from s2glib.corpus import render_motion
from s2glib.corpus.arms import push_out_of_body
from s2glib.corpus.build import timing_of
from s2glib.corpus.script import SPEAKERS, Cell, parse_id
from s2glib.data import GESTURE_TYPES

SIDES = ("left", "right")
FASTEST = 12.0  # m/s, a wrist
FASTEST_TURN = 1.3  # radians from frame to frame, any joint
HAND_POINTS = (0.0, 0.09, 0.17)  # metres from the wrist towards the finger tips


def places(body, name):
    return body.positions[:, joint(name)]


def depth_under(vertices, faces, points):
    """How far points lie below the surface at its nearest vertex, metres; negative outside."""
    a, b, c = vertices[faces].unbind(1)
    normals = torch.zeros_like(vertices).index_add(
        0, faces.flatten(), torch.linalg.cross(b - a, c - a).repeat_interleave(3, dim=0)
    )
    used = faces.unique()
    nearest = used[torch.cdist(points, vertices[used]).argmin(dim=1)]
    outwards = torch.nn.functional.normalize(normals[nearest], dim=1)
    return ((vertices[nearest] - points) * outwards).sum(dim=1)


def wrist_speed(pose_body, clip):
    body = pose_body(clip.motion.poses)
    wrists = torch.stack([places(body, f"{side}_wrist") for side in SIDES])
    return 30 * wrists.diff(dim=1).norm(dim=-1)


def test_the_same_cell_moves_the_same(clips):
    for clip in clips[:3]:
        again = render_motion(parse_id(clip.id))
        assert torch.equal(again.motion.poses, clip.motion.poses)
        assert torch.equal(again.motion.expression, clip.motion.expression)
        assert np.array_equal(again.semantic, clip.semantic)


def test_another_take_or_speaker_moves_differently():
    cell = Cell(1, "voice_01", "fear", 10)
    poses = [
        render_motion(c).motion.poses
        for c in (cell, cell._replace(take=12), cell._replace(speaker="voice_03"))
    ]
    assert poses[0].shape == poses[1].shape == poses[2].shape  # one clock
    assert (poses[0] - poses[1]).abs().max() > 0.1
    assert (poses[0] - poses[2]).abs().max() > 0.1


def test_a_clip_has_one_value_of_everything_per_frame(clips):
    for clip in clips:
        frames = int(timing_of(parse_id(clip.id)).duration * 30)
        assert clip.motion.fps == 30
        assert frames == clip.motion.frames == len(clip.semantic) == len(clip.gesture_type)


def test_semantic_scores_go_with_gesture_types(clips):
    kinds = np.concatenate([clip.gesture_type for clip in clips])
    scores = np.concatenate([clip.semantic for clip in clips])
    assert 0 <= scores.min() <= scores.max() <= 1
    means = [scores[kinds == number].mean() for number in range(len(GESTURE_TYPES))]
    assert means[0] == 0
    assert means[1] < 0.2 < min(means[2:])
    assert 0.2 < (kinds == 0).mean() < 0.8


def test_elbows_never_lock(bodies):
    for body in bodies:
        for side in SIDES:
            upper = places(body, f"{side}_elbow") - places(body, f"{side}_shoulder")
            fore = places(body, f"{side}_wrist") - places(body, f"{side}_elbow")
            bend = torch.arccos(torch.cosine_similarity(upper, fore, dim=-1))
            assert bend.min() > np.deg2rad(15)


def test_hands_stay_out_of_the_head_and_the_torso(bodies, in_chest):
    """In a few clips they dip in for a frame or two: the detour is not iterated."""
    depths = []
    for body in bodies:
        for side, sign in zip(SIDES, (1, -1), strict=True):
            forwards = sign * body.rotations[:, joint(f"{side}_wrist"), :, 0]
            for along in HAND_POINTS:
                point = places(body, f"{side}_wrist") + along * forwards
                depths.append(push_out_of_body(in_chest(body, point)))
    depth = np.concatenate(depths)
    assert (depth > 0.005).mean() < 0.003
    assert depth.max() < 0.06


def test_fingers_stay_out_of_the_mannequins_head_and_torso(clips):
    body = mannequin()
    core = [joint(n) for n in ("pelvis", "spine1", "spine2", "spine3", "neck", "head", "jaw")]
    in_core = torch.isin(body.weights.argmax(1), torch.tensor(core))
    faces = body.faces[in_core[body.faces].all(1)]
    fingers = [joint("left_wrist"), joint("right_wrist"), *range(25, 55)]
    depths = []
    for clip in clips[::2]:
        fields = (getattr(clip.motion, name)[::12] for name in ("poses", "trans", "expression"))
        skinned = skin_motion(Motion(*fields, fps=30), body)
        for vertices, joints in zip(skinned.vertices, skinned.joints, strict=True):
            depths += depth_under(vertices, faces, joints[fingers]).tolist()
    assert (np.array(depths) > 0.015).mean() < 0.001


def test_nothing_jumps_from_frame_to_frame(clips, bodies):
    for clip, body in zip(clips, bodies, strict=True):
        turns = axis_angle_to_matrix(clip.motion.poses)
        trace = (turns[:-1] * turns[1:]).sum(dim=(-2, -1))
        angle = torch.arccos(((trace - 1) / 2).clamp(-1, 1))
        assert angle.max() < FASTEST_TURN, clip.id
        wrists = torch.stack([places(body, f"{side}_wrist") for side in SIDES])
        assert 30 * wrists.diff(dim=1).norm(dim=-1).max() < FASTEST, clip.id


def test_feet_stay_where_they_stand(clips, bodies):
    for clip, body in zip(clips, bodies, strict=True):
        for side in SIDES:
            ankle = places(body, f"{side}_ankle") + clip.motion.trans
            assert (ankle - ankle[0]).norm(dim=-1).max() < 0.008


def test_the_pelvis_sways_a_little_above_its_place(clips):
    for clip in clips:
        moved = clip.motion.trans - torch.tensor([0.0, PELVIS_HEIGHT, 0.0])
        assert moved[:, 1:].abs().max() < 0.005
        assert 0.002 < moved[:, 0].abs().max() < 0.05


def test_legs_do_not_bend_and_eyes_do_not_roll(clips):
    still = [joint(n) for n in JOINT_NAMES if n.endswith(("knee", "foot", "eye"))]
    for clip in clips:
        assert (clip.motion.poses[:, still] == 0).all()


def test_the_face_uses_its_named_curves_only(clips):
    for clip in clips:
        assert (clip.motion.expression[:, len(FACE_CURVES) :] == 0).all()
        assert clip.motion.expression.min() >= 0
        assert clip.motion.expression.max() <= 1


def test_anger_moves_its_hands_faster_than_sadness(pose_body):
    speeds = {
        emotion: np.mean(
            [
                wrist_speed(pose_body, render_motion(Cell(s % 16, speaker, emotion, 2))).mean()
                for s, speaker in enumerate(SPEAKERS)
            ]
        )
        for emotion in ("anger", "sadness")
    }
    assert speeds["anger"] > 1.5 * speeds["sadness"]


def test_hands_turn_round_on_stressed_vowels(clips, pose_body):
    """Local minima of hand speed lie nearer to stresses than to moments half-way between them."""
    on, between = [], []
    for clip in clips:
        speed = wrist_speed(pose_body, clip).sum(0).numpy()
        low = 1 + np.flatnonzero((speed[1:-1] < speed[:-2]) & (speed[1:-1] < speed[2:]))
        minima = (low + 1) / 30  # speed i is between frames i and i + 1
        stresses = clip.stress_times
        middles = (stresses[1:] + stresses[:-1]) / 2
        on += [np.abs(minima - s).min() for s in stresses]
        between += [np.abs(minima - s).min() for s in middles]
    assert np.median(on) < 0.6 * np.median(between)


@pytest.mark.parametrize("emotion", ["sadness", "surprise"])
def test_posture_follows_the_emotion(pose_body, emotion):
    """Sad hands hang and heads sink; surprised hands and shoulders rise."""
    heights = {}
    for name in ("neutral", emotion):
        poses = [render_motion(Cell(1, speaker, name, 2)).motion.poses for speaker in SPEAKERS[:16]]
        body = pose_body(torch.cat(poses))
        wrists = [places(body, f"{side}_wrist")[:, 1].mean() for side in SIDES]
        heights[name] = float(sum(wrists))
    higher = heights[emotion] - heights["neutral"]
    assert higher > 0.05 if emotion == "surprise" else higher < -0.05
