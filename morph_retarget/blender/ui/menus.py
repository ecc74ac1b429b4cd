"""Menus in Blender's own menus, so that all can be found by searching, reached by keys and put among the favourites."""

# The stubs take every layout for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

from collections.abc import Callable
from typing import Any

import bpy

from ..morph import cast, query
from ..operators.generalized import generalized_actions

Entry = tuple[str, Any]
"""An operator without its module, and its icon."""

FIRST: tuple[Entry, ...] = (
    ("retarget", "ARMATURE_DATA"),
    ("live_start", "PLAY"),
    ("live_stop", "X"),
)
CLIPS: tuple[Entry, ...] = (
    ("use_selected", "RESTRICT_SELECT_OFF"),
    ("swap", "UV_SYNC_SELECT"),
    ("analyze", "VIEWZOOM"),
    ("pick_bone", "EYEDROPPER"),
    ("detect_contacts", "SNAP_ON"),
)
CLIP: tuple[Entry, ...] = (
    ("find_annotations", "VIEWZOOM"),
    ("clear_annotations", "X"),
    ("generalize_action", "ARMATURE_DATA"),
    ("bake_jiggles", "REC"),
)
MAPS: tuple[Entry, ...] = (
    ("import_map", "IMPORT"),
    ("export_map", "EXPORT"),
)
ACTIONS: tuple[Entry, ...] = (
    ("new_action", "ADD"),
    ("add_character", "ACTION"),
    ("remove_character", "X"),
    ("play_movement", "NLA"),
    ("bake_action", "REC"),
)
CHANNEL: tuple[Entry, ...] = (
    ("key_channel", "KEYINGSET"),
    ("rest_channel", "LOOP_BACK"),
    ("edit_specialized", "FCURVE"),
    ("finish_specialized", "CHECKMARK"),
)
BODIES: tuple[Entry, ...] = (
    ("select_bodies", "RESTRICT_SELECT_OFF"),
    ("choose_variant", "MOD_ARRAY"),
    ("add_limb_settings", "CON_KINEMATIC"),
)
GOING: tuple[Entry, ...] = (
    ("add_locomotion", "ADD"),
    ("remove_locomotion", "X"),
    ("key_locomotion", "KEY_HLT"),
    ("new_foot_path", "CURVE_DATA"),
    ("remove_foot_path", "X"),
)
DIRECTING: tuple[Entry, ...] = (
    ("direct", "ADD"),
    ("commands_to_markers", "MARKER_HLT"),
    ("markers_to_commands", "MARKER"),
)
LIBRARIES: tuple[Entry, ...] = (
    ("import_commands", "IMPORT"),
    ("export_commands", "EXPORT"),
    ("build_library", "ASSET_MANAGER"),
    ("load_library", "IMPORT"),
    ("save_library", "EXPORT"),
)


def _draw(layout: bpy.types.UILayout, *groups: tuple[Entry, ...]) -> None:
    """Draw groups of operators, parted by lines."""
    layout.operator_context = "INVOKE_DEFAULT"
    for i, group in enumerate(groups):
        if i:
            layout.separator()
        for name, icon in group:
            layout.operator(f"morph_retarget.{name}", icon=icon)


class MORPHRETARGET_MT_main(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_main"
    bl_label = "Morph Retarget"

    def draw(self, _: bpy.types.Context) -> None:
        _draw(self.layout, FIRST)
        self.layout.separator()
        for kind in (MORPHRETARGET_MT_clips, MORPHRETARGET_MT_generalized, MORPHRETARGET_MT_channel):
            self.layout.menu(kind.bl_idname)
        self.layout.menu(MORPHRETARGET_MT_going.bl_idname)


class MORPHRETARGET_MT_clips(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_clips"
    bl_label = "Clips and Joints"

    def draw(self, _: bpy.types.Context) -> None:
        _draw(self.layout, CLIPS, CLIP, MAPS)


class MORPHRETARGET_MT_generalized(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_generalized"
    bl_label = "Generalized Action"

    def draw(self, _: bpy.types.Context) -> None:
        _draw(self.layout, ACTIONS)


class MORPHRETARGET_MT_channel(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_channel"
    bl_label = "Generalized Channel"

    def draw(self, _: bpy.types.Context) -> None:
        _draw(self.layout, CHANNEL, BODIES)


class MORPHRETARGET_MT_going(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_going"
    bl_label = "Locomotion and Directing"

    def draw(self, _: bpy.types.Context) -> None:
        _draw(self.layout, GOING, DIRECTING, LIBRARIES)


class MORPHRETARGET_MT_bones(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_bones"
    bl_label = "Morph Retarget"

    def draw(self, _: bpy.types.Context) -> None:
        _draw(self.layout, CHANNEL[:3], BODIES, CLIPS[3:4])


class MORPHRETARGET_MT_action(bpy.types.Menu):
    bl_idname = "MORPHRETARGET_MT_action"
    bl_label = "Morph Retarget"

    def draw(self, _: bpy.types.Context) -> None:
        _draw(self.layout, CLIP, ACTIONS[-1:])


def _of_armature(context: bpy.types.Context) -> bool:
    return context.object is not None and context.object.type == "ARMATURE"


def _has_channels(context: bpy.types.Context) -> bool:
    ob = query.active_character(context)
    return ob is not None and cast.action_of(ob) is not None and len(generalized_actions()) > 0


def _entry(menu: str, shown: Callable[[bpy.types.Context], bool] = lambda _: True) -> Callable[..., None]:
    """Return what draws a line and a menu at the end of another one, where it says something."""

    def draw(self: bpy.types.Menu, context: bpy.types.Context) -> None:
        if shown(context):
            self.layout.separator()
            self.layout.menu(menu)

    return draw


PLACES: tuple[tuple[str, Callable[..., None]], ...] = (
    ("VIEW3D_MT_object", _entry("MORPHRETARGET_MT_main")),
    ("VIEW3D_MT_object_context_menu", _entry("MORPHRETARGET_MT_main", _of_armature)),
    ("VIEW3D_MT_pose", _entry("MORPHRETARGET_MT_main")),
    ("VIEW3D_MT_pose_context_menu", _entry("MORPHRETARGET_MT_bones")),
    ("GRAPH_MT_channel", _entry("MORPHRETARGET_MT_channel")),
    ("GRAPH_MT_context_menu", _entry("MORPHRETARGET_MT_channel", _has_channels)),
    ("DOPESHEET_MT_action", _entry("MORPHRETARGET_MT_action")),
    ("DOPESHEET_MT_context_menu", _entry("MORPHRETARGET_MT_action", _of_armature)),
)
"""Menus of Blender that get one of ours at their end."""


def attach() -> None:
    """Put our menus into Blender's, where this version has them."""
    for name, draw in PLACES:
        if hasattr(bpy.types, name):
            getattr(bpy.types, name).append(draw)


def detach() -> None:
    """Take them out again."""
    for name, draw in PLACES:
        if hasattr(bpy.types, name):
            getattr(bpy.types, name).remove(draw)


CLASSES = (
    MORPHRETARGET_MT_main,
    MORPHRETARGET_MT_clips,
    MORPHRETARGET_MT_generalized,
    MORPHRETARGET_MT_channel,
    MORPHRETARGET_MT_going,
    MORPHRETARGET_MT_bones,
    MORPHRETARGET_MT_action,
)
