"""Many more examples of spoilt files and requests than the test suite tries, other ones every time."""

import os
import subprocess
import sys

from tests.conftest import ROOT

from .figures import Figure

EXAMPLES = 1000
"""Of each law, unless ``MORPH_RETARGET_FUZZ`` says otherwise."""
TESTS = ("tests/core/test_fuzz.py", "tests/blender/test_fuzz_files.py")


def run() -> list[Figure]:
    """Return how many laws were broken, with the examples that break them."""
    own = {"MORPH_RETARGET_FUZZ": str(EXAMPLES)} | dict(os.environ)
    command = [sys.executable, "-m", "pytest", "-q", "--no-header", "--tb=short", *TESTS]
    done = subprocess.run(command, cwd=ROOT, env=own, capture_output=True, text=True, check=False)
    print(done.stdout)
    broken = sum(line.startswith(("FAILED", "ERROR")) for line in done.stdout.splitlines())
    if done.returncode and not broken:
        print(done.stderr)
        broken = 1
    return [Figure(f"fuzz: laws broken by {own['MORPH_RETARGET_FUZZ']} examples of each", float(broken), "", 0.0)]
