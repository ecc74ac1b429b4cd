"""What all tests share: where the real rigs and clips are, and steady random examples."""

import gc
import os
import sys
from pathlib import Path

# One thread for each of as many processes as cores; NumPy asks for this when it is first imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import bpy
import hypothesis
import pytest

ROOT = Path(__file__).resolve().parent.parent
DATA = Path(os.environ.get("MORPH_RETARGET_DATA", ROOT.parent / "shared" / "data"))
"""Real rigs, mocap and truth tables; they are not part of this repository."""

# Blender as a module sets it for the processes that it starts, and these say so where tests expect JSON alone.
os.environ.pop("OCIO", None)

hypothesis.settings.register_profile("steady", derandomize=True, deadline=None, max_examples=60)
hypothesis.settings.load_profile("steady")


_status: list[int] = []


def pytest_collection_finish() -> None:
    """Spare all that was loaded and collected when Python looks for what can be freed: it stays until the end."""
    gc.collect()
    gc.freeze()


def pytest_sessionfinish(exitstatus: int) -> None:
    _status.append(int(exitstatus))


@pytest.hookimpl(trylast=True)
def pytest_unconfigure() -> None:
    """Leave at once with Blender 4.5 as a module: a thread of its own may block its end."""
    if _status and bpy.app.version < (5, 0):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(_status[0])


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
