"""AMUSE: speech taken apart into content, emotion and style; gestures by latent diffusion."""

from s2glib.papers.amuse.config import (
    PAPER_DENOISER,
    PAPER_EXTRACTOR,
    PAPER_PRIOR,
    PAPER_SPEECH,
    TEACHING_DENOISER,
    TEACHING_EXTRACTOR,
    TEACHING_PRIOR,
    TEACHING_SPEECH,
    DenoiserConfig,
    ExtractorConfig,
    PriorConfig,
    SpeechConfig,
)
from s2glib.papers.amuse.cross_reconstruction import (
    Donors,
    FactorSwapLosses,
    QuadrupleLosses,
    factor_swap_losses,
    latent_reliance,
    quadruple_losses,
    swap_partner,
)
from s2glib.papers.amuse.disentangler import SpeechDisentangler, SpeechLatents
from s2glib.papers.amuse.front_end import rhythm, speech_input, standardized, time_tracks
from s2glib.papers.amuse.latent_denoiser import LatentDenoiser, SpeechCondition
from s2glib.papers.amuse.motion_extractor import Judgement, MotionExtractor, PositionJudge
from s2glib.papers.amuse.motion_features import (
    MotionFeatures,
    UpperBodyFeatures,
    WholeBodyFeatures,
    motion_features,
)
from s2glib.papers.amuse.motion_prior import (
    MotionPosterior,
    MotionPrior,
    PriorLosses,
    prior_losses,
)
from s2glib.papers.amuse.pipeline import Amuse, Heard, Sampling
from s2glib.papers.amuse.speech_decoder import FilterbankDecoder, Fusion
from s2glib.papers.amuse.speech_encoder import PatchEncoder, patch_grid
from s2glib.papers.amuse.speech_face import FaceConfig, SpeechFace
from s2glib.papers.amuse.speech_judge import SpeechJudge, SpeechOpinion
from s2glib.papers.amuse.stitching import agreeing, blend, cut, mend_joins, window_starts
from s2glib.papers.amuse.stress_listener import StressConfig, StressListener, heard_rhythm
from s2glib.papers.amuse.temporal_prior import start_from_components

__all__ = [
    "PAPER_DENOISER",
    "PAPER_EXTRACTOR",
    "PAPER_PRIOR",
    "PAPER_SPEECH",
    "TEACHING_DENOISER",
    "TEACHING_EXTRACTOR",
    "TEACHING_PRIOR",
    "TEACHING_SPEECH",
    "Amuse",
    "DenoiserConfig",
    "Donors",
    "ExtractorConfig",
    "FaceConfig",
    "FactorSwapLosses",
    "FilterbankDecoder",
    "Fusion",
    "Heard",
    "Judgement",
    "LatentDenoiser",
    "MotionExtractor",
    "MotionFeatures",
    "MotionPosterior",
    "MotionPrior",
    "PatchEncoder",
    "PositionJudge",
    "PriorConfig",
    "PriorLosses",
    "QuadrupleLosses",
    "Sampling",
    "SpeechCondition",
    "SpeechConfig",
    "SpeechDisentangler",
    "SpeechFace",
    "SpeechJudge",
    "SpeechLatents",
    "SpeechOpinion",
    "StressConfig",
    "StressListener",
    "UpperBodyFeatures",
    "WholeBodyFeatures",
    "agreeing",
    "blend",
    "cut",
    "factor_swap_losses",
    "heard_rhythm",
    "latent_reliance",
    "mend_joins",
    "motion_features",
    "patch_grid",
    "prior_losses",
    "quadruple_losses",
    "rhythm",
    "speech_input",
    "standardized",
    "start_from_components",
    "swap_partner",
    "time_tracks",
    "window_starts",
]
