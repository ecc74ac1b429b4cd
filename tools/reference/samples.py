"""What to try with the sample files, from the texts in them."""

from tools import tries

from .markdown import page

_INTRODUCTION = """
`sample_blends/` holds characters, actions and scenes of our own, for Blender 4.5 and later. Each file has a text called
*Try This* that says what follows here (Text Editor, or *File > Append*). Install the extension first.
"""
_CHARACTERS = "characters/"


def samples() -> str:
    """Return the page of all sample files; characters, of which all say the same, share a section."""
    scenes = [f"## `{name}`\n\n{told}" for name, told in tries.TRIES.items() if not name.startswith(_CHARACTERS)]
    names = [name for name in tries.TRIES if name.startswith(_CHARACTERS)]
    _, _, told = tries.TRIES[names[0]].partition("\n\n")
    listed = ", ".join(f"`{name.removeprefix(_CHARACTERS)}`" for name in names)
    return page("Samples", _INTRODUCTION.strip(), *scenes, f"## `{_CHARACTERS}`\n\n{listed}\n\n{told}")
