"""A layout that writes down what panels draw, and refuses what Blender would refuse."""

from functools import partial
from typing import Any

import bpy

_ICONS = set(bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items.keys())


class Button:
    """What an operator button's settings are put on."""

    def __init__(self, kind: Any) -> None:
        object.__setattr__(self, "kind", kind)

    def __setattr__(self, name: str, value: object) -> None:
        assert name in self.kind.properties, f"{self.kind.identifier} has no setting {name!r}"
        object.__setattr__(self, name, value)


class Layout:
    """Takes what Blender's layouts take; parts of it write into the same lists."""

    def __init__(self, above: "Layout | None" = None) -> None:
        self.active = self.enabled = True
        self.above = above
        self.texts: list[str] = above.texts if above else []
        self.icons: list[str] = above.icons if above else []
        self.props: list[tuple[str, bool]] = above.props if above else []
        """Properties that are drawn, and whether each is shown as having an effect."""
        self.buttons: list[Button] = above.buttons if above else []

    def _note(self, text: str | None, icon: str) -> None:
        assert icon in _ICONS, f"there is no icon {icon!r}"
        self.icons.append(icon)
        if text:
            self.texts.append(text)

    def _is_active(self) -> bool:
        return self.active and (self.above is None or self.above._is_active())

    def _part(self, **_: object) -> "Layout":
        return Layout(self)

    row = column = box = split = _part

    def label(self, text: str = "", icon: str = "NONE", **_: object) -> None:
        self._note(text, icon)

    def separator(self, **_: object) -> None:
        pass

    def prop(self, data: Any, name: str, text: str | None = None, icon: str = "NONE", **_: object) -> None:
        assert name in data.bl_rna.properties, f"{data} has no property {name!r}"
        self._note(text, icon)
        self.props.append((name, self._is_active()))

    def prop_search(self, data: Any, name: str, source: Any, inside: str, **options: Any) -> None:
        assert inside in source.bl_rna.properties, f"{source} has no {inside!r}"
        self.prop(data, name, **options)

    def operator(self, name: str, text: str | None = None, icon: str = "NONE", **_: object) -> Button:
        self._note(text, icon)
        kind = getattr(getattr(bpy.ops, name.split(".")[0]), name.split(".")[1]).get_rna_type()
        self.buttons.append(Button(kind))
        return self.buttons[-1]

    def operator_menu_enum(self, name: str, prop: str, **options: Any) -> Button:
        button = self.operator(name, **options)
        assert prop in button.kind.properties, f"{name} has no setting {prop!r}"
        return button

    def menu(self, name: str, text: str | None = None, icon: str = "NONE", **_: object) -> None:
        assert hasattr(bpy.types, name), f"there is no menu {name!r}"
        self._note(text, icon)

    def template_list(self, name: str, _: str, data: Any, items: str, active: Any, index: str, **__: object) -> None:
        kind = getattr(bpy.types, name)
        assert index in active.bl_rna.properties, f"{active} has no {index!r}"
        for i, item in enumerate(getattr(data, items)):
            kind.draw_item(kind, bpy.context, Layout(self), data, item, None, active, index, i)


class _Standing:
    """A panel or menu as its drawing sees itself."""

    def __init__(self, kind: Any) -> None:
        self.layout, self._kind = Layout(), kind

    def __getattr__(self, name: str) -> Any:
        return partial(getattr(self._kind, name), self)


def drawn(*kinds: Any) -> Layout:
    """Return what panels draw together, those left out whose poll says no."""
    whole = Layout()
    for kind in kinds:
        if not hasattr(kind, "poll") or kind.poll(bpy.context):
            own = _Standing(kind)
            own.layout = Layout(whole)
            kind.draw(own, bpy.context)
    return whole
