"""The sample scenes of locomotion, as they are committed: who opens one sees the character go."""

from dataclasses import dataclass
from functools import cached_property

import bpy
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

from morph_retarget.blender.locomotion import walks
from morph_retarget.blender.locomotion.walk import Walk
from morph_retarget.blender.morph import cast, definitions
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.arrays import Array, Flags
from morph_retarget.core.locomotion.stepping.gait import Gait
from tests.blender import acting, scenes
from tools.pictures import SAMPLES
from tools.walks import GAITS, SPEEDS, STEP, STEPS, WALKS

LEGGED = tuple(name for name in WALKS if name != "crawl_snake")
STILL = 0.002
"""Standing soles move less than this from frame to frame [leg lengths]."""
NEAR_GROUND = 0.02
"""They are no further from the ground than this [leg lengths]."""

pytestmark = pytest.mark.usefixtures("registered")


@dataclass(frozen=True, eq=False)
class Seen:
    """A sample as Blender shows it."""

    ob: bpy.types.Object
    frames: Array

    @property
    def walk(self) -> Walk:
        """How it goes."""
        found = walks.known(self.ob, bpy.context.scene)
        assert found is not None
        return found

    @property
    def gait(self) -> Gait:
        """Its gait, where it goes on feet."""
        assert isinstance(self.walk.gait, Gait)
        return self.walk.gait

    @cached_property
    def soles(self) -> Array:
        """Heels and tips of the feet in the world [m], shape (frame, leg, 2, 3)."""
        legs, character = self.gait.legs.legs, self.gait.character
        names = [character.skeleton.names[leg.foot] for leg in legs]
        matrices = scenes.evaluated(self.ob, names, self.frames)
        points = np.array([[leg.home + leg.heel, leg.home + leg.tip] for leg in legs])
        rest = character.local_to_character.inverse().points(points)
        inverse = np.linalg.inv([np.array(self.ob.data.bones[name].matrix_local) for name in names])
        local = np.einsum("lij,lpj->lpi", inverse[:, :3, :3], rest) + inverse[:, None, :3, 3]
        return np.einsum("flij,lpj->flpi", matrices[..., :3, :3], local) + matrices[..., None, :3, 3]

    @property
    def lengths(self) -> Array:
        """Of the legs [m], shape (leg,)."""
        return np.array([leg.length for leg in self.gait.legs.legs])

    @property
    def stands(self) -> Flags:
        """Shape (frame, leg)."""
        return self.gait.contacts(self.walk.clock.times(self.frames))

    def root(self) -> Array:
        """Return where its hips are in the world [m], shape (frame, 3)."""
        name = self.ob.data.bones[1].name
        return scenes.heads(self.ob, [name], self.frames)[:, 0]


def _opened(name: str, step: float = 1.0) -> Seen:
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / f"{name}.blend"))
    scene = bpy.context.scene
    (ob,) = cast.performers(scene)
    frames = np.arange(float(scene.frame_start), scene.frame_end + 0.5, step)
    scenes.heads(ob, [ob.data.bones[0].name], [1.0])
    assert not walks.problems
    assert not cast.problems
    return Seen(ob, frames)


@pytest.mark.parametrize("name", WALKS)
def test_a_sample_is_small_live_and_ready_to_be_rendered(name: str) -> None:
    seen = _opened(name, 20.0)
    scene = bpy.context.scene
    assert (SAMPLES / f"{name}.blend").stat().st_size < 300_000
    assert (scene.frame_start, scene.frame_end) == (1, WALKS[name].frames)
    assert definitions.is_generalized(cast.action_of(seen.ob))
    assert of_rig(seen.ob).gait.enabled
    assert not seen.walk.gait.warnings
    assert float(np.linalg.norm(np.diff(seen.root(), axis=0), axis=-1).max()) > 0.1


