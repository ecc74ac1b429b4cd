"""What the window shows: the tab in the 3D viewport's sidebar."""

from . import joint_list, panels

CLASSES = (*joint_list.CLASSES, *panels.CLASSES)
