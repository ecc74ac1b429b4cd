"""The rules that reviewers of the extensions platform check, for a built zip.

What Blender's own `validate` checks, such as tags and lengths of texts, is left to it. The rules are those of the
moderation guidelines and policies: reviewable and self-contained code, no network without permission, nothing written
beside the code, no change to how Python finds modules, no caches, a licence.
"""

import ast
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath
from zipfile import ZipFile

from . import ReleaseError

PACKAGE = "morph_retarget"
LARGEST = 4_000_000
"""A zip is smaller than this [bytes]: code and small tables; anything larger does not belong in it."""
NETWORK = frozenset({"socket", "ssl", "http", "ftplib", "smtplib", "requests", "urllib3", "aiohttp", "websockets"})
REMOTE = frozenset({"urllib.request", "urllib.error", "urllib.robotparser", "xmlrpc.client"})
FOREIGN = frozenset({"pip", "ensurepip", "pickle", "marshal", "ctypes", "shelve", "dill"})
"""Modules that install, execute or load what nobody has reviewed."""
PROCESSES: Mapping[str, str] = {"morph_retarget/blender/batch/process.py": "workers of a batch: Blender itself"}
"""Files that may start processes, and which."""
OWN_PLACE: Mapping[str, str] = {
    "morph_retarget/blender/version.py": "reads the manifest",
    "morph_retarget/blender/batch/worker.py": "tells workers of the module where the package is",
    "morph_retarget/blender/morph/channel_presets.py": "reads presets that are shipped",
    "morph_retarget/core/character/families.py": "reads presets that are shipped",
    "morph_retarget/core/directing/recipes/shelf.py": "reads recipes that are shipped",
}
"""Files that may ask where they are, and what for: never to write there."""
UNWANTED = ("__pycache__", ".pyc", ".pyo", ".so", ".pyd", ".dll", ".blend", ".blend1", ".exe", ".whl", ".DS_Store")


def check(built: Path) -> None:
    """Check a built zip.

    Raises:
        ReleaseError: It breaks rules; the text has one line for each place.
    """
    found = list(problems(built))
    if found:
        raise ReleaseError("\n".join(found))


def problems(built: Path) -> Iterator[str]:
    """Yield what a reviewer would object to, one line for each place."""
    if built.stat().st_size > LARGEST:
        yield f"{built.name}: has {built.stat().st_size} bytes: leave out what users do not need"
    with ZipFile(built) as zipped:
        texts = {name: zipped.read(name) for name in zipped.namelist() if not name.endswith("/")}
    yield from _files(texts)
    yield from manifest_problems(tomllib.loads(texts["blender_manifest.toml"].decode()))
    for name, text in texts.items():
        if name.endswith(".py"):
            yield from code_problems(name, text.decode())


def _files(texts: Mapping[str, bytes]) -> Iterator[str]:
    for name in ("blender_manifest.toml", "__init__.py", "LICENSE"):
        if name not in texts:
            yield f"{name}: is not in the zip: add it"
    for name in texts:
        hidden = any(part.startswith(".") for part in PurePosixPath(name).parts)
        if hidden or any(unwanted in name for unwanted in UNWANTED):
            yield f"{name}: does not belong in the zip: exclude it in the manifest"


def manifest_problems(manifest: Mapping[str, object]) -> Iterator[str]:
    """Yield what a reviewer would object to in a manifest."""
    permissions = manifest.get("permissions", {})
    if not isinstance(permissions, dict) or set(permissions) != {"files"}:
        yield "blender_manifest.toml: permissions are not those of the code, files alone"
    if manifest.get("license") != ["SPDX:GPL-3.0-or-later"]:
        yield "blender_manifest.toml: the licence is not SPDX:GPL-3.0-or-later, which add-ons need"
    if manifest.get("id") != PACKAGE:
        yield f"blender_manifest.toml: the id is not {PACKAGE}, by which files and settings know it"
    for key in ("tagline", "maintainer", "name"):
        text = str(manifest.get(key, ""))
        if not text or "example" in text.lower():
            yield f"blender_manifest.toml: {key} is empty or an example: write ours"
    for key in ("wheels", "platforms"):
        if key in manifest:
            yield f"blender_manifest.toml: {key} is there: the code is Python alone"


def code_problems(name: str, text: str) -> Iterator[str]:
    """Yield what a reviewer would object to in a module.

    Args:
        name: Of its file in the zip.
        text: Its code.
    """
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import | ast.ImportFrom):
            found = _imports(name, node)
        elif isinstance(node, ast.Call):
            found = _calls(node)
        elif isinstance(node, ast.Name | ast.Attribute):
            found = _places(name, node)
        else:
            continue
        yield from (f"{name}:{node.lineno}: {told}" for told in found)


def _imports(name: str, node: ast.Import | ast.ImportFrom) -> Iterator[str]:
    if isinstance(node, ast.Import):
        modules = [alias.name for alias in node.names]
    elif node.level:
        return
    else:
        parts = [f"{node.module}.{alias.name}" for alias in node.names]
        modules = [part for part in parts if part in REMOTE] or [node.module or ""]
    for module in modules:
        first = module.split(".")[0]
        if first == PACKAGE:
            yield f"imports {module} by its full name: import it relatively"
        elif first in NETWORK or module in REMOTE:
            yield f"imports {module}, which reaches the network: there is no permission for it"
        elif first in FOREIGN:
            yield f"imports {module}, which loads or installs what nobody has reviewed"
        elif first == "subprocess" and name not in PROCESSES:
            yield "imports subprocess: only workers of a batch are started"


def _calls(node: ast.Call) -> Iterator[str]:
    called = _dotted(node.func)
    if called in {"eval", "exec", "compile", "__import__", "os.system", "os.popen"}:
        yield f"calls {called}: nothing in files may be executed"


def _places(name: str, node: ast.Name | ast.Attribute) -> Iterator[str]:
    named = _dotted(node)
    if named == "bl_info":
        yield "has bl_info: the manifest tells it"
    elif named == "__file__" and name not in OWN_PLACE:
        yield "asks where its file is: user data belongs to bpy.utils.extension_path_user"
    elif named in {"sys.path", "sys.modules"}:
        yield f"uses {named}: import relatively"


def _dotted(node: ast.AST) -> str:
    """Return a name, or a name of a module with a dot and a name behind it; nothing for all else."""
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        return f"{node.value.id}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""
