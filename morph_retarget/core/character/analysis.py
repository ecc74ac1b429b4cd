"""From a skeleton to a `Character`: the one entrance to the analysis."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from .. import quat
from ..arrays import Array
from ..errors import RigError
from ..skeleton import Skeleton
from . import capabilities, face, fingers, joints, morphology, named_body, orientation
from .anatomy import Evidence, collect
from .character import Character
from .families import BODY
from .frame import CharacterFrame, Placement
from .joint_map import Found
from .joints import JointMatch
from .morphology import Limb, LimbKind, Morphology
from .named_body import MARGIN, NamedBody
from .orientation import SideVotes, Sight
from .trunk import Trunk
from .words import Sense

UPRIGHT = 0.7
"""Cosine of the lean from hips to head up to which a biped with arms counts as a humanoid …"""
UPRIGHT_WITH_TAIL = 0.9
"""… and one that also has a tail."""
FOLDED = 0.6
"""A leg is folded whose foot is nearer to the hip than this share of the leg's length."""
_LIMB_JOINTS = tuple(joint for joint in BODY if joint.startswith(joints.SIDES))
_TRUNK_JOINTS = ("hips", "spine", "chest", "upperChest", "neck", "head", "jaw", "leftEye", "rightEye")


@dataclass(frozen=True, eq=False)
class Overrides:
    """What the user knows better."""

    up: Array | None = None
    """Unit vector, world space."""
    forward: Array | None = None
    """Unit vector, world space."""
    joints: Mapping[str, str] = field(default_factory=dict[str, str])
    """Joint to bone name; an empty name says that the rig has no such joint."""


def analyze(
    skeleton: Skeleton,
    placement: Placement | None = None,
    overrides: Overrides | None = None,
    positions: Array | None = None,
) -> Character:
    """Find out what a rig is (Feng 2013 §3 and beyond).

    Args:
        skeleton: The rig at rest, armature space.
        placement: Where its armature stands in the world; not moved when None.
        overrides: What the user knows better.
        positions: Bone heads to judge in place of the rest pose, armature space, shape (bone, 3): a frame of a
            clip, for rigs whose rest is no pose.

    Raises:
        RigError: The rig has a single bone.
        MappingError: An override names a joint or bone that does not exist.
    """
    if len(skeleton) < 2:
        raise RigError(f"the armature has one bone, {skeleton.names[0]!r}, which tells nothing: choose a whole rig")
    placement = placement or Placement.identity()
    overrides = overrides or Overrides()
    heads = skeleton.rest_positions if positions is None else positions
    tails = skeleton.rest_tails if positions is None else positions
    evidence = collect(skeleton, placement.points(heads), placement.points(tails))
    sight = orientation.look(evidence, placement, overrides.up)
    votes = orientation.side_votes(sight)
    if overrides.forward is not None:
        left = quat.cross(sight.body.axes[2], overrides.forward)
        votes = SideVotes(0.0, 10.0 * math.copysign(1.0, float(left @ sight.body.axes[0])))
    plan = morphology.find(sight.body, left_is_x=votes.sign > 0)
    if orientation.is_no_pose(sight, overrides.up) and len({leg.row for leg in plan.of(LimbKind.LEG)}) < 2:
        sight = orientation.look_blind(evidence, placement, overrides.up) or sight
        votes = orientation.side_votes(sight) if overrides.forward is None else votes
        plan = morphology.find(sight.body, left_is_x=votes.sign > 0)
    upright = _is_upright(sight, plan)
    humanoid = upright or _is_person(sight, plan)
    named = named_body.find(evidence)
    if named is not None and not (upright and named.agrees(sight.decision) and _sides_agree(sight, votes, named)):
        sight, humanoid = named.sight(evidence, overrides.up, overrides.forward), True
        votes, overrides = SideVotes(MARGIN, 0.0), replace(overrides, forward=-sight.body.axes[1])
        plan = morphology.find(sight.body, left_is_x=True)
    found = _joints(sight, votes, plan, humanoid)
    matches = joints.override(_filled(found, named, skeleton), overrides.joints, skeleton)
    bones = {joint: skeleton.index[match.bone] for joint, match in matches.items()}
    if humanoid:
        plan = _humanoid_plan(evidence, plan, bones, sight.decision.spine)
    tags = capabilities.tag(evidence, plan, bones, humanoid)
    frame = _frame(sight, votes, overrides, placement, bones, plan, posed=positions is not None)
    return Character(
        skeleton=skeleton,
        placement=placement,
        frame=frame,
        joints=matches,
        capabilities={skeleton.names[bone]: tuple(found) for bone, found in tags.items()},
        limbs=plan.limbs,
        spine=plan.trunk.spine,
        neck=plan.trunk.neck,
        head=plan.trunk.head,
        tails=plan.trunk.tails,
        humanoid=humanoid,
        floor=_floor(frame, placement),
        rest_is_pose=sight.trust == 1.0 and positions is None,
        plausibility=sight.decision.shape,
        warnings=tuple(_warnings(sight, votes)),
    )


