"""Exercise 01-2: a walk along the bones, from turns to places.

Paper:    PT A.2, AM C.2 (SMPL-X bodies)
Notebook: -
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
import torch
from torch import Tensor

from s2glib.body import PARENTS, REST_JOINTS, axis_angle_to_matrix, forward_kinematics
from s2glib.body.kinematics import _local_maps
from s2glib.teaching.exercises.exercise import Exercise, Mutant

Walk = tuple[Tensor, Tensor]
Step = Callable[[Tensor, Tensor, Tensor, Tensor, Tensor], Walk]


def walk_inputs(rng: np.random.Generator) -> Iterator[tuple[Tensor, Tensor, tuple[int, ...]]]:
    """The arm of the notebook, a bone on a root that is turned, a tree, and the whole body."""
    quarter = axis_angle_to_matrix(torch.tensor([0, 0, np.pi / 2], dtype=torch.float64))
    rest = torch.tensor([[0.0, 0, 0], [0.30, 0, 0], [0.55, 0, 0]], dtype=torch.float64)
    yield quarter.expand(3, 3, 3).clone(), rest, (-1, 0, 1)
    yield quarter.expand(2, 3, 3).clone(), rest[1:], (-1, 0)
    tree = (-1, 0, 1, 1, 0, 4, 2)
    turns = axis_angle_to_matrix(torch.tensor(rng.normal(size=(7, 3))))
    yield turns, torch.tensor(rng.normal(size=(7, 3))), tree
    turns = axis_angle_to_matrix(torch.tensor(rng.normal(size=(55, 3))).float())
    yield turns, torch.tensor(REST_JOINTS).float(), PARENTS


def walk_oracle(rotations: Tensor, rest_joints: Tensor, parents: Sequence[int]) -> Walk:
    """Each joint by itself: its bone is turned by every ancestor, the nearest one first."""
    R, rest = rotations.double().numpy(), rest_joints.double().numpy()
    turns, places = R.copy(), rest.copy()
    for joint in range(len(parents)):
        places[joint] = 0
        child, above = joint, parents[joint]
        while above >= 0:
            turns[joint] = R[above] @ turns[joint]
            places[joint] = R[above] @ (places[joint] + rest[child] - rest[above])
            child, above = above, parents[above]
        places[joint] += rest[child]
    return torch.tensor(turns).to(rotations), torch.tensor(places).to(rest_joints)


def walk_by(step: Step) -> Callable[[Tensor, Tensor, Sequence[int]], Walk]:
    """The walk whose step takes a parent's G and x, a joint's R, and both places at rest."""

    def walk(rotations: Tensor, rest_joints: Tensor, parents: Sequence[int]) -> Walk:
        G, x = [rotations[0]], [rest_joints[0]]
        for joint, p in enumerate(parents[1:], start=1):
            turn, place = step(G[p], x[p], rotations[joint], rest_joints[joint], rest_joints[p])
            G.append(turn)
            x.append(place)
        return torch.stack(G), torch.stack(x)

    return walk


def from_origin(rotations: Tensor, rest_joints: Tensor, parents: Sequence[int]) -> Walk:
    """The root is put at zero."""
    G, x = forward_kinematics(rotations, rest_joints, parents)
    return G, x - rest_joints[0]


WALK = Exercise(
    id="01-2",
    title="walk along the bones",
    reference=forward_kinematics,
    inputs=walk_inputs,
    oracle=walk_oracle,
    minutes=10,
    difficulty=2,
    equation="PT A.2, AM C.2",
    tolerance=1e-5,  # the whole body is in float32
    helpers=(_local_maps,),
    mutants=(
        Mutant(
            walk_by(lambda G, x, R, t, p: (R, x + G @ (t - p))),
            "Your joints forget their parents' turns: G_j is G_p times R_j.",
        ),
        Mutant(
            walk_by(lambda G, x, R, t, p: (R @ G, x + G @ (t - p))),
            "You multiply in the other order: G_j is G_p R_j. "
            "A joint turns about axes that its parent has already turned.",
        ),
        Mutant(
            walk_by(lambda G, x, R, t, p: (G @ R, x + (t - p))),
            "Your bones keep their directions: turn the offset by G_p before you add it.",
        ),
        Mutant(
            walk_by(lambda G, x, R, t, p: (G @ R, x + G @ R @ (t - p))),
            "You turn the offset by the joint's own turn. "
            "The bone that leads to a joint hangs on its parent: use G_p.",
        ),
        Mutant(
            walk_by(lambda G, x, R, t, p: (G @ R, G @ (t - p))),
            "You add no place of the parent: a bone begins where its parent is, at x_p.",
        ),
        Mutant(
            walk_by(lambda G, x, R, t, p: (G @ R, x + G @ t)),
            "Your offset is the joint's place at rest. It is measured from the parent: t_j - t_p.",
        ),
        Mutant(from_origin, "Your root stands at zero. It keeps its own place at rest: x_0 = t_0."),
    ),
    hints=(
        "Make two lists, `G` and `x`. Begin with the root's own turn and place; then go through "
        "the joints in order. A parent always comes before its children.",
        "To the first list, joint `j` with parent `p` adds `G[p] @ rotations[j]`. "
        "Its offset is `rest_joints[j] - rest_joints[p]`.",
        "The second list gets `x[p] + G[p] @ offset`. "
        "At the end, `torch.stack` makes tensors of both.",
    ),
)
