"""Each sample file opens in every Blender that is supported, is small, and says what to try."""

import bpy
import pytest

from tools import tries
from tools.pictures import SAMPLES

FILES = sorted(path.relative_to(SAMPLES).as_posix() for path in SAMPLES.rglob("*.blend"))
LARGEST = 700_000


@pytest.mark.parametrize("name", FILES)
def test_a_sample_opens_and_says_what_to_try(name: str) -> None:
    path = SAMPLES / name
    assert path.stat().st_size < LARGEST
    bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False)
    assert bpy.data.version[:2] == (4, 5), "it is written by the oldest Blender that is supported"
    assert bpy.data.texts[tries.NAME].as_string() == tries.text_of(name), "run tools.make_samples"
