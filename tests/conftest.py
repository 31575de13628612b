"""What every test shares."""

import jaxtyping
import pytest
from hypothesis import settings

settings.register_profile("s2glib", deadline=None)  # a deadline would be a timed test
settings.load_profile("s2glib")


@pytest.fixture
def without_type_hook():
    """What a reader meets: no shape checks at run time, only our own refusals."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)
