"""The motion tree of a directed character at the present frame: what its motion is made from (Grünvogel 2003 §5.5)."""

# The stubs take every layout and every operator button for optional.
# pyright: reportOptionalMemberAccess=false, reportArgumentType=false

from typing import Any

import bpy
import numpy as np

from ...core.clips import tracing
from ...core.clips.character_model import RATE
from ...core.clips.clip import ClipPrimitive
from ...core.clips.models.performance import Performance
from ...core.clips.models.token import Token
from ...core.clips.tracing import Branch
from ..directing import walking
from ..sampling import seconds_per_frame
from .directing_panel import directed
from .tab import InTab, told

MOST_ROWS = 40
"""Of a tree; what is deeper or later is left out."""
INDENT = 1.5
"""Of each level, in Blender's measure of separators."""
SHARE_OF_NAMES = 0.72
"""Of a row's width."""


def performance_now(ob: bpy.types.Object, scene: bpy.types.Scene) -> tuple[Performance, float] | None:
    """Return what a character does as it was found when it was shown, and the present frame of clips."""
    known = walking.performance_known(ob, scene)
    if known is None:
        return None
    performance, clock = known
    return performance, RATE * float(clock.times(np.array([scene.frame_current_final]))[0])


class MORPHRETARGET_PT_motion_tree(InTab, bpy.types.Panel):
    bl_idname = "MORPHRETARGET_PT_motion_tree"
    bl_parent_id = "MORPHRETARGET_PT_directing"
    bl_label = "Motion Tree"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return directed(context) is not None

    def draw(self, context: bpy.types.Context) -> None:
        layout, ob, scene = self.layout, directed(context), context.scene
        found = performance_now(ob, scene) if ob is not None and scene is not None else None
        if found is None or scene is None:
            layout.label(text="Nothing has been shown yet", icon="INFO")
            return
        performance, frame = found
        column = layout.column(align=True)
        for token in performance.tokens_at(frame):
            _draw_token(column, token, 1.0 / RATE / seconds_per_frame(scene))
        branches = tracing.trace(performance.tree_at(frame), frame)
        column = layout.box().column(align=True)
        column.scale_y = 0.8
        for branch in branches[:MOST_ROWS]:
            _draw_branch(column, branch)
        if len(branches) > MOST_ROWS:
            column.label(text=told("… and {count} more", count=len(branches) - MOST_ROWS), translate=False)


def _draw_token(column: bpy.types.UILayout, token: Token, scale: float) -> None:
    """Draw one motion at work.

    Args:
        column: Where.
        token: What the controller keeps of it.
        scale: Frames of the scene for each frame of clips.
    """
    split = column.split(factor=SHARE_OF_NAMES)
    split.active = not token.waits
    split.label(text=token.model, icon="TIME" if token.waits else "PLAY", translate=False)
    since = told("from {frame}", frame=f"{token.start * scale:g}")
    split.label(text=told("waits") if token.waits else since, translate=False)


def _draw_branch(column: bpy.types.UILayout, branch: Branch) -> None:
    """Draw one clip of a tree, dimmed where it takes no part, with its own frame and its length."""
    clip, icon = branch.clip, _icon(branch)
    split = column.split(factor=SHARE_OF_NAMES)
    split.active = branch.is_active
    name = split.row(align=True)
    for _ in range(branch.depth):  # one wide separator would make the row as high
        name.separator(factor=INDENT)
    name.label(text=clip.label, icon=icon, translate=False)
    own = "" if branch.frame is None else f"{branch.frame - clip.start:.1f}"
    split.label(text=f"{own} / {clip.length:.0f}" if own and clip.is_finite else own, translate=False)


def _icon(branch: Branch) -> Any:
    if isinstance(branch.clip, ClipPrimitive):
        return "ACTION" if branch.is_active else "ACTION_TWEAK"
    return "RADIOBUT_ON" if branch.is_active else "RADIOBUT_OFF"


CLASSES = (MORPHRETARGET_PT_motion_tree,)
