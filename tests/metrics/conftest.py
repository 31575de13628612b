"""Fixtures of the metrics tests."""

import jaxtyping
import numpy as np
import pytest


@pytest.fixture
def rng():
    return np.random.default_rng(0)


@pytest.fixture
def unhooked():
    """Switch jaxtyping's hook off, so that a door answers for itself, as it does for a reader."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)
