"""A toy arm with two bones: turn shoulder and elbow, and see where forward kinematics takes it.

Paper:    PT A.2, AM C.2 (SMPL-X bodies)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import math
from collections.abc import Mapping, Sequence
from typing import ClassVar

import torch

from s2glib.body import axis_angle_to_matrix, forward_kinematics
from s2glib.widgets.demo import Demo, Panel, Slider

REST = ((0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.55, 0.0, 0.0))  # metres: shoulder, elbow, hand
PARENTS = (-1, 0, 1)
_PIXELS = 240  # a metre
_PICTURE = """<svg viewBox="0 0 320 320" width="320" height="320">
<path d="M0 160H320M160 0V320" stroke="#cccccc"/>
<path d="M{points}" fill="none" stroke="#0072B2" stroke-width="12" stroke-linejoin="round"/>
<circle cx="{hand[0]}" cy="{hand[1]}" r="9" fill="#D55E00"/>
<path d="M280 154V166M154 40H166" stroke="#666666"/>
<text x="258" y="190" font-size="20">0.5 m</text><text x="172" y="47" font-size="20">0.5 m</text>
<text x="302" y="152" font-size="20">x</text><text x="142" y="18" font-size="20">y</text>
</svg>"""


class ToyArm(Demo):
    """Two turns about the z axis, in degrees; the hand's place in metres."""

    controls: ClassVar[Mapping[str, Slider]] = {
        "shoulder": Slider(-180, 180, 0, 15),
        "elbow": Slider(-180, 180, 0, 15),
    }
    grid: ClassVar[Sequence[Mapping[str, object]]] = (
        {},
        {"shoulder": 90},
        {"elbow": 90},
        {"shoulder": 90, "elbow": 90},
        {"shoulder": -180, "elbow": 165},
    )

    def render(self, shoulder: int, elbow: int) -> Panel:
        """Draw the arm with its shoulder in the middle."""
        turns = torch.zeros(3, 3, dtype=torch.float64)
        turns[:2, 2] = torch.tensor([shoulder, elbow]).deg2rad()
        rest = torch.tensor(REST, dtype=torch.float64)
        places = forward_kinematics(axis_angle_to_matrix(turns), rest, PARENTS).positions
        pixels = [
            (160 + round(_PIXELS * x), 160 - round(_PIXELS * y)) for x, y, _ in places.tolist()
        ]
        x, y = (round(value, 2) + 0.0 for value in places[2, :2].tolist())
        picture = _PICTURE.format(points=" ".join(f"{a} {b}" for a, b in pixels), hand=pixels[2])
        alt = f"Shoulder {shoulder}°, elbow {elbow}°: the hand is at x = {x:.2f} m, y = {y:.2f} m."
        return Panel(picture, alt, {"x": x, "y": y, "reach": math.hypot(x, y)})
