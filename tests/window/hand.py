"""A person's hand: moves the mouse and presses keys in the real window.

Blender has to be started with ``--enable-event-simulate``; it then listens to nothing else.
"""

from typing import Any

import bpy

_KEYS = {" ": "SPACE", ".": "PERIOD", "-": "MINUS"}
"""Keys whose names are not what they write."""


class Hand:
    """Acts in the first window."""

    def __init__(self) -> None:
        self.at = (0, 0)

    @property
    def window(self) -> Any:
        """The window; opening a file may change it."""
        return bpy.context.window_manager.windows[0]

    def area(self, kind: str = "VIEW_3D") -> bpy.types.Area:
        """Return the largest area of a kind."""
        found = [area for area in self.window.screen.areas if area.type == kind]
        return max(found, key=lambda area: area.width * area.height)

    def point(self, x: float, y: float) -> None:
        """Move the mouse to a place of the window [px], from the lower left."""
        self.at = (int(x), int(y))
        self._event("MOUSEMOVE", "NOTHING")

    def point_at(self, kind: str = "VIEW_3D", share: tuple[float, float] = (0.3, 0.5)) -> None:
        """Move the mouse into an area."""
        area = self.area(kind)
        self.point(area.x + share[0] * area.width, area.y + share[1] * area.height)

    def press(self, key: str, **held: bool) -> None:
        """Press a key or a button of the mouse, and let it go.

        Args:
            key: Blender's name of it.
            held: `ctrl`, `shift`, `alt`.
        """
        self._event(key, "PRESS", **held)
        self._event(key, "RELEASE", **held)

    def write(self, text: str) -> None:
        """Write a text, letter by letter."""
        for letter in text:
            key = _KEYS.get(letter, letter.upper())
            self._event(key, "PRESS", unicode=letter)
            self._event(key, "RELEASE")

    def _event(self, kind: str, value: str, **options: Any) -> None:
        self.window.event_simulate(type=kind, value=value, x=self.at[0], y=self.at[1], **options)
