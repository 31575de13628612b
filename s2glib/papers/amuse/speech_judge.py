"""An independent judge of speech: it hears only real clips and then listens to decoded ones.

Paper:    AM Tab. A.1-A.2 leave open whether swapped speech is recognised; judge: ours
Notebook: notebooks/09_disentanglement.ipynb
"""

from typing import NamedTuple

from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.papers.amuse.config import SpeechConfig
from s2glib.papers.amuse.temporal_backbone import PooledEncoder

_WIDTH = 64


class SpeechOpinion(NamedTuple):
    """Scores for who speaks, and in which emotion."""

    emotion: Float[Tensor, "batch emotions"]
    style: Float[Tensor, "batch styles"]


class SpeechJudge(nn.Module):
    """A network of its own, trained on real filterbanks only."""

    config_class = SpeechConfig

    def __init__(self, config: SpeechConfig):
        super().__init__()
        self.config = config
        self.listen = PooledEncoder(config, _WIDTH)
        self.emotion = nn.Linear(_WIDTH, config.emotions)
        self.style = nn.Linear(_WIDTH, config.styles)

    def forward(self, filterbank: Float[Tensor, "batch frames mels"]) -> SpeechOpinion:
        """Judge standardised filterbanks."""
        heard = F.gelu(self.listen(filterbank))
        return SpeechOpinion(self.emotion(heard), self.style(heard))
