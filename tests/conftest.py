"""What the tests share: the folder of the project, and a small course to hand out and grade."""

from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def home() -> Path:
    """The folder of the project."""
    return Path(__file__).parent.parent
