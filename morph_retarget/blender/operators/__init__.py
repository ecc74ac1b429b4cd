"""Everything that buttons and scripts can do; each operator is thin: collect, one call, write, one report."""

import bpy

from . import (
    annotations,
    channel_list,
    channel_presets,
    contacts,
    directing,
    generalized,
    jiggling,
    joints,
    keying,
    libraries,
    live,
    locomotion,
    manners,
    performing,
    presets,
    retargeting,
    rigs,
    scripts,
    selecting,
    solving,
)

CLASSES = (
    *rigs.CLASSES,
    *joints.CLASSES,
    *presets.CLASSES,
    *contacts.CLASSES,
    *live.CLASSES,
    *retargeting.CLASSES,
    *generalized.CLASSES,
    *channel_list.CLASSES,
    *selecting.CLASSES,
    *keying.CLASSES,
    *channel_presets.CLASSES,
    *performing.CLASSES,
    *jiggling.CLASSES,
    *solving.CLASSES,
    *locomotion.CLASSES,
    *directing.CLASSES,
    *scripts.CLASSES,
    *annotations.CLASSES,
    *libraries.CLASSES,
)

for _cls in CLASSES:
    if issubclass(_cls, bpy.types.Operator):
        manners.forget_settings(_cls)
