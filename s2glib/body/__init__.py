"""Bodies: the skeleton, rotations, motions, skinned surfaces, and their files."""

from s2glib.body.bvh import Bvh, read_bvh, write_bvh
from s2glib.body.export import read_npz, write_glb, write_npz
from s2glib.body.keypoints2d import BODY_POINTS, HAND_POINTS, upper_body_points
from s2glib.body.kinematics import Kinematics, forward_kinematics
from s2glib.body.mannequin import build_mannequin, mannequin, save_mannequin
from s2glib.body.motion import Motion, joint_positions, skin_motion
from s2glib.body.rotations import (
    axis_angle_to_matrix,
    matrix_to_axis_angle,
    matrix_to_sixd,
    sixd_to_matrix,
)
from s2glib.body.skeleton import (
    FACE_CURVES,
    FINGERS,
    JOINT_NAMES,
    PARENTS,
    PELVIS_HEIGHT,
    REST_JOINTS,
    REST_OFFSETS,
    joint,
)
from s2glib.body.skinning import BodyModel, Skinned, linear_blend_skinning
from s2glib.body.smplx import load_smplx

__all__ = [
    "BODY_POINTS",
    "FACE_CURVES",
    "FINGERS",
    "HAND_POINTS",
    "JOINT_NAMES",
    "PARENTS",
    "PELVIS_HEIGHT",
    "REST_JOINTS",
    "REST_OFFSETS",
    "BodyModel",
    "Bvh",
    "Kinematics",
    "Motion",
    "Skinned",
    "axis_angle_to_matrix",
    "build_mannequin",
    "forward_kinematics",
    "joint",
    "joint_positions",
    "linear_blend_skinning",
    "load_smplx",
    "mannequin",
    "matrix_to_axis_angle",
    "matrix_to_sixd",
    "read_bvh",
    "read_npz",
    "save_mannequin",
    "sixd_to_matrix",
    "skin_motion",
    "upper_body_points",
    "write_bvh",
    "write_glb",
    "write_npz",
]
