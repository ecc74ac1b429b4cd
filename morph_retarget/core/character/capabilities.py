"""Tagging every bone with what it can do (Hecker 2008 §1.2), from the joint map and the morphology."""

from collections.abc import Iterator, Mapping, Sequence

from .anatomy import Evidence
from .joint_names import is_extra
from .morphology import Capability, LimbKind, Morphology
from .trunk import Trunk
from .words import Sense

_Tags = Iterator[tuple[int, Capability]]


def tag(evidence: Evidence, plan: Morphology, joints: Mapping[str, int], humanoid: bool) -> dict[int, list[Capability]]:
    """Return the capabilities of every bone that has any, in the order of `Capability`.

    Args:
        evidence: The rig.
        plan: Its trunk and limbs.
        joints: Its VRM joints, as far as they were found: joint to bone.
        humanoid: Whether it grasps with its hands alone.
    """
    tags: dict[int, set[Capability]] = {}
    mouths = mouth_bones(evidence, joints.get("jaw"))
    found = [*_trunk(plan.trunk), *_limbs(evidence, plan), *_face(evidence, plan.trunk, joints, mouths)]
    if not humanoid:
        found += _creature_graspers(evidence, plan, mouths)
    for bone, capability in found:
        tags.setdefault(bone, set()).add(capability)
    order = list(Capability)
    return {bone: sorted(own, key=order.index) for bone, own in sorted(tags.items())}


def _trunk(trunk: Trunk) -> _Tags:
    yield trunk.root, Capability.ROOT
    yield from ((bone, Capability.SPINE) for bone in trunk.spine)
    yield from ((bone, Capability.NECK) for bone in trunk.neck)
    yield from ((bone, Capability.TAIL) for tail in trunk.tails for bone in tail)
    if trunk.head is not None:
        yield trunk.head, Capability.HEAD


_ENDS = {LimbKind.LEG: Capability.FOOT, LimbKind.ARM: Capability.GRASPER}
_WHOLE = {LimbKind.WING: Capability.WING, LimbKind.FIN: Capability.FIN}


def _limbs(evidence: Evidence, plan: Morphology) -> _Tags:
    for limb in plan.limbs:
        yield from ((bone, Capability.LIMB) for bone in limb.bones)
        if limb.kind in _ENDS:
            yield limb.end, _ENDS[limb.kind]
        if limb.kind in _WHOLE:
            yield from ((bone, _WHOLE[limb.kind]) for bone in (*limb.bones, *limb.digits))
        if limb.kind is LimbKind.ARM:
            fingers = (bone for bone in limb.digits if not is_extra(evidence.readings[bone]))
            yield from ((bone, Capability.FINGER) for bone in fingers)


def _face(evidence: Evidence, trunk: Trunk, joints: Mapping[str, int], mouths: Sequence[int]) -> _Tags:
    for bone, reading in enumerate(evidence.readings):
        parent = int(evidence.tree.parents[bone])
        goes_on = parent >= 0 and evidence.readings[parent].has(Sense.EAR)
        if reading.has(Sense.EAR) and not goes_on and not evidence.thing[bone] and not is_extra(reading):
            yield bone, Capability.EAR
    eyes = [joints[e] for e in ("leftEye", "rightEye") if e in joints]
    yield from ((bone, Capability.EYE) for bone in eyes or _topmost(evidence, Sense.EYE))
    yield from ((bone, Capability.MOUTH) for bone in mouths)
    if trunk.head is not None and not mouths and trunk.head_by == "name":
        yield trunk.head, Capability.MOUTH


def _creature_graspers(evidence: Evidence, plan: Morphology, mouths: Sequence[int]) -> _Tags:
    """Yield what a creature takes things with besides hands: the lower jaw, or a head without one; a bird's feet."""
    head = plan.trunk.head
    on_head = [b for b in mouths if head is not None and evidence.tree.is_below(head, b)]
    middle = [b for b in on_head if not evidence.readings[b].side]
    takes = [min(middle, key=lambda b: _mean_height(evidence, b))] if middle else on_head
    if head is not None and not mouths and plan.trunk.head_by == "name":
        takes.append(head)
    takes += _trunk_tips(evidence, head)
    takes += [limb.end for limb in plan.of(LimbKind.TENTACLE)]
    legs, wings = plan.of(LimbKind.LEG), plan.of(LimbKind.WING)
    if wings and not plan.of(LimbKind.ARM) and len({leg.row for leg in legs}) == 1:
        takes += [leg.end for leg in legs]
    yield from ((bone, Capability.GRASPER) for bone in takes)


def _trunk_tips(evidence: Evidence, head: int | None) -> list[int]:
    """Return the tips of noses that grasp: chains of several "trunk" bones on the head."""
    if head is None:
        return []
    nose = [b for b in range(len(evidence)) if {"trunk", "proboscis"} & set(evidence.readings[b].words)]
    nose = [b for b in nose if evidence.tree.is_below(head, b) and not is_extra(evidence.readings[b])]
    return [b for b in nose if len(nose) >= 3 and not any(c in nose for c in evidence.tree.children[b])]


def mouth_bones(evidence: Evidence, jaw: int | None) -> list[int]:
    """Return the bones of the mouth: a jaw, beaks, fangs; of bones in line the one whose name says least besides."""
    found = _topmost(evidence, Sense.MOUTH)
    found += [b for b in _topmost(evidence, Sense.JAW) if evidence.readings[b].side and b not in found]
    if jaw is not None and jaw not in found:
        found = [
            b for b in found if evidence.readings[b].has(Sense.MOUTH) and "teeth" not in evidence.readings[b].words
        ]
        found.append(jaw)
    if not found:
        found = [
            b
            for b in range(len(evidence))
            if "chin" in evidence.readings[b].words and not is_extra(evidence.readings[b])
        ]
    return found


def _topmost(evidence: Evidence, sense: Sense) -> list[int]:
    """Return bones of a sense, one for each line of them."""
    bones = [b for b in range(len(evidence)) if evidence.readings[b].has(sense) and not evidence.thing[b]]
    tops = [b for b in bones if not any(a in bones for a in evidence.tree.ancestors[b])]
    out: list[int] = []
    for top in tops:
        line = [top, *(b for b in bones if evidence.tree.is_below(top, b) and not is_extra(evidence.readings[b]))]
        sided = [b for b in line if evidence.readings[b].side == evidence.readings[top].side]
        fewest = min(len(evidence.readings[b].words) for b in sided)
        plain = [b for b in sided if len(evidence.readings[b].words) == fewest]
        # Two plain ones in line are the upper and the lower half.
        out.extend(plain if _are_halves(evidence, plain) else plain[:1])
    return out


def _are_halves(evidence: Evidence, bones: list[int]) -> bool:
    return len(bones) == 2 and {Sense.UPPER, Sense.LOWER} <= {s for b in bones for s in evidence.readings[b].senses}


def _mean_height(evidence: Evidence, bone: int) -> float:
    below = [bone, *evidence.tree.below(bone)]
    return float(evidence.tails[below, 2].mean())
