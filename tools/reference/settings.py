"""Settings, from the properties that Blender shows and files keep."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from morph_retarget.blender.morph.properties import MORPHRETARGET_PG_action
from morph_retarget.blender.properties import CLASSES
from morph_retarget.blender.rig_properties import MORPHRETARGET_PG_rig
from morph_retarget.blender.scene_properties import MORPHRETARGET_PG_scene

from .markdown import code, page, table

_CLASSES: Mapping[str, Any] = {cls.__name__: cls for cls in CLASSES}
_PREFIX = "MORPHRETARGET_PG_"
_SCENE = """
What the panels set, and scripts may: `bpy.context.scene.morph_retarget.…` for what shall be done, and
`bpy.data.objects["Hero"].morph_retarget.…` for what is known about an armature and how it plays. All is kept in the
file; most of what armatures have can be changed on library overrides. Channels of actions have a page of their own:
[channels](channels.md).
"""
_CHANNELS = """
A generalized action keeps its channels in `bpy.data.actions["Wave"].morph_retarget`. What the parts are for, and how
they work together: [generalized actions](../generalized-actions.md). The values that are keyed are on the characters,
`object.morph_retarget.channels["Right Hand"].position` and so on, so that curves, drivers and NLA strips reach them.
"""


def settings() -> str:
    """Return the page of scenes' and armatures' settings."""
    scene = _groups("scene.morph_retarget", MORPHRETARGET_PG_scene, {})
    rig = _groups("object.morph_retarget", MORPHRETARGET_PG_rig, {})
    return page("Settings", _SCENE.strip(), *scene, *rig)


def channels() -> str:
    """Return the page of generalized actions, their channels and movement modes."""
    return page("Channels", _CHANNELS.strip(), *_groups("action.morph_retarget", MORPHRETARGET_PG_action, {}))


def _groups(path: str, group: Any, known: dict[str, str]) -> Iterator[str]:
    """Yield a section for a group, then those of the groups in it, each once."""
    rna = group.bl_rna
    known[rna.identifier] = path
    shown = [own for own in rna.properties if _is_shown(own)]
    yield f"## `{path}`\n\n{(group.__doc__ or '').strip()}"
    yield table(("name", "in the window", "is", "meaning"), (_row(own) for own in shown))
    yield from _items(own for own in shown if own.type == "ENUM" and _choices(own))
    for own in shown:
        inner = getattr(own, "fixed_type", None)
        if inner is not None and inner.identifier.startswith(_PREFIX) and inner.identifier not in known:
            below = f"{path}.{own.identifier}" + ("[…]" if own.type == "COLLECTION" else "")
            yield from _groups(below, _CLASSES[inner.identifier], known)


def _is_shown(own: Any) -> bool:
    usual = own.identifier == "name" and own.name == "Name" and own.description.startswith("Unique name")
    return own.identifier != "rna_type" and not own.is_hidden and not usual


def _row(own: Any) -> Sequence[str]:
    return code(own.identifier), own.name, _kind(own), own.description


def _kind(own: Any) -> str:
    """Return what a property can be: its type, limits, unit and usual value."""
    makers: Mapping[str, Any] = {"BOOLEAN": _flag, "INT": _number, "FLOAT": _number, "ENUM": _choice}
    if own.type in makers:
        return makers[own.type](own)
    if own.type == "STRING":
        return f"text, {code(repr(own.default))}" if own.default else "text"
    inner = own.fixed_type
    what = inner.name if not inner.identifier.startswith(_PREFIX) else "group"
    return "list" if own.type == "COLLECTION" else what.lower()


def _flag(own: Any) -> str:
    return "yes or no, " + ("yes" if own.default else "no")


def _choice(own: Any) -> str:
    return f"choice, {code(own.default)}" if _choices(own) else "choice"


def _number(own: Any) -> str:
    whole = own.type == "INT"
    low, high = own.hard_min, own.hard_max
    widest = 2.0**31 - 1.0 if whole else 3e38
    parts = ["whole number" if whole else "number"]
    if own.is_array:
        parts[0] = f"{own.array_length} {parts[0]}s"
    if low > -widest and high < widest:
        parts.append(f"{low:g} to {high:g}")
    elif low > -widest:
        parts.append(f"from {low:g}")
    if not own.is_array:
        parts.append(f"usually {own.default:g}")
    return ", ".join(parts)


def _choices(own: Any) -> Sequence[Any]:
    return list(own.enum_items_static)


def _items(properties: Iterable[Any]) -> Iterator[str]:
    """Yield what properties can be; those that can be the same share a table."""
    tables: dict[str, list[str]] = {}
    for own in properties:
        rows = ((code(item.identifier), item.name, item.description) for item in _choices(own))
        tables.setdefault(table(("value", "in the window", "meaning"), rows), []).append(code(own.identifier))
    for items, names in tables.items():
        yield f"{', '.join(names)} {'is' if len(names) == 1 else 'are'} one of:\n\n{items}"
