"""The command line: one program for ``blender -b --command morph_retarget`` and ``python -m morph_retarget``."""

import argparse
from collections.abc import Sequence
from functools import cache
from typing import Any, NoReturn

from ...core.errors import MorphError
from . import batching, mapping, playing, retargeting, validating
from .messages import NAME, say

UNUSABLE = 2

_EXAMPLES = """examples:
  {prog} map character.fbx
  {prog} map character.glb --json > map.json
  {prog} retarget walk.bvh character.glb -o walk_on_character.blend
  {prog} retarget "clips.blend#Walk" a.glb b.fbx -o "out/{{source}}_on_{{target}}.glb" --report report.json
  {prog} play "actions.blend#Wave" spider.glb bird.glb -o "out/{{target}}_{{action}}.glb" --report report.json
  {prog} play "actions.blend#Pick Up" character.blend -o picked.blend --target "Hand=Apple" --variant nearest
  {prog} play - hound.blend -o trot.glb --gait trot --speed 2
  {prog} play scene.toml character.fbx hound.blend -o "out/{{target}}.glb"
  {prog} batch clips --on "rigs/*.glb" --out out --jobs 4 --fail-on "slide>0.05,error>10"
  {prog} batch jobs.toml --out out --jobs 4 --timeout 120 --resume
  {prog} validate actions.blend --on stage.blend rigs/*.glb --out grid
"""


def main(argv: Sequence[str]) -> int:
    """Run one command and return its exit status.

    0: all well. 1: some job failed, or was stopped. 2: the request or an input was unusable.
    """
    try:
        arguments = parser().parse_args(list(argv))
    except SystemExit as done:  # what argparse does after help and after usage errors
        return int(done.code or 0)
    try:
        return arguments.run(arguments)
    except MorphError as error:
        say(str(error))
        return UNUSABLE
    except KeyboardInterrupt:
        say("stopped")
        return batching.FAILED


class _Parser(argparse.ArgumentParser):
    """Reports a usage error in one line, as all errors are reported."""

    def error(self, message: str) -> NoReturn:
        self.exit(UNUSABLE, f"{self.prog}: {' '.join(message.split())}: see {self.prog} --help\n")


@cache
def parser() -> argparse.ArgumentParser:
    """Return what reads the command line."""
    looks: dict[str, Any] = {
        "epilog": _EXAMPLES.format(prog=NAME),
        "formatter_class": argparse.RawDescriptionHelpFormatter,
    }
    whole = _Parser(prog=NAME, description="Give any motion to any rig.", **looks)
    commands = whole.add_subparsers(dest="command", required=True, metavar="COMMAND")
    mapping.add_to(commands.add_parser("map", help="tell what a rig is", **looks))
    retargeting.add_to(commands.add_parser("retarget", help="give a clip to one or more rigs", **looks))
    playing.add_to(commands.add_parser("play", help="let characters play an action, or do what a script says", **looks))
    validating.add_to(commands.add_parser("validate", help="judge generalized actions on many characters", **looks))
    batching.add_to(commands.add_parser("batch", help="give many clips to many rigs, in worker processes", **looks))
    batching.add_worker_to(commands.add_parser(batching.WORKER))  # without help, it is not listed
    return whole