def _is_upright(sight: Sight, plan: Morphology) -> bool:
    """Return whether a body has a pair of arms besides its legs, and a head above them."""
    found = sight.decision.joints
    if not {"leftUpperLeg", "rightUpperLeg"} & found.keys() or not {"leftUpperArm", "rightUpperArm"} & found.keys():
        return False
    if sight.trust < 1.0:
        return True
    legs = plan.of(LimbKind.LEG)
    if legs and all(limb.side == 0 for limb in legs):
        return False  # what hops on one leg has no others, whatever the search took for them
    if _goes_on_arms(sight, plan):
        return False
    head = found["head"].bone if "head" in found else plan.trunk.head
    if head is None:
        return False
    rise = sight.body.points[head] - sight.body.points[found["hips"].bone]
    least = UPRIGHT_WITH_TAIL if plan.trunk.tails else UPRIGHT
    return float(rise[2]) > least * float(np.linalg.norm(rise))


def _is_person(sight: Sight, plan: Morphology) -> bool:
    """Return whether names call all joints of arms and legs so, on a body that is no beast: people lean and crouch."""
    found = sight.decision.joints
    if not all(joint in found and found[joint].by == "name" for joint in _LIMB_JOINTS):
        return False
    return not _is_beast(sight.body.evidence, plan) and (not _goes_on_arms(sight, plan) or _is_crouched(sight))


def _goes_on_arms(sight: Sight, plan: Morphology) -> bool:
    """Return whether arms are among the legs."""
    found, feet = sight.decision.joints, {b for limb in plan.of(LimbKind.LEG) for b in limb.bones}
    return bool(feet & {found[j].bone for j in ("leftLowerArm", "rightLowerArm") if j in found})


def _is_beast(evidence: Evidence, plan: Morphology) -> bool:
    """Return whether a rig has what people have not: a tail, wings or fins."""
    return bool(plan.trunk.tails) or any(r.has(Sense.TAIL, Sense.WING, Sense.FIN) for r in evidence.readings)


def _is_crouched(sight: Sight) -> bool:
    """Return whether both legs are folded, as of people whose hands come down to the ground beside them."""
    legs = [
        [sight.decision.joints[side + joint].bone for joint in ("UpperLeg", "LowerLeg", "Foot")]
        for side in joints.SIDES
    ]
    places = sight.body.points[legs]
    straight = np.linalg.norm(places[:, 2] - places[:, 0], axis=-1)
    return bool((straight < FOLDED * np.linalg.norm(np.diff(places, axis=1), axis=-1).sum(axis=1)).all())


def _sides_agree(sight: Sight, votes: SideVotes, named: NamedBody) -> bool:
    """Return whether names and body say the same of left and right, or the body is straight enough to outvote them."""
    return not votes.contradicted or not named.is_lopsided(sight.body)


# --- joints ---


def _joints(sight: Sight, votes: SideVotes, plan: Morphology, humanoid: bool) -> dict[str, JointMatch]:
    """Return the joints with their sides settled, fingers and face included."""
    evidence = sight.body.evidence
    found = dict(sight.decision.joints)
    legs = [limb.end for limb in plan.of(LimbKind.LEG)]
    walks = humanoid or any(found[j].bone in legs for j in ("leftFoot", "rightFoot") if j in found)
    if not humanoid:
        found = _creature_trunk(evidence, plan) | (
            {j: f for j, f in found.items() if "Leg" in j or "Foot" in j} if walks else {}
        )
    if "head" in found:
        for joint, (bone, by) in face.find(sight.body, found["head"].bone, sight.trust == 1.0).items():
            found[joint] = Found(bone, 3.0 if by == "name" else 0.5, by)
    sided = {_settle_side(evidence, votes, joint, f.bone): f for joint, f in found.items()}
    if humanoid:
        forward = quat.cross(votes.sign * sight.body.axes[0], sight.body.axes[2])
        for side in joints.SIDES:
            if f"{side}Hand" in sided:
                for joint, (bone, by) in fingers.find(evidence, sided[f"{side}Hand"].bone, forward).items():
                    sided[side + joint] = Found(bone, 3.0 if by == "name" else 0.5, by)
    names = evidence.skeleton.names
    return joints.in_order(
        {joint: JointMatch(names[f.bone], _confidence(f.margin), f.by) for joint, f in sided.items()}
    )


