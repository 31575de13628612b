import pytest
import torch

from s2glib.quantization import Codebook, ProductQuantizer, ResidualQuantizer

QUANTIZERS = {
    "plain": lambda **options: Codebook(8, 6, **options),
    "product": lambda **options: ProductQuantizer(3, 8, 6, **options),
    "residual": lambda **options: ResidualQuantizer(3, 8, 6, **options),
}


@pytest.fixture(params=QUANTIZERS.values(), ids=QUANTIZERS.keys())
def make(request):
    """One way after the other to quantise vectors of six channels with books of eight codes."""
    torch.manual_seed(0)
    return request.param


@pytest.fixture
def z():
    return torch.randn(4, 5, 6, generator=torch.Generator().manual_seed(1))
