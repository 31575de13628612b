"""Building blocks that more than one system uses."""

from s2glib.layers.attention import SelfAttention
from s2glib.layers.conditioning import AdaptiveLayer, FiLM
from s2glib.layers.embeddings import fixed_positions, sinusoidal_embedding
from s2glib.layers.temporal_conv import ContextBlock, ResidualConv, TimeResampling
from s2glib.layers.transformer import SkipTransformer, TransformerLayer

__all__ = [
    "AdaptiveLayer",
    "ContextBlock",
    "FiLM",
    "ResidualConv",
    "SelfAttention",
    "SkipTransformer",
    "TimeResampling",
    "TransformerLayer",
    "fixed_positions",
    "sinusoidal_embedding",
]
