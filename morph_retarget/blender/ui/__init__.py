"""What the window shows: the tab in the 3D viewport's sidebar, channels beside their curves, and menus."""

from . import (
    annotation_panel,
    channel_binding,
    channel_panels,
    channel_values,
    directing_panel,
    generalized,
    graph_panels,
    jiggle_panel,
    joint_list,
    locomotion_panel,
    menus,
    motion_tree,
    panels,
    solver_panel,
)

CLASSES = (
    *joint_list.CLASSES,
    *panels.CLASSES,
    *generalized.CLASSES,
    *channel_panels.CLASSES,
    *channel_values.CLASSES,
    *channel_binding.CLASSES,
    *solver_panel.CLASSES,
    *locomotion_panel.CLASSES,
    *directing_panel.CLASSES,
    *motion_tree.CLASSES,
    *annotation_panel.CLASSES,
    *jiggle_panel.CLASSES,
    *graph_panels.CLASSES,
    *menus.CLASSES,
)
