"""ProbTalk: holistic motion as product codes, predicted from speech, and refined."""

from s2glib.papers.probtalk.config import (
    FEATURE_PRESETS,
    PAPER_FEATURES,
    PAPER_PQVAE,
    PAPER_PREDICTOR,
    PAPER_REFINER,
    PQVAE_PRESETS,
    PREDICTOR_PRESETS,
    REFINER_PRESETS,
    TEACHING_FEATURES,
    TEACHING_PQVAE,
    TEACHING_PREDICTOR,
    TEACHING_REFINER,
    FeatureConfig,
    PQVAEConfig,
    PredictorConfig,
    RefinerConfig,
)
from s2glib.papers.probtalk.feature_autoencoder import (
    FeatureAutoencoder,
    FeatureLosses,
    FeatureNets,
    feature_losses,
    split_windows,
)
from s2glib.papers.probtalk.masking import (
    DecodingStep,
    hide_tokens,
    masked_share,
    part_contexts,
    random_shares,
    remask_counts,
    window_contexts,
)
from s2glib.papers.probtalk.motion_features import JOINTS_OF, PARTS, HolisticFeatures
from s2glib.papers.probtalk.pipeline import (
    Asked,
    ProbTalk,
)
from s2glib.papers.probtalk.pqvae import PQVAE, PQReconstruction, PQVAELosses, pqvae_losses
from s2glib.papers.probtalk.predictor import (
    Predictor,
)
from s2glib.papers.probtalk.refiner import (
    Refiner,
    RefinerLosses,
    fill,
    refiner_losses,
)
from s2glib.papers.probtalk.speech_features import (
    at_motion_rate,
    log_mels,
    wav2vec2,
)
from s2glib.papers.probtalk.style_decoder import (
    StyleDecoder,
    StyleLayer,
    adaptive_instance_norm,
)

__all__ = [
    "FEATURE_PRESETS",
    "JOINTS_OF",
    "PAPER_FEATURES",
    "PAPER_PQVAE",
    "PAPER_PREDICTOR",
    "PAPER_REFINER",
    "PARTS",
    "PQVAE",
    "PQVAE_PRESETS",
    "PREDICTOR_PRESETS",
    "REFINER_PRESETS",
    "TEACHING_FEATURES",
    "TEACHING_PQVAE",
    "TEACHING_PREDICTOR",
    "TEACHING_REFINER",
    "Asked",
    "DecodingStep",
    "FeatureAutoencoder",
    "FeatureConfig",
    "FeatureLosses",
    "FeatureNets",
    "HolisticFeatures",
    "PQReconstruction",
    "PQVAEConfig",
    "PQVAELosses",
    "Predictor",
    "PredictorConfig",
    "ProbTalk",
    "Refiner",
    "RefinerConfig",
    "RefinerLosses",
    "StyleDecoder",
    "StyleLayer",
    "adaptive_instance_norm",
    "at_motion_rate",
    "feature_losses",
    "fill",
    "hide_tokens",
    "log_mels",
    "masked_share",
    "part_contexts",
    "pqvae_losses",
    "random_shares",
    "refiner_losses",
    "remask_counts",
    "split_windows",
    "wav2vec2",
    "window_contexts",
]
