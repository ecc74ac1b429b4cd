"""What the window shows: the tab in the 3D viewport's sidebar."""

from . import (
    channel_binding,
    channel_panels,
    channel_values,
    generalized,
    jiggle_panel,
    joint_list,
    locomotion_panel,
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
    *jiggle_panel.CLASSES,
)