@pytest.mark.parametrize("name", WALKS)
def test_the_camera_sees_all_of_the_way(name: str) -> None:
    seen = _opened(name)
    scene = bpy.context.scene
    for frame in (scene.frame_start, scene.frame_end // 2, scene.frame_end):
        for place in scenes.heads(seen.ob, [bone.name for bone in seen.ob.data.bones][1:], [frame])[0].tolist():
            x, y, depth = world_to_camera_view(scene, scene.camera, Vector(place))
            assert 0.0 < x < 1.0
            assert 0.0 < y < 1.0
            assert depth > 0.0


@pytest.mark.parametrize("name", LEGGED)
def test_feet_stand_still_on_the_ground(name: str) -> None:
    seen = _opened(name)
    firsts = seen.frames[:-1:4]
    seen = Seen(seen.ob, np.ravel([firsts, firsts + 1.0], order="F"))
    both = (seen.stands[1:] & seen.stands[:-1])[::2]
    steps = np.linalg.norm(np.diff(seen.soles, axis=0)[::2], axis=-1).min(axis=-1) / seen.lengths
    assert steps[both].max() < STILL
    assert both.any(axis=0).all()


@pytest.mark.parametrize("name", ["walk_biped", "gaits_hound"])
def test_feet_on_a_floor_are_never_below_it(name: str) -> None:
    seen = _opened(name, 3.0)
    lowest = seen.soles[..., 2].min(axis=-1) / seen.lengths
    assert lowest.min() > -NEAR_GROUND
    assert np.abs(lowest[seen.stands]).max() < NEAR_GROUND


def test_the_biped_walks_to_the_end_of_its_path() -> None:
    seen = _opened("walk_biped", 5.0)
    way = seen.root()
    path = of_rig(seen.ob).gait.path
    start, *_, end = (np.array(point.co) for point in path.data.splines[0].bezier_points)
    assert np.linalg.norm((way[0] - start)[:2]) < 0.1
    assert np.linalg.norm((way[-1] - end)[:2]) < 0.4
    assert np.ptp(way[:, 0]) > 0.8, "it goes in curves"


def test_the_hound_stands_and_changes_its_gait_with_its_speed() -> None:
    seen = _opened("gaits_hound")
    assert {marker.name: marker.frame for marker in bpy.context.scene.timeline_markers} == GAITS
    stands = seen.stands
    assert stands[: GAITS["Walk"] // 3].all()
    assert stands[-1].all()
    duty = {name: stands[frame + 8 : frame + 40].mean() for name, frame in GAITS.items()}
    assert duty["Walk"] > duty["Trot"] > duty["Canter"] > duty["Gallop"]
    assert stands[GAITS["Walk"] + 8 : GAITS["Walk"] + 50].sum(axis=-1).min() >= 2
    assert stands[GAITS["Gallop"] : GAITS["Gallop"] + 40].sum(axis=-1).min() == 0, "it flies"
    frames = np.array(list(SPEEDS), dtype=np.float64)
    speeds = np.array(list(SPEEDS.values()))
    way = float((0.5 * (speeds[1:] + speeds[:-1]) * np.diff(frames)).sum())
    root = seen.root()
    assert -(root[-1] - root[0])[1] == pytest.approx(way / seen.walk.clock.second, rel=0.03)


def test_the_beetle_stays_on_its_hill() -> None:
    seen = _opened("hill_beetle")
    hill = of_rig(seen.ob).gait.ground
    assert -np.diff(seen.root()[[0, -1], 1])[0] > 2.0
    assert _from(hill, seen.soles.min(axis=2)[seen.stands]).max() < 0.01


def _from(ground: bpy.types.Object, points: Array) -> Array:
    """Return how far points are from a mesh [m], shape (n,)."""
    found = [ground.closest_point_on_mesh(point)[1] for point in points.tolist()]
    return np.linalg.norm(np.array(found) - points, axis=-1)


def test_the_spider_comes_to_the_top_of_the_stair() -> None:
    seen = _opened("stair_spider")
    way = seen.root()
    assert way[-1, 2] - way[0, 2] == pytest.approx(STEP[1] * STEPS, abs=0.1)
    heights = seen.soles[..., 2].min(axis=-1)[seen.stands]
    assert np.abs(heights / STEP[1] - np.round(heights / STEP[1])).max() < 0.1, "feet stand on steps"


def test_the_snake_winds_along_its_path_on_its_belly() -> None:
    seen = _opened("crawl_snake", 5.0)
    bodies = [bone.name for bone in seen.ob.data.bones if bone.name.startswith("Spine")]
    places = scenes.heads(seen.ob, bodies, seen.frames)
    rest = np.array([seen.ob.data.bones[name].head_local[2] for name in bodies])
    assert np.abs(places[..., 2] - rest).max() < 0.02
    assert np.linalg.norm((places[-1, 0] - places[0, 0])[:2]) > 2.5
    # Each part goes where the one before it went.
    dense = scenes.heads(seen.ob, bodies, np.arange(1.0, 182.0))[..., :2]
    for body in (4, 8):
        for place in dense[120::10, body]:
            assert np.linalg.norm(dense[:, 0] - place, axis=-1).min() < 0.05


@pytest.mark.parametrize("name", WALKS)
def test_baked_it_goes_without_the_extension_as_it_did_live(name: str) -> None:
    seen = _opened(name, 30.0)
    live = acting.shown(seen.ob, seen.frames)
    acting.baked(seen.ob)
    assert acting.apart(acting.shown(seen.ob, seen.frames), live) < 1e-4
