"""Entrance of the Blender extension; the work is done in `morph_retarget`."""


def register() -> None:
    """Register the extension."""
    from .morph_retarget.blender import registration

    registration.register(__package__)


def unregister() -> None:
    """Unregister the extension."""
    from .morph_retarget.blender import registration

    registration.unregister()
