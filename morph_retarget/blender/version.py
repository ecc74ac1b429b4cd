"""Which version this is, as reports say it; the manifest is the one place that knows."""

import tomllib
from pathlib import Path

import bpy

_MANIFEST = Path(__file__).resolve().parents[2] / "blender_manifest.toml"


def told() -> str:
    """Return the product and its version, and Blender's."""
    own = tomllib.loads(_MANIFEST.read_text(encoding="utf-8"))
    return f"{own['name']} {own['version']}, Blender {bpy.app.version_string}"
