"""What to try with each sample file: kept in it as the text "Try This", and shown in the documentation."""

from collections.abc import Mapping

import bpy

NAME = "Try This"
_FIRST = """The extension Morph Retarget has to be installed for this.
Our tab is in the 3D viewport's sidebar: press N, and choose Morph Retarget."""
_CHARACTER = """A character to try things on: {0}.

- Import a clip (BVH, FBX, glTF). In the tab choose its armature as Source, this one as
  Target, and press Retarget.
- Press Analyze: joints under Joints tell what the rig was found to be.
- Press Add Locomotion in the panel Locomotion, and then Space: it goes by itself.
- Press Direct in the panel Directing, and give it commands: walk, wave, sit."""
_WHO: Mapping[str, str] = {
    "asura": "a giant with four arms",
    "beetle": "six legs and a shell",
    "biped": "a human figure",
    "bird": "two legs, wings and a beak",
    "hound": "four legs and a tail",
    "lopside": "nothing about it is symmetric",
    "snake": "no limbs at all",
    "spider": "eight legs",
}
TRIES: Mapping[str, str] = {
    "stage.blend": """Nine bodies play one action.

- Press Space.
- Select a character. In the menu of the panel Generalized Action choose another action:
  Clap, Dance, Shake Hands. Of Wave and Sit, below, it takes the branch that fits its body.
- In Pose mode grab a hand with G: the others follow while you drag. Ctrl Z takes it back.
- Move the red fruit of a character while it eats.
- Change a movement mode of a channel: the active character keeps its motion.""",
    "actions.blend": """The sample actions, and nobody to play them.

- In a file with armatures of your own: File > Append, this file, Action. Select an
  armature and choose the action in the panel Generalized Action; Add Selected lets others
  play it too.
- On the command line: play "actions.blend#Wave by Hand" character.glb -o out.blend
- All at once, judged: validate actions.blend --on character.glb --out grid""",
    "sprout.blend": """A small figure with a big head, a tail, fingers and bones rolled at random.

- File > Import > BVH: walk_and_wave.bvh, which lies beside this file.
- In the tab choose walk_and_wave as Source and Sprout as Target, and press Retarget.
- Press Live, then change Travel Scale or Plant Feet: you see at once what it does.
- Bake Jiggles gives its tail a life of its own.""",
    "walk_biped.blend": """A walk along a curve.

- Press Space.
- Edit the curve Path, or set another Speed in the panel Locomotion.
- Mix in a style: Styles, +, Limp, and set its weight.
- In Generalized Action add a channel for graspers, and pose a hand: it waves while it walks.""",
    "gaits_hound.blend": """Standing, walk, trot, canter, gallop and a stop, from one keyed speed.

- Press Space.
- Open the Graph Editor and pull the keys of Speed up and down: the gait follows.
- The bars in the panel Locomotion show which feet stand.
- Set Style to Pace or Bound.""",
    "hill_beetle.blend": """Six legs over rough hills.

- Press Space.
- Sculpt or move the mesh Hill: feet find the new ground.
- Set Stride to 0.6 and Step Height to 2: short high steps.""",
    "stair_spider.blend": """Eight legs up a stair.

- Press Space.
- Scale the mesh Stair in Z to 1.5: feet are lifted higher, the body leans.
- Set Tilt to 0, and see what it is good for.""",
    "crawl_snake.blend": """No legs: it winds along a curve, and nothing slips sideways.

- Press Space.
- Edit the curve Path.
- Set Movement in Steps and Body to Inchworm.""",
    "direct_biped.blend": """A character that does what a list of commands says.

- Press Space.
- In the panel Directing drag the frame of a command, or set the speed of start walk to 1.8.
- Move the Bird: it is looked at wherever it is.
- Add a command: start dance, after the last one.
- Commands to Markers puts them on the time line, where you can drag them.""",
    **{f"characters/{name}.blend": _CHARACTER.format(who) for name, who in _WHO.items()},
}
"""By file below `sample_blends`."""


def text_of(path: str) -> str:
    """Return what a sample file says."""
    return f"{TRIES[path]}\n\n{_FIRST}\n"


def write(path: str) -> None:
    """Put what a sample file says into the open file."""
    text = bpy.data.texts.get(NAME) or bpy.data.texts.new(NAME)
    text.from_string(text_of(path))
    text.use_fake_user = True
