"""Building blocks that more than one system uses."""

from s2glib.layers.attention import SelfAttention
from s2glib.layers.batches import in_batches
from s2glib.layers.conditioning import AdaptiveLayer, FiLM
from s2glib.layers.embeddings import fixed_positions, sinusoidal_embedding
from s2glib.layers.gated_conv import GatedConv, gated
from s2glib.layers.image_blocks import (
    DownBlock,
    Hourglass,
    ResidualBlock,
    SameBlock,
    UpBlock,
    shrink,
)
from s2glib.layers.image_networks import (
    PyramidFeatures,
    ResNet,
    VGGFeatures,
    load_public,
    vgg16_features,
    vgg19_features,
)
from s2glib.layers.temporal_conv import ContextBlock, ResidualConv, TimeResampling
from s2glib.layers.transformer import SkipTransformer, TransformerLayer

__all__ = [
    "AdaptiveLayer",
    "ContextBlock",
    "DownBlock",
    "FiLM",
    "GatedConv",
    "Hourglass",
    "PyramidFeatures",
    "ResNet",
    "ResidualBlock",
    "ResidualConv",
    "SameBlock",
    "SelfAttention",
    "SkipTransformer",
    "TimeResampling",
    "TransformerLayer",
    "UpBlock",
    "VGGFeatures",
    "fixed_positions",
    "gated",
    "in_batches",
    "load_public",
    "shrink",
    "sinusoidal_embedding",
    "vgg16_features",
    "vgg19_features",
]
