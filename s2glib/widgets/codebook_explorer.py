"""The codebook explorer: put another code into a clip's row of codes, and see what the body does.

Paper:    PT A.1
Notebook: notebooks/05_product_codes.ipynb
"""

import ipywidgets
import torch
from jaxtyping import Int
from matplotlib.axes import Axes
from torch import Tensor

from s2glib.body import PELVIS_HEIGHT, BodyModel, Motion, joint, joint_positions
from s2glib.papers.probtalk import PQVAE
from s2glib.papers.probtalk.speech_features import MOTION_FPS
from s2glib.viz import draw_bodies
from s2glib.widgets.player import Player

BEFORE, AFTER = "as it was coded", "with your code"
WATCHED = ("head", "left_elbow", "right_elbow", "left_wrist", "right_wrist")
SAME = "Token {token}, group {group}: this is the clip's own code, {code}."
TOLD = (
    "Token {token}, group {group}: code {code} instead of {own}. "
    "Most is moved the <b>{most}</b>, by {far:.1f} cm; "
    "the clip uses this code {times} times in this group."
)


class CodebookExplorer(ipywidgets.VBox):
    """Choose a token, a group and a code; see the clip as it was coded and with that code.

    Choosing another token or group begins with the clip's own code there.

    Args:
        model: decodes.
        codes: of a clip.
        body: who moves.

    Raises:
        TypeError: if the model is no PQ-VAE, or the codes are no integers.
        ValueError: if the codes are none of the model's.
    """

    def __init__(self, model: PQVAE, codes: Int[Tensor, "tokens groups"], body: BodyModel) -> None:
        self._model, self._codes, self._body = check_model(model), codes, body
        self._clip = self._decoded(codes)
        tokens, groups = codes.shape
        self.token, self.group = _slider("token", tokens), _slider("group", groups)
        self.code = _slider("code", model.config.codes)
        self.code.value = self._own
        self.told = ipywidgets.HTML()
        self.player = Player(self.motions, None, body)
        for each in (self.token, self.group):
            each.observe(self._begin, names="value")
        self.code.observe(self._show, names="value")
        super().__init__([self.token, self.group, self.code, self.player, self.told])
        self._tell()

    def choose(self, *, token: int, group: int, code: int) -> None:
        """Move the sliders, as a reader would."""
        self.token.value, self.group.value = token, group
        self.code.value = code

    @property
    def edited(self) -> Int[Tensor, "tokens groups"]:
        """The clip's codes with the chosen one in its place."""
        codes = self._codes.clone()
        codes[self.token.value, self.group.value] = self.code.value
        return codes

    @property
    def motions(self) -> dict[str, Motion]:
        """The clip as it was coded, and with the chosen code."""
        return {BEFORE: self._clip, AFTER: self._decoded(self.edited)}

    @property
    def moved(self) -> dict[str, float]:
        """How far the code moves head, elbows and wrists at most, in metres."""
        before, after = (joint_positions(each, self._body) for each in self.motions.values())
        farthest = (after - before).norm(dim=-1).amax(0)
        return {name: float(farthest[joint(name)]) for name in WATCHED}

    def draw(self, axes: Axes) -> Axes:
        """Draw both bodies in the middle of the token: what is seen where no kernel runs."""
        frame = round(MOTION_FPS * self._seconds) + self._model.config.window // 2
        pair = self.motions.values()
        poses, trans, expression = (
            torch.stack([getattr(each, track)[frame] for each in pair])
            for track in ("poses", "trans", "expression")
        )
        draw_bodies(axes, Motion(poses, trans, expression, fps=1.0), self._body, (0.0, 1.0))
        axes.set_xticks(axes.get_xticks(), [BEFORE, AFTER])
        axes.set(xlabel=f"token {self.token.value}, group {self.group.value}")
        return axes

    @property
    def _own(self) -> int:
        """The clip's code at the chosen place."""
        return int(self._codes[self.token.value, self.group.value])

    @property
    def _seconds(self) -> float:
        """When the token begins."""
        return self.token.value * self._model.config.window / MOTION_FPS

    @torch.no_grad()
    def _decoded(self, codes: Tensor) -> Motion:
        features = self._model.features
        motion = self._model.decode(codes[None])[0]
        place = motion.new_tensor([0.0, PELVIS_HEIGHT, 0.0]).repeat(len(motion), 1)
        return Motion(features.to_poses(motion), place, features.to_expression(motion), MOTION_FPS)

    def _begin(self, _change) -> None:
        if self.code.value == self._own:
            self._show()
        self.code.value = self._own

    def _show(self, _change=None) -> None:
        with self.player.hold_sync():
            self.player.show(self.motions, None)
            self.player.seek(self._seconds)
        self._tell()

    def _tell(self) -> None:
        place = {name: getattr(self, name).value for name in ("token", "group", "code")}
        words = SAME.format(**place)
        if self.code.value != self._own:
            moved = self.moved
            most = max(moved, key=moved.__getitem__)
            words = TOLD.format(
                **place,
                own=self._own,
                most=most.replace("_", " "),
                far=100 * moved[most],
                times=int((self._codes[:, self.group.value] == self.code.value).sum()),
            )
        self.told.value = f'<p role="status">{words}</p>'

    def __repr__(self) -> str:
        return "CodebookExplorer: a code and its motion. Needs a running kernel; or .draw(axes)"


def check_model(model: PQVAE) -> PQVAE:
    """Refuse what is no PQ-VAE; one in training is set to evaluate."""
    if not isinstance(model, PQVAE):
        raise TypeError(f"model must be a PQVAE, got {type(model).__name__}; load its checkpoint")
    return model.eval()


def _slider(name: str, count: int) -> ipywidgets.IntSlider:
    style, layout = {"description_width": "4em"}, {"width": "36em"}
    return ipywidgets.IntSlider(0, 0, count - 1, description=name, style=style, layout=layout)
