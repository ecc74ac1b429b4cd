"""What a character can be told: names of motions and behaviours, and what can be said about each.

This is asked while panels are drawn, so nothing is made for it: motions count once they have been read or made.
"""

from collections.abc import Callable, Mapping, Sequence
from weakref import WeakKeyDictionary

import bpy

from ...core.clips.behaviours.registry import BEHAVIOURS
from ...core.clips.commands.parameters import Parameter, Parameters
from ...core.clips.models.models import models_of
from ...core.clips.motions.library import Library
from ...core.directing import starter

TARGET = "target"
"""The parameter that names an object, in all behaviours."""

finders: list[Callable[[bpy.types.Object], Library | None]] = []
"""Tell the library of a character, None for one that is not known yet; the first that knows counts."""
_parameters: WeakKeyDictionary[Library, Mapping[str, Parameters]] = WeakKeyDictionary()


def groups(ob: bpy.types.ID) -> Mapping[str, Sequence[str]]:
    """Return the names of all that a character can be told, by what they are."""
    library = _library(ob)
    named = bool(ob.morph_retarget.directing.library)  # type: ignore[attr-defined]
    kinds = library.kinds if library is not None else ()
    motions = kinds if named else dict.fromkeys([*starter.kinds_of_starter(), *kinds])
    return {"Motions": sorted(motions), "Behaviors": list(BEHAVIOURS)}


def models(ob: bpy.types.ID) -> Sequence[str]:
    """Return the same names one after the other."""
    return [name for names in groups(ob).values() for name in names]


def parameters(ob: bpy.types.ID, model: str) -> Mapping[str, Parameter]:
    """Return what can be said to a character about a motion or a behaviour; nothing for one that is not known."""
    if model in BEHAVIOURS:
        return BEHAVIOURS[model].parameters
    library = _library(ob)
    if library is None:
        return {}
    found = _parameters.get(library)
    if found is None:
        found = _parameters[library] = {name: own.parameters for name, own in models_of(library).items()}
    return found.get(model, {})


def needed(ob: bpy.types.ID, model: str) -> list[str]:
    """Return what has to be said about a motion or a behaviour, for it to make sense."""
    if model in BEHAVIOURS and BEHAVIOURS[model].is_aimed:
        return [TARGET]
    return [name for name, one in parameters(ob, model).items() if one.needed]


def _library(ob: bpy.types.ID) -> Library | None:
    if not isinstance(ob, bpy.types.Object):
        return None
    return next((found for finder in finders if (found := finder(ob)) is not None), None)
