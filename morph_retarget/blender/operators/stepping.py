"""Long work in operators: at once for scripts; in a window with progress and cancel, and one step of undo."""

import time
from collections.abc import Generator
from typing import Any

import bpy

from ...core.errors import MorphError
from .. import retarget
from .manners import Status, reporting

SLICE = 0.05
"""The window is served at least this often [s]."""


class Stepping:
    """An operator that works in steps. It has to say how it starts and what it does with the result."""

    doing: str
    """What it does, shown with its progress: "Retargeting"."""
    report: Any
    """Of Blender's operators."""

    _work: Generator[float, None, Any]
    _timer: bpy.types.Timer

    def start(self, context: bpy.types.Context) -> Generator[float, None, Any]:
        """Return the work; closed before its end, it must leave everything as it was.

        Raises:
            MorphError: It cannot be done.
        """
        raise NotImplementedError

    def finish(self, context: bpy.types.Context, result: Any) -> Status:
        """Report what was done."""
        raise NotImplementedError

    @reporting
    def execute(self, context: bpy.types.Context) -> Status:
        """Do all of it at once."""
        return self.finish(context, retarget.run(self.start(context)))

    def invoke(self, context: bpy.types.Context, _: bpy.types.Event) -> Status:
        """Begin to do it in steps."""
        return self._begin(context)

    @reporting
    def _begin(self, context: bpy.types.Context) -> Status:
        self._work = self.start(context)
        window = _window(context)
        window.progress_begin(0.0, 1.0)
        self._timer = window.event_timer_add(0.01, window=context.window)
        if context.workspace is not None:
            context.workspace.status_text_set(f"{self.doing}   Esc: Cancel")
        window.modal_handler_add(self)  # type: ignore[arg-type]  # the operator that this is part of
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Do the next steps, or leave everything as it was."""
        if event.type == "ESC":
            self._work.close()
            self._leave(context)
            self.report({"INFO"}, f"{self.doing} cancelled; nothing was changed")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        return self._go_on(context)

    def _go_on(self, context: bpy.types.Context) -> Status:
        until, share = time.perf_counter() + SLICE, 0.0
        try:
            while time.perf_counter() < until:
                share = next(self._work)
        except StopIteration as end:
            self._leave(context)
            return self.finish(context, end.value)
        except MorphError as error:
            self._leave(context)
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        _window(context).progress_update(share)
        if context.workspace is not None:
            context.workspace.status_text_set(f"{self.doing}: {share:.0%}   Esc: Cancel")
        return {"RUNNING_MODAL"}

    def _leave(self, context: bpy.types.Context) -> None:
        window = _window(context)
        window.event_timer_remove(self._timer)
        window.progress_end()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        for area in context.screen.areas if context.screen is not None else ():
            area.tag_redraw()  # what panels tell of the result comes after the last thing that Blender notices


class SteppingFromDialog(Stepping):
    """The same for what asks for a file first: a base after Blender's `ExportHelper` or `ImportHelper`."""

    options: Any
    """Of Blender's operators."""

    def execute(self, context: bpy.types.Context) -> Status:
        """Begin to do it in steps once a file is chosen; for scripts, do all of it at once."""
        if self.options.is_invoke and context.window is not None:
            return self._begin(context)
        return super().execute(context)


def _window(context: bpy.types.Context) -> bpy.types.WindowManager:
    assert context.window_manager is not None, "operators are invoked in a window"
    return context.window_manager
