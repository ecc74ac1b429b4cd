"""The shelf: all recipes that come with the product."""

from functools import cache
from pathlib import Path

from .recipe import Recipe, parse

FOLDER = Path(__file__).parent


@cache
def recipes() -> tuple[Recipe, ...]:
    """Return all recipes, by name."""
    paths = sorted(FOLDER.glob("*.json"))
    return tuple(parse(path.read_text(encoding="utf-8"), path.name) for path in paths)


def kinds() -> tuple[str, ...]:
    """Return what there are recipes for."""
    return tuple(dict.fromkeys(recipe.kind for recipe in recipes()))