def _filled(found: Mapping[str, JointMatch], named: NamedBody | None, skeleton: Skeleton) -> dict[str, JointMatch]:
    """Return joints with those that nobody found, but that the names of a family tell."""
    if named is None:
        return dict(found)
    taken = {match.bone for match in found.values()}
    told = {joint: skeleton.names[bone] for joint, bone in named.bones.items() if joint not in found}
    new = {j: JointMatch(b, _confidence(MARGIN), "name") for j, b in told.items() if b not in taken}
    return joints.in_order({**found, **new})


def _creature_trunk(evidence: Evidence, plan: Morphology) -> dict[str, Found]:
    """Return hips, spine, neck and head of a body that is no humanoid."""
    trunk = plan.trunk
    out: dict[str, Found] = {}
    line = [b for b in trunk.spine if trunk.head is None or evidence.tree.is_below(b, trunk.head)] or list(trunk.spine)
    if not line:
        return out
    last = len(line) - 1
    places = {0: ("hips",), 1: ("hips", "spine"), 2: ("hips", "spine", "chest")}.get(
        last, ("hips", "spine", "chest", "upperChest")
    )
    for i, joint in enumerate(places):
        bone = line[last if joint == "upperChest" else (last + 1) // 2 if joint == "chest" and last > 2 else i]
        out[joint] = Found(bone, 1.0, "topology")
    if trunk.neck:
        out["neck"] = Found(trunk.neck[0], 1.0, "topology")
    if trunk.head is not None:
        out["head"] = Found(trunk.head, 2.0, trunk.head_by)
    return out


def _settle_side(evidence: Evidence, votes: SideVotes, joint: str, bone: int) -> str:
    """Return ``joint`` on the character's own side.

    Names decide where both partners carry one and the body does not contradict them; else the place does.
    """
    if not joint.startswith(joints.SIDES):
        return joint
    base = joint.removeprefix("left").removeprefix("right")
    side = evidence.readings[bone].side
    if side and evidence.by_name[bone] >= 0 and not votes.contradicted:
        return ("left" if side > 0 else "right") + base
    return joints.mirrored(joint) if votes.sign < 0 else joint


def _confidence(margin: float) -> float:
    return round(1.0 / (1.0 + math.exp(-max(min(margin, 12.0), -12.0))), 3)


# --- plan and frame ---


def _humanoid_plan(evidence: Evidence, plan: Morphology, bones: Mapping[str, int], spine: Sequence[int]) -> Morphology:
    """Return the morphology with trunk, legs and arms as the joint map has them; other limbs stay."""
    limbs: list[Limb] = []
    for side, name in ((1, "left"), (-1, "right")):
        for kind, chain in (
            (LimbKind.LEG, ("UpperLeg", "LowerLeg", "Foot")),
            (LimbKind.ARM, ("Shoulder", "UpperArm", "LowerArm", "Hand")),
        ):
            there = [bones[name + j] for j in chain if name + j in bones]
            if there:
                line = evidence.tree.path(there[0], there[-1]) or there
                digits = tuple(evidence.tree.below(there[-1]))
                limbs.append(Limb(kind, side, 0, tuple(line), digits))
    used = {b for limb in limbs for b in limb.bones}
    limbs += [m for m in plan.limbs if (m.kind is not LimbKind.LEG or m.side == 0) and not used & set(m.bones)]
    head = bones.get("head", plan.trunk.head)
    hips = bones.get("hips", plan.trunk.root)
    chest = next((bones[j] for j in ("upperChest", "chest", "spine") if j in bones), hips)
    neck = evidence.tree.path(bones["neck"], head)[:-1] if "neck" in bones and head is not None else []
    line = evidence.tree.path(hips, chest)[1:] or (
        evidence.tree.path(evidence.tree.top_of(chest, hips), chest) if chest != hips else []
    )
    # What the user mapped counts, what the search left out as helpers does not.
    mapped = {bones[j] for j in ("spine", "chest", "upperChest") if j in bones}
    spine = [hips, *(b for b in line if b in mapped or b in spine)]
    # Where a rest is so bent that no limbs were seen, the way from head to tail may lead down a leg.
    body = {*bones.values(), *spine, *neck, *(b for limb in limbs for b in (*limb.bones, *limb.digits))}
    tails = tuple(tail for tail in plan.trunk.tails if not body & {*tail})
    trunk = Trunk(plan.trunk.root, tuple(spine), tuple(neck), head, plan.trunk.head_by, tails)
    return Morphology(trunk, tuple(limbs))


def _frame(
    sight: Sight,
    votes: SideVotes,
    overrides: Overrides,
    placement: Placement,
    bones: Mapping[str, int],
    plan: Morphology,
    posed: bool,
) -> CharacterFrame:
    evidence = sight.body.evidence
    up = sight.body.axes[2]
    left = votes.sign * sight.body.axes[0]
    forward = quat.cross(left, up)
    if overrides.forward is not None:
        forward = quat.unit(overrides.forward - (overrides.forward @ up) * up)
    elif posed or not sight.faces:
        # Such a rest faces nowhere: the world's own front is kept, so that clips of one actor agree.
        forward = quat.cross(np.array([1.0, 0.0, 0.0]), up) if abs(up[0]) < 0.9 else forward
    heights = evidence.positions @ up
    top, ground = _top(evidence, heights, plan), _ground(evidence, heights, placement, up, plan)
    hips = bones.get("hips", plan.trunk.root)
    root = placement.points(evidence.skeleton.rest_positions[hips]) if posed else evidence.positions[hips]
    origin = root + (ground - root @ up) * up
    return CharacterFrame(up, forward, origin, max(float(top - ground), 1e-6))


def _top(evidence: Evidence, heights: Array, plan: Morphology) -> float:
    """Return the height of the crown of the head over the world's origin, measured along up [m]."""
    solid = heights[evidence.solid]
    head = plan.trunk.head
    if head is None or heights[head] < solid.max() - 0.02 * evidence.extent:
        return float(solid.max())
    # The joint is the highest there is: a head stands about one eighth of the body above its joint.
    return float(heights[head] + 0.12 * (heights[head] - solid.min()))


def _ground(evidence: Evidence, heights: Array, placement: Placement, up: Array, plan: Morphology) -> float:
    """Return the height of the ground: the plane of the object's origin if feet stand on it, else below the feet."""
    legs = [b for limb in plan.limbs if limb.kind is LimbKind.LEG for b in (*limb.bones[-1:], *limb.digits)]
    low = float(heights[legs].min()) if legs else float(heights[evidence.solid].min())
    extent = float(np.ptp(heights[evidence.solid]))
    plane = float(placement.translation @ up)
    if -0.03 * extent < low - plane < 0.13 * extent:
        return plane
    has_toes = any(limb.digits for limb in plan.limbs if limb.kind is LimbKind.LEG)
    return low - (0.01 if has_toes else 0.045) * extent if legs else low


def _floor(frame: CharacterFrame, placement: Placement) -> float:
    """Return the height of the floor that a rig plays on over its own ground [m], see `Character.floor`."""
    origin = float((placement.translation - frame.origin) @ frame.up)
    return origin if 0.2 * frame.height < origin < 0.9 * frame.height else 0.0


def _warnings(sight: Sight, votes: SideVotes) -> list[str]:
    out: list[str] = []
    if votes.contradicted:
        out.append(
            "the names of left and right contradict the body: sides follow the body; "
            "set the forward axis if that is wrong"
        )
    elif sight.trust == 1.0:
        body, evidence = sight.body, sight.body.evidence
        for bone in (f.bone for f in sight.decision.joints.values()):
            side = evidence.readings[bone].side
            if side and evidence.by_name[bone] < 0 and side * votes.sign * body.points[bone, 0] < -0.02:
                out.append(
                    f"bone {evidence.skeleton.names[bone]!r} lies on the other side than its name says: "
                    "its place decides"
                )
    if sight.trust < 1.0:
        out.append("the rest pose does not look like a body: joints were found by name")
    return out
