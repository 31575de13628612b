"""ProbTalk's sizes: what the paper prints, and the small models that train on a laptop.

Every number says where it comes from: a section, the authors' code, or ours.

Paper:    PT A.1-A.3
Notebook: notebooks/05_product_codes.ipynb
"""

from dataclasses import dataclass, replace
from typing import Literal

KEPT_JOINTS = 46  # jaw, 15 of the body, 30 of the hands; authors' code


@dataclass(frozen=True)
class PQVAEConfig:
    """The PQ-VAE: motion to product codes, eight frames a token, and back."""

    frames: int = 176  # of a window; authors' code
    expression: int = 100  # face coefficients; authors' code. Our corpus has 12 curves
    statistics: Literal["shared", "centred"] = "shared"  # authors' code; "centred": ours
    widths: tuple[int, int, int, int] = (256, 256, 512, 1024)  # fine to coarse; authors' code
    convolutions: int = 3  # of a residual block  [PT A.1]
    straight: int = 0  # components of a linear path beside the networks; ours
    latent: int = 512  # what is quantised; authors' code
    quantizer: Literal["product", "plain", "residual"] = "product"  # the others: compared
    groups: int = 4  # G; of "residual" the stages; authors' code
    codes: int = 128  # of a group; authors' code
    decay: float = 0.99  # of the codes' moving averages; authors' code
    revive_below: float = 1.0  # uses a batch, averaged; authors' code
    commitment: float = 0.25  # authors' code
    wrists: float = 0.0  # weight in the loss of how far wrists are off, per metre; ours
    movement: float = 0.0  # weight of how differently points move, per metre a frame; ours

    def __post_init__(self):
        if self.frames % self.window:
            raise ValueError(f"windows are multiples of {self.window} frames, got {self.frames}")
        if self.quantizer == "plain" and self.groups != 1:
            raise ValueError(f"a plain codebook has 1 group, got groups={self.groups}")
        if self.straight > self.latent:
            raise ValueError(
                f"{self.straight} components of a straight path do not fit a latent of "
                f"{self.latent} numbers; take fewer"
            )

    @property
    def window(self) -> int:
        """Frames of a token: w = 8  [PT A.1]."""
        return 2 ** (len(self.widths) - 1)

    @property
    def tokens(self) -> int:
        """Tokens in time of a window: 22."""
        return self.frames // self.window

    @property
    def size(self) -> int:
        """Numbers of a frame: 376 in the paper, 288 for our corpus."""
        return 6 * KEPT_JOINTS + self.expression


PAPER_PQVAE = PQVAEConfig()

TEACHING_PQVAE = replace(
    PAPER_PQVAE,
    expression=12,
    statistics="centred",
    widths=(40, 40, 48, 64),
    straight=64,
    decay=0.95,
    revive_below=0.15,
    commitment=3.0,
    wrists=4.0,
    movement=40.0,
)

PQVAE_PRESETS = {"paper": PAPER_PQVAE, "teaching": TEACHING_PQVAE}


@dataclass(frozen=True)
class PredictorConfig:
    """The Predictor: speech and given motion; the codes of all tokens."""

    motion: int = 376  # numbers of a frame; authors' code
    speech: int = 768  # numbers a frame: wav2vec2; authors' code
    context_parts: int = 1  # columns of the mask; authors' code. 4, one for each part: ours
    groups: int = 4  # G; authors' code
    codes: int = 128  # of a group; authors' code
    speakers: int = 4  # authors' code
    aligned: bool = False  # tokens begin with what is heard at their time; True: ours
    own_codes: bool = False  # code 5 is one vector in all groups; True, one in each: ours
    audio_width: int = 256  # authors' code
    context_widths: tuple[int, int, int] = (128, 256, 512)  # authors' code
    width: int = 512  # authors' code
    heads: int = 8  # authors' code
    layers: int = 6  # [PT A.2]
    hidden: int = 2048  # authors' code
    style: int = 512  # numbers for a speaker; authors' code
    style_norm: Literal["adain", "adaln"] = "adain"  # [PT A.2]; "adaln": authors' code
    dropout: float = 0.1  # authors' code
    guidance: float = 1.0  # how much speech counts in decoding; not 1: ours, found after training


@dataclass(frozen=True)
class RefinerConfig:
    """The Refiner: motion decoded from codes, and speech; refined motion at the same rate."""

    expression: int = 100  # face coefficients; authors' code
    speech: int = 768  # numbers a frame: wav2vec2; authors' code
    context_parts: int = 1  # columns of the mask; authors' code. 4, one for each part: ours
    speakers: int = 4  # authors' code
    width: int = 512  # authors' code
    heads: int = 8  # authors' code
    layers: int = 6  # "akin to the Predictor's decoder"  [PT A.3]
    hidden: int = 2048  # authors' code
    style: int = 512  # numbers for a speaker; authors' code
    style_norm: Literal["adain", "adaln"] = "adain"  # [PT A.2]; "adaln": authors' code
    head: int = 1024  # width of the output network's middle; authors' code
    dropout: float = 0.1  # authors' code
    eased: bool = False  # the input leaves what is known without a jump; True: ours
    aligned: bool = False  # a frame begins with what is heard in it; True: ours
    reach: int = 1  # frames that the input layers see at once; authors' code. More: ours
    noise: float = 0.05  # on what the PQ-VAE rebuilt, in training; authors' code, not in the text
    adds: bool = False  # predict what to add to the input; True: ours


@dataclass(frozen=True)
class FeatureConfig:
    """The auto-encoders that FGD is measured with: all numbers are the authors' code's."""

    expression: int = 100  # face coefficients
    frames: int = 90  # of a window
    widths: tuple[int, int, int, int] = (32, 64, 64, 32)  # of the convolutions
    hidden: tuple[int, int] = (512, 256)  # between convolutions and features
    code: int = 128  # features of a window
    decoder_widths: tuple[int, int] = (8, 32)
    slope: float = 0.2  # of the linear layers' LeakyReLU; the code's `LeakyReLU(True)` means 1


PAPER_PREDICTOR = PredictorConfig()
PAPER_REFINER = RefinerConfig()
PAPER_FEATURES = FeatureConfig()

TEACHING_PREDICTOR = replace(
    PAPER_PREDICTOR,
    motion=288,
    speech=64,
    context_parts=4,
    speakers=24,
    aligned=True,
    own_codes=True,
    audio_width=80,
    context_widths=(40, 56, 80),
    width=128,
    heads=4,
    layers=3,
    hidden=256,
    style=32,
    style_norm="adaln",
    dropout=0.0,
)
TEACHING_REFINER = replace(
    PAPER_REFINER,
    expression=12,
    speech=64,
    context_parts=4,
    speakers=24,
    width=128,
    heads=4,
    layers=3,
    hidden=256,
    style=32,
    head=256,
    dropout=0.0,
    eased=True,
    aligned=True,
    reach=5,
    adds=True,
)
TEACHING_FEATURES = replace(
    PAPER_FEATURES,
    expression=12,
    frames=88,
    widths=(24, 24, 24, 8),
    hidden=(64, 48),
    code=32,
    decoder_widths=(4, 24),
)

PREDICTOR_PRESETS = {"paper": PAPER_PREDICTOR, "teaching": TEACHING_PREDICTOR}
REFINER_PRESETS = {"paper": PAPER_REFINER, "teaching": TEACHING_REFINER}
FEATURE_PRESETS = {"paper": PAPER_FEATURES, "teaching": TEACHING_FEATURES}
