"""Quantisation: a vector becomes the number of the nearest entry of a table."""

from s2glib.quantization.codebook import Codebook, Quantized, straight_through
from s2glib.quantization.moving_average import ClusterTotals, MovingAverage, running_totals
from s2glib.quantization.product import ProductQuantizer
from s2glib.quantization.residual import ResidualQuantizer
from s2glib.quantization.tables import nearest_codes
from s2glib.quantization.usage import code_counts, dead_codes, perplexity

__all__ = [
    "ClusterTotals",
    "Codebook",
    "MovingAverage",
    "ProductQuantizer",
    "Quantized",
    "ResidualQuantizer",
    "code_counts",
    "dead_codes",
    "nearest_codes",
    "perplexity",
    "running_totals",
    "straight_through",
]
