"""What the window shows: the tab in the 3D viewport's sidebar."""

from . import channel_panels, generalized, joint_list, panels

CLASSES = (*joint_list.CLASSES, *panels.CLASSES, *generalized.CLASSES, *channel_panels.CLASSES)
