"""``python -m morph_retarget``: the command line with the bpy module."""

import sys

from .blender.cli import program

if __name__ == "__main__":
    sys.exit(program.main(sys.argv[1:]))
