"""What scripts may import, from the docstrings of the modules."""

import ast
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from .markdown import page

ROOT = Path(__file__).resolve().parents[2]
_PACKAGE = "morph_retarget"
MODULES: Sequence[tuple[str, Sequence[str]]] = (
    (
        "In Blender",
        (
            "blender.io.load",
            "blender.io.save",
            "blender.rig",
            "blender.retarget",
            "blender.morph.query",
            "blender.morph.bake",
            "blender.morph.events",
            "blender.directing.properties",
            "blender.validation.cells",
        ),
    ),
    (
        "Bodies",
        (
            "core.skeleton",
            "core.quat",
            "core.character.analysis",
            "core.character.character",
            "core.character.joints",
            "core.character.map_file",
            "core.character.families",
            "core.character.bone_maps.bone_map",
            "core.character.bone_maps.reading",
            "core.character.bone_maps.placing",
            "core.errors",
        ),
    ),
    ("Clips onto rigs", ("core.mocap.plan", "core.pipeline", "core.mocap.measure", "core.report")),
    (
        "Generalized actions",
        (
            "core.morph.channels",
            "core.morph.context",
            "core.morph.movement",
            "core.morph.bind",
            "core.play",
            "core.solve.settings",
            "core.solve.limb_settings",
        ),
    ),
    ("Locomotion", ("core.locomotion.settings", "core.locomotion.course", "core.locomotion.patterns.styles")),
    (
        "Directing",
        (
            "core.clips.clip",
            "core.clips.motions.annotations",
            "core.clips.motions.library",
            "core.clips.motions.library_file",
            "core.clips.commands.command",
            "core.clips.commands.script",
            "core.directing.starter",
            "core.directing.building",
            "core.directing.director",
        ),
    ),
    ("Judging", ("core.verdicts.performance", "core.verdicts.judging", "core.verdicts.verdict")),
)
"""What is shown, by what it is about."""
_INTRODUCTION = """
Modules are named from `morph_retarget` on. `morph_retarget.core` needs NumPy alone, and is the same inside Blender
and outside of it. Arrays are `(frame, bone, component)`, quaternions `(w, x, y, z)`, lengths metres, and the
*character frame* has +X to the character's left, -Y ahead and +Z up. What cannot be done raises a `MorphError`
(`RigError`, `MotionError`, `MappingError`, `FileError`) that names the item and what to do. Operators and settings
have pages of their own: [operators](operators.md), [settings](settings.md).
"""


def modules() -> str:
    """Return the page of modules with their public functions and classes."""
    parts: list[str] = []
    for title, names in MODULES:
        parts.append(f"## {title}")
        for name in names:
            parts += _module(name)
    return page("Python", _INTRODUCTION.strip(), *parts)


def _module(name: str) -> Iterator[str]:
    tree = _read(name)
    yield f"### `{name}`\n\n{_text(tree)}"
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            yield _function(node, node.name)
        elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from _class(node)


def told_below(module: str, name: str) -> dict[str, str]:
    """Return the texts below the members of a class, by the names of these."""
    (found,) = (node for node in _read(module).body if isinstance(node, ast.ClassDef) and node.name == name)
    pairs = zip(found.body, found.body[1:], strict=False)
    return {ast.unparse(own.targets[0]): _string(after) for own, after in pairs if isinstance(own, ast.Assign)}


def _read(name: str) -> ast.Module:
    path = ROOT / _PACKAGE / Path(*name.split("."))
    return ast.parse(path.with_suffix(".py").read_text(encoding="utf-8"))


def _class(node: ast.ClassDef) -> Iterator[str]:
    yield f"**`class {node.name}`** {_text(node)}" + _members(node)
    for own in node.body:
        if isinstance(own, ast.FunctionDef) and not own.name.startswith("_"):
            yield _function(own, f"{node.name}.{own.name}")


def _members(node: ast.ClassDef) -> str:
    """Return the fields of a class with the texts below them."""
    lines: list[str] = []
    following = [*node.body[1:], None]
    for own, after in zip(node.body, following, strict=True):
        if isinstance(own, ast.AnnAssign) and isinstance(own.target, ast.Name) and not own.target.id.startswith("_"):
            told = _string(after)
            kind = "" if isinstance(own.annotation, ast.Call) else f": {ast.unparse(own.annotation)}"
            lines.append(f"- `{own.target.id}{kind}`" + (f" {_line(told)}" if told else ""))
        elif isinstance(own, ast.Assign) and isinstance(own.targets[0], ast.Name):
            told = _string(after)
            lines.append(f"- `{ast.unparse(own.targets[0])}`" + (f" {_line(told)}" if told else ""))
    return "\n\n" + "\n".join(lines) if lines else ""


def _function(node: ast.FunctionDef, name: str) -> str:
    decorators = [ast.unparse(decorator) for decorator in node.decorator_list]
    if any(text.endswith((".setter", "overload")) for text in decorators):
        return ""
    is_property = any(text.endswith("property") for text in decorators)
    returns = f" -> {ast.unparse(node.returns)}" if node.returns is not None else ""
    arguments = "" if is_property else f"({_arguments(node)})"
    return f"**`{name}{arguments}{returns}`** {_text(node)}"


def _arguments(node: ast.FunctionDef) -> str:
    """Return the arguments of a function without ``self``."""
    text = ast.unparse(node.args)
    first, _, rest = text.partition(", ")
    return rest if first in {"self", "cls"} else text


def _string(node: ast.stmt | None) -> str:
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
        return node.value.value
    return ""


def _text(node: ast.Module | ast.ClassDef | ast.FunctionDef) -> str:
    """Return a docstring as Markdown: paragraphs, and lists of arguments and errors."""
    found = ast.get_docstring(node)
    return "" if found is None else re.sub(r"\n{3,}", "\n\n", "\n".join(_lines(found))).strip()


def _lines(text: str) -> Iterator[str]:
    listing = ""
    for line in text.splitlines():
        if line.rstrip() in {"Args:", "Returns:", "Raises:", "Yields:"}:
            listing = line.strip()
            yield ""
            yield f"{listing}"
            yield ""
        elif listing and line.startswith("    "):
            own = line[4:]
            name, colon, told = own.partition(": ")
            if not own.startswith(" ") and colon and listing in {"Args:", "Raises:"}:
                yield f"- `{name}`: {_plain(told)}"
            elif listing in {"Args:", "Raises:"}:
                yield f"  {_plain(own.strip())}"
            else:
                yield _plain(own.strip())
        elif not line.startswith("    ") or not listing:
            listing = ""
            yield _plain(line)


def _plain(text: str) -> str:
    return text.replace("``", "`")


def _line(text: str) -> str:
    return _plain(" ".join(text.split()))
