"""The extension comes and goes without leaving anything behind."""

import subprocess
import sys
from pathlib import Path

import bpy

from morph_retarget.blender import handlers, registration
from tests.blender import window
from tools import messages

ROOT = Path(__file__).resolve().parents[2]


def _handlers() -> int:
    return sum(handler in found for found, handler in handlers._pairs())


def test_it_registers_unregisters_and_registers_again() -> None:
    for _ in range(2):
        with window.registered():
            assert hasattr(bpy.types.Scene, "morph_retarget")
            assert _handlers() == len(handlers._pairs())
            assert bpy.ops.morph_retarget.retarget.idname_py() == "morph_retarget.retarget"
        assert not hasattr(bpy.types.Scene, "morph_retarget")
        assert not hasattr(bpy.types.Object, "morph_retarget")
        assert _handlers() == 0
        assert not any(listeners for listeners, _ in registration._LISTENERS)


def test_each_operator_and_property_says_what_it_does() -> None:
    with window.registered():
        for cls in registration.CLASSES:
            if issubclass(cls, bpy.types.Operator):
                assert cls.bl_description, cls
                assert not cls.bl_description.endswith("."), cls
            for prop in cls.bl_rna.properties if issubclass(cls, bpy.types.PropertyGroup) else ():
                if prop.identifier not in {"rna_type", "name"}:
                    assert prop.description, (cls, prop.identifier)
                    assert not prop.description.endswith("."), (cls, prop.identifier)


def test_settings_and_choices_of_operators_and_properties_say_what_they_mean() -> None:
    with window.registered():
        for cls in registration.CLASSES:
            if issubclass(cls, bpy.types.Operator | bpy.types.PropertyGroup):
                for prop in messages.settings(cls):
                    choices = prop.enum_items if prop.type == "ENUM" else ()
                    for shown in () if prop.is_hidden else (prop, *choices):
                        assert shown.description, (cls, shown.identifier)
                        assert not shown.description.endswith("."), (cls, shown.identifier)


def test_labels_are_in_title_case() -> None:
    small = {"a", "above", "and", "as", "by", "for", "from", "in", "of", "on", "the", "to", "with"}
    with window.registered():
        for label in messages.registered():
            words = label.split()
            assert words, "a label is empty"
            assert not words[0][0].islower(), label
            assert not [word for word in words if word[0].islower() and word not in small], label


def test_all_operators_are_logged_and_all_that_change_the_file_can_be_undone() -> None:
    write_files_alone = {"save_preset", "delete_preset", "save_channels", "delete_channels"}
    write_files_alone |= {"export_map", "export_commands", "save_library"}
    with window.registered():
        for cls in registration.CLASSES:
            if issubclass(cls, bpy.types.Operator):
                undone = set() if cls.bl_idname.split(".")[1] in write_files_alone else {"UNDO"}
                assert {"REGISTER"} | undone == cls.bl_options, cls


def test_every_operator_can_be_found_by_its_name() -> None:
    with window.registered():
        for cls in registration.CLASSES:
            if issubclass(cls, bpy.types.Operator):
                module, name = cls.bl_idname.split(".")
                assert module == "morph_retarget"
                assert cls.__name__ == f"MORPHRETARGET_OT_{name}"
                assert getattr(bpy.ops.morph_retarget, name).get_rna_type()


def test_no_operator_acts_on_what_it_acted_on_last() -> None:
    with window.registered():
        for cls in registration.CLASSES:
            if issubclass(cls, bpy.types.Operator):
                kind = getattr(bpy.ops.morph_retarget, cls.bl_idname.split(".")[1]).get_rna_type()
                own = {prop.identifier for prop in kind.properties if not prop.is_skip_save} - _OF_FILES
                assert own - {"rna_type"} <= set(getattr(cls, "remembered", ())), cls


_OF_FILES = {"filepath", "filter_glob", "check_existing", "hide_props_region"}
"""Settings that Blender's own helpers for files bring."""

_INSTALL = """
import sys, bpy
bpy.ops.extensions.package_install_files(filepath=sys.argv[1], repo="user_default", enable_on_install=True)
assert "bl_ext.user_default.morph_retarget" in bpy.context.preferences.addons
from bl_ext.user_default.morph_retarget.morph_retarget.blender import presets
assert bpy.ops.object.armature_add() == {"FINISHED"}
assert not presets.names()
folder = str(presets.path_of("Mine"))
assert "morph_retarget" in folder and sys.argv[2] in folder, folder
presets.save(presets.path_of("Mine"), {"hips": "Bone"})
assert presets.names() == ["Mine"]
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.morph_retarget")
print("installed and used")
"""


def test_the_built_extension_installs_into_an_empty_profile(tmp_path: Path) -> None:
    tool = "import sys, bpy; from bl_pkg.bl_extension_cli import cli_extension_handler as e; sys.exit(e(sys.argv[1:]))"
    build = [sys.executable, "-c", tool, "build", "--source-dir", str(ROOT), "--output-dir", str(tmp_path)]
    subprocess.run(build, check=True, capture_output=True)
    zipped = next(tmp_path.glob("*.zip"))
    profile = tmp_path / "profile"
    profile.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", _INSTALL, str(zipped), str(profile)],
        env={"BLENDER_USER_RESOURCES": str(profile), "PATH": "/usr/bin:/bin", "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "installed and used" in done.stdout
