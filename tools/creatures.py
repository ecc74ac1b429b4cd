"""Sample characters as plain data: a biped, a hound, a beetle, a spider, a bird, a snake, and two odd ones.

Like the figures of `figure` they stand at the origin of Blender's world and look along -Y; parents come first. Every
limb is bent the way it bends in life. Left halves are written down, right halves are their mirror images.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from . import parts
from .flesh import Lump, Paint, Part, opposite


def biped() -> list[Part]:
    """Return an adult human, 1.7 m high, with three fingers a hand and its arms 40 degrees below the horizontal."""
    trunk = parts.line(
        ("Hips", "Spine", "Chest", "UpperChest", "Neck"),
        [(0, 0.0, 0.9), (0, -0.01, 1.01), (0, -0.005, 1.13), (0, 0.01, 1.26), (0, 0.02, 1.4), (0, 0.0, 1.47)],
        (0.105, 0.09, 0.095, 0.115, 0.05, 0.05),
        "Root",
        (1.3, 0.9, 1.0),
        last=1,
    )
    shoulder = (0.17, 0.015, 1.37)
    leg = parts.leg((0.095, 0.0, 0.88), (0.105, 0.02, 0.085), (0.405, 0.4), 0.082, 0.16)
    skull = (
        Lump((0, -0.005, 1.555), (0, -0.01, 1.585), (0.108, 0.115), squash=(0.95, 1.0, 1.0), sides=12),
        Lump((0, 0.02, 1.585), (0, 0.012, 1.612), (0.122, 0.112), Paint.DARK, (0.95, 1.0, 1.0), 12),
        Lump((-0.05, -0.075, 1.66), (0.05, -0.07, 1.67), (0.045, 0.04), Paint.DARK),
        *parts.nose(-0.118, 1.545),
    )
    head = Part("Head", "Neck", (0, 0.0, 1.47), (0, -0.01, 1.72), (*skull, parts.cavity((0, -0.035, 1.5), 0.07)))
    return [
        parts.root(0.25),
        parts.painted(trunk[0], Paint.PALE),
        *parts.dressed(trunk[1:-1]),
        trunk[-1],
        head,
        parts.jaw((0, -0.02, 1.49), (0, -0.07, 1.465), (0.062, 0.052), (1.1, 1.0, 0.75), paint=Paint.SKIN),
        *parts.both(parts.eye((0.045, -0.102, 1.578), 0.026)),
        *parts.both(
            parts.dressed(
                parts.arm(shoulder, (0.27, 0.25, 0.095), 40.0, 0.05, "UpperChest", clavicle=(0.03, 0.0, 1.37)), 2
            )
        ),
        *parts.both(parts.painted(part, Paint.DARK if part.name[0] in "FT" else Paint.PALE) for part in leg),
    ]


def hound() -> list[Part]:
    """Return a dog, 0.8 m high at its head."""
    trunk = parts.line(
        ("Hips", "Spine", "Spine.001", "Chest"),
        [(0, 0.28, 0.56), (0, 0.14, 0.575), (0, 0.01, 0.56), (0, -0.12, 0.545), (0, -0.25, 0.56)],
        (0.085, 0.075, 0.08, 0.115, 0.095),
        "Root",
        (0.85, 1.0, 1.1),
    )
    neck = parts.line(
        ("Neck", "Neck.001"), [(0, -0.26, 0.59), (0, -0.34, 0.66), (0, -0.4, 0.73)], (0.08, 0.062, 0.055), "Chest"
    )
    muzzle = (
        Lump((0, -0.42, 0.75), (0, -0.45, 0.75), (0.078, 0.075)),
        Lump((0, -0.49, 0.735), (0, -0.58, 0.718), (0.05, 0.036), Paint.PALE),
        Lump((0, -0.605, 0.737), (0, -0.612, 0.735), (0.019, 0.017), Paint.DARK, sides=7),
        parts.cavity((0, -0.48, 0.705), 0.025, reach=0.08),
    )
    ear = Part("Ear.L", "Head", (0.045, -0.4, 0.8), (0.105, -0.42, 0.845), (
        Lump((0.045, -0.4, 0.805), (0.085, -0.405, 0.85), (0.034, 0.024), Paint.DARK, (1.0, 0.6, 1.0), 8),
        Lump((0.085, -0.41, 0.85), (0.12, -0.43, 0.81), (0.026, 0.016), Paint.DARK, (1.0, 0.8, 1.0), 8),
    ))  # fmt: skip
    front = parts.line(
        ("Shoulder.L", "UpperArm.L", "LowerArm.L"),
        [(0.06, -0.17, 0.6), (0.085, -0.25, 0.45), (0.09, -0.165, 0.33), (0.09, -0.2, 0.05)],
        (0.055, 0.055, 0.036, 0.026),
        "Chest",
    )
    hind = parts.line(
        ("Thigh.L", "Shin.L", "Hock.L"),
        [(0.075, 0.26, 0.52), (0.09, 0.18, 0.34), (0.09, 0.32, 0.19), (0.09, 0.29, 0.05)],
        (0.085, 0.048, 0.028, 0.026),
        "Hips",
    )
    tail = parts.line(
        parts.counted("Tail", 5),
        [(0, 0.34, 0.59), (0, 0.41, 0.6), (0, 0.475, 0.635), (0, 0.525, 0.69), (0, 0.55, 0.755), (0, 0.55, 0.82)],
        (0.032, 0.03, 0.03, 0.028, 0.024, 0.012),
        "Hips",
    )
    return [
        parts.root(0.2),
        *trunk,
        *neck,
        Part("Head", "Neck.001", (0, -0.4, 0.73), (0, -0.56, 0.725), muzzle),
        parts.jaw((0, -0.45, 0.705), (0, -0.57, 0.685), (0.032, 0.022), (1.0, 1.0, 0.7)),
        *parts.both([*parts.eye((0.04, -0.495, 0.782), 0.021, "Head"), ear]),
        *parts.both([*front, parts.sole("FrontPaw.L", "LowerArm.L", (0.09, -0.2, 0.05), 0.07, 0.034)]),
        *parts.both([*hind, parts.sole("HindPaw.L", "Hock.L", (0.09, 0.29, 0.05), 0.07, 0.034)]),
        *tail,
    ]


def beetle() -> list[Part]:
    """Return a six-legged creature, half a metre long, that bites sideways."""
    thorax = parts.line(
        parts.counted("Thorax", 3),
        [(0, 0.06, 0.15), (0, 0.0, 0.15), (0, -0.06, 0.15), (0, -0.12, 0.15)],
        (0.07, 0.09, 0.095, 0.075),
        "Root",
        (1.1, 1.0, 0.75),
    )
    shell = (
        Lump((0.035, 0.09, 0.165), (0.03, 0.17, 0.155), (0.115, 0.095), squash=(1.0, 1.0, 0.8), sides=12),
        Lump((-0.035, 0.09, 0.165), (-0.03, 0.17, 0.155), (0.115, 0.095), squash=(1.0, 1.0, 0.8), sides=12),
        Lump((0, 0.08, 0.14), (0, 0.19, 0.135), (0.12, 0.09), Paint.PALE, (1.0, 1.0, 0.7), 10),
        *(
            Lump((x, y, 0.241), (x, y, 0.243), (0.022, 0.022), Paint.DARK, (1.0, 1.0, 0.4), 8)
            for x, y in ((0.05, 0.08), (-0.05, 0.08), (0.05, 0.15), (-0.05, 0.15))
        ),
    )
    head = (
        Lump((0, -0.16, 0.15), (0, -0.185, 0.145), (0.068, 0.062), squash=(1.1, 1.0, 0.9), sides=12),
        parts.cavity((0, -0.205, 0.125), 0.042, reach=0.02),
    )
    return [
        parts.root(0.1),
        *thorax,
        Part("Abdomen", "Thorax.001", (0, 0.06, 0.15), (0, 0.26, 0.15), shell),
        Part("Head", "Thorax.003", (0, -0.12, 0.15), (0, -0.23, 0.135), head),
        *parts.both(parts.mandible()),
        *parts.both(parts.eye((0.05, -0.21, 0.178), 0.027, "Head")),
        *parts.both(
            parts.line(
                ("Antenna1.L", "Antenna2.L"),
                [(0.022, -0.2, 0.195), (0.05, -0.25, 0.27), (0.09, -0.32, 0.285)],
                (0.008, 0.007, 0.011),
                "Head",
                paint=Paint.DARK,
                sides=6,
            )
        ),
        *parts.both(parts.insect_leg(1, "Thorax.003", -0.08, -0.24)),
        *parts.both(parts.insect_leg(2, "Thorax.002", -0.01, 0.0)),
        *parts.both(parts.insect_leg(3, "Thorax.001", 0.06, 0.25)),
    ]


def spider() -> list[Part]:
    """Return an eight-legged creature, 0.8 m wide on its legs, whose abdomen swings behind it."""
    thorax = parts.line(
        parts.counted("Thorax", 3),
        [(0, 0.075, 0.12), (0, 0.02, 0.125), (0, -0.04, 0.128), (0, -0.095, 0.128)],
        (0.05, 0.085, 0.095, 0.085),
        "Root",
        (1.1, 1.0, 0.75),
    )
    abdomen = parts.line(
        parts.counted("Tail", 3),
        [(0, 0.08, 0.125), (0, 0.14, 0.15), (0, 0.22, 0.165), (0, 0.31, 0.15)],
        (0.035, 0.1, 0.125, 0.085),
        "Thorax.001",
        (1.0, 1.0, 0.9),
        sides=12,
    )
    marks = tuple(
        Lump((side * x, y, z), (0.5 * side * x, y + 0.03, z + 0.004), (0.022, 0.013), Paint.PALE, (1.0, 1.0, 0.5), 8)
        for x, y, z in ((0.045, 0.16, 0.265), (0.04, 0.23, 0.277))
        for side in (1, -1)
    )
    abdomen[1] = replace(abdomen[1], flesh=(*abdomen[1].flesh, *marks))
    head = (
        Lump((0, -0.11, 0.13), (0, -0.14, 0.132), (0.078, 0.068), squash=(1.05, 1.0, 0.85), sides=12),
        parts.cavity((0, -0.175, 0.095), 0.03, reach=0.01),
        *(
            Lump((side * x, y, z), (side * x, y - 0.002, z + 0.001), (0.011, 0.011), Paint.DARK, sides=8)
            for x, y, z in ((0.058, -0.165, 0.165), (0.03, -0.15, 0.188))
            for side in (1, -1)
        ),
    )
    legs = zip(range(1, 5), ("Thorax.003", "Thorax.002", "Thorax.002", "Thorax.001"), strict=True)
    ways = ((38.0, 0.44), (72.0, 0.42), (106.0, 0.42), (142.0, 0.44))
    return [
        parts.root(0.12),
        *thorax,
        *abdomen,
        Part("Head", "Thorax.003", (0, -0.095, 0.128), (0, -0.195, 0.12), head),
        *parts.both(parts.fang()),
        *parts.both(parts.eye((0.03, -0.188, 0.152), 0.024, "Head")),
        *(
            part
            for (row, parent), way in zip(legs, ways, strict=True)
            for part in parts.both(parts.spider_leg(row, parent, *way))
        ),
    ]


def bird() -> list[Part]:
    """Return a long-necked bird, 0.65 m high, its wings half spread."""
    trunk = parts.line(
        ("Hips", "Spine", "Chest"),
        [(0, 0.07, 0.36), (0, 0.0, 0.37), (0, -0.06, 0.395), (0, -0.12, 0.425)],
        (0.065, 0.09, 0.092, 0.06),
        "Root",
    )
    neck = parts.line(
        parts.counted("Neck", 3),
        [(0, -0.13, 0.435), (0, -0.185, 0.48), (0, -0.185, 0.54), (0, -0.17, 0.59)],
        (0.055, 0.04, 0.034, 0.034),
        "Chest",
    )
    head = (
        Lump((0, -0.18, 0.61), (0, -0.195, 0.61), (0.05, 0.05)),
        Lump((0, -0.235, 0.61), (0, -0.34, 0.592), (0.024, 0.006), Paint.PALE, (0.85, 1.0, 0.9)),
        Lump((0, -0.165, 0.655), (0, -0.1, 0.695), (0.016, 0.006), Paint.DARK, (0.6, 1.0, 1.2)),
        parts.cavity((0, -0.23, 0.597), 0.014, reach=0.05),
    )
    leg = parts.line(
        ("Thigh.L", "Shin.L", "Hock.L"),
        [(0.05, 0.04, 0.33), (0.06, -0.03, 0.245), (0.06, 0.065, 0.145), (0.06, 0.015, 0.022)],
        (0.045, 0.028, 0.014, 0.013),
        "Hips",
    )
    leg[2] = parts.painted(leg[2], Paint.PALE)
    tail = [
        replace(part, flesh=(Lump(part.head, part.tail, (width, width), squash=(1.0, 1.0, 0.3)),))
        for part, width in zip(
            parts.line(
                parts.counted("Tail", 3),
                [(0, 0.1, 0.365), (0, 0.17, 0.355), (0, 0.24, 0.34), (0, 0.31, 0.325)],
                (0.0,) * 4,
                "Hips",
            ),
            (0.04, 0.05, 0.06),
            strict=True,
        )
    ]
    return [
        parts.root(0.12),
        *trunk,
        *neck,
        Part("Head", "Neck.003", (0, -0.17, 0.59), (0, -0.28, 0.6), head),
        parts.jaw((0, -0.21, 0.592), (0, -0.315, 0.58), (0.016, 0.006), (0.9, 1.0, 0.8)),
        *parts.both(parts.eye((0.036, -0.218, 0.625), 0.016, "Head")),
        *parts.both(parts.wing()),
        *parts.both([*leg, parts.claw()]),
        *tail,
    ]


def snake() -> list[Part]:
    """Return a snake, 1.3 m long: a body that winds over the ground behind a raised neck."""
    steps = np.arange(13)
    winding = 0.1 * np.sin(steps * np.pi / 3.0) * np.clip(steps / 3.0, 0.0, 1.0)
    radii = np.interp(steps, (0, 4, 9, 12), (0.055, 0.066, 0.045, 0.01))
    body = [(x, -0.4 + 0.085 * i, r) for i, x, r in zip(steps, winding, radii, strict=True)]
    neck = parts.line(
        parts.counted("Neck", 2),
        [(0, -0.4, 0.055), (0, -0.47, 0.12), (0, -0.49, 0.21)],
        (0.055, 0.05, 0.046),
        "Spine.001",
    )
    head = (
        Lump((0, -0.52, 0.23), (0, -0.57, 0.235), (0.055, 0.068), squash=(1.1, 1.0, 0.7), sides=12),
        Lump((0, -0.6, 0.232), (0, -0.665, 0.222), (0.06, 0.044), squash=(1.05, 1.0, 0.6), sides=12),
        parts.cavity((0, -0.59, 0.208), 0.044, reach=0.06),
    )
    return [
        parts.root(0.15),
        *parts.striped(parts.line(parts.counted("Spine", 12), body, radii, "Root")),
        *neck,
        Part("Head", "Neck.002", (0, -0.49, 0.21), (0, -0.69, 0.225), head),
        parts.jaw((0, -0.53, 0.205), (0, -0.66, 0.193), (0.05, 0.042), (1.1, 1.0, 0.4), 0.65),
        *parts.both(parts.eye((0.048, -0.6, 0.268), 0.026, "Head")),
    ]


def asura() -> list[Part]:
    """Return a tall humanoid with two rows of arms."""
    trunk = parts.line(
        ("Hips", "Spine", "Chest", "UpperChest", "Neck"),
        [(0, 0.0, 1.02), (0, -0.01, 1.16), (0, -0.005, 1.33), (0, 0.01, 1.49), (0, 0.02, 1.66), (0, 0.0, 1.73)],
        (0.115, 0.095, 0.12, 0.13, 0.055, 0.055),
        "Root",
        (1.35, 0.9, 1.0),
        last=1,
    )
    head = (
        Lump((0, -0.005, 1.82), (0, -0.015, 1.85), (0.108, 0.118), squash=(0.93, 1.0, 1.0), sides=12),
        Lump((0, 0.02, 1.98), (0, 0.03, 2.02), (0.055, 0.05), Paint.DARK),
        Lump((0, -0.01, 1.915), (0, 0.0, 1.945), (0.112, 0.075), Paint.PALE, (0.95, 1.0, 0.6), 10),
        *parts.nose(-0.125, 1.82),
        parts.cavity((0, -0.035, 1.77), 0.07),
    )
    return [
        parts.root(0.3),
        *parts.dressed(trunk[:1]),
        *trunk[1:],
        Part("Head", "Neck", (0, 0.0, 1.73), (0, -0.01, 1.97), head),
        parts.jaw((0, -0.02, 1.755), (0, -0.075, 1.73), (0.062, 0.05), (1.1, 1.0, 0.75), paint=Paint.SKIN),
        *parts.both(parts.eye((0.046, -0.1, 1.855), 0.026)),
        *parts.both(
            parts.arm((0.2, 0.02, 1.63), (0.31, 0.29, 0.1), 12.0, 0.055, "UpperChest", clavicle=(0.03, 0.0, 1.63))
        ),
        *parts.both(parts.arm((0.18, -0.01, 1.42), (0.29, 0.27, 0.095), 52.0, 0.05, "Chest", row="2")),
        *parts.both(parts.dressed(parts.leg((0.11, 0.0, 1.0), (0.125, 0.02, 0.095), (0.465, 0.45), 0.095, 0.18), 1)),
    ]


def lopside() -> list[Part]:
    """Return a creature without symmetry: one heavy arm against two thin ones, a long bent leg beside a short one."""
    trunk = parts.line(
        ("Hips", "Spine", "Chest", "Neck"),
        [(0, 0.02, 0.6), (0.01, 0.03, 0.7), (0.03, 0.03, 0.84), (-0.03, -0.03, 1.02), (-0.07, -0.07, 1.07)],
        (0.13, 0.14, 0.18, 0.09, 0.08),
        "Root",
        (1.1, 0.9, 1.0),
        last=1,
    )
    head = (
        Lump((-0.08, -0.09, 1.17), (-0.085, -0.12, 1.2), (0.12, 0.125)),
        Lump((-0.15, -0.08, 1.28), (-0.2, -0.07, 1.38), (0.03, 0.006), Paint.PALE),
        parts.cavity((-0.085, -0.14, 1.1), 0.075, reach=0.04),
    )
    jaw = parts.jaw((-0.08, -0.1, 1.1), (-0.09, -0.22, 1.05), (0.085, 0.07), (1.15, 1.0, 0.6), 0.55)
    teeth = tuple(
        Lump((x, -0.265, 1.075), (x, -0.268, 1.11), (0.016, 0.006), Paint.WHITE) for x in (-0.14, -0.085, -0.04)
    )
    heavy = parts.arm((0.23, 0.02, 0.98), (0.34, 0.34, 0.17), 50.0, 0.095, "Chest", clavicle=(0.05, 0.02, 0.98))
    thin = [
        *parts.arm((0.17, 0.02, 0.98), (0.2, 0.18, 0.06), 15.0, 0.032, "Chest", clavicle=(0.06, 0.02, 0.98)),
        *parts.arm((0.15, 0.0, 0.8), (0.18, 0.17, 0.055), 45.0, 0.028, "Chest", row="2"),
    ]
    return [
        parts.root(0.2),
        *trunk,
        Part("Head", "Neck", (-0.07, -0.07, 1.07), (-0.085, -0.12, 1.32), head),
        replace(jaw, flesh=(*jaw.flesh, *teeth)),
        *parts.eye((-0.03, -0.215, 1.225), 0.045),
        *map(opposite, parts.eye((0.145, -0.21, 1.23), 0.024)),
        *heavy,
        *map(opposite, thin),
        *parts.leg((0.1, 0.0, 0.58), (0.17, 0.03, 0.1), (0.33, 0.31), 0.085, 0.17),
        *map(opposite, parts.leg((0.1, 0.0, 0.58), (0.1, 0.02, 0.07), (0.265, 0.255), 0.06, 0.12)),
    ]


CREATURES: Mapping[str, Callable[[], list[Part]]] = {
    make.__name__: make for make in (biped, hound, beetle, spider, bird, snake, asura, lopside)
}
"""All of them by name."""
