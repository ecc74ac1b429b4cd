"""What all tests share: where the real rigs and clips are, and steady random examples."""

import os
from pathlib import Path

import hypothesis
import pytest

ROOT = Path(__file__).resolve().parent.parent
DATA = Path(os.environ.get("MORPH_RETARGET_DATA", ROOT.parent / "shared" / "data"))
"""Real rigs, mocap and truth tables; they are not part of this repository."""

hypothesis.settings.register_profile("steady", derandomize=True, deadline=None, max_examples=60)
hypothesis.settings.load_profile("steady")


def pytest_report_header() -> str:
    if DATA.is_dir():
        return f"real rigs and clips: {DATA}"
    return f"real rigs and clips: none at {DATA}; tests that need them are skipped (set MORPH_RETARGET_DATA)"


@pytest.fixture(scope="session")
def data() -> Path:
    """Return the folder of real rigs and clips, or skip the test."""
    if not DATA.is_dir():
        pytest.skip(f"no real rigs and clips at {DATA}: set MORPH_RETARGET_DATA to their folder")
    return DATA
