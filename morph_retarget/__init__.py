"""Morph Retarget: any motion on any rig.

`core` is the mathematics, NumPy only; `blender` is the edge that knows Blender.
"""
