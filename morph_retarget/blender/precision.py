"""Numbers as they were written: Blender keeps its properties in single precision."""


def plain(number: float) -> float:
    """Return the shortest number that a property of Blender's may stand for: 1.2 rather than 1.2000000477."""
    return float(f"{number:.7g}")
