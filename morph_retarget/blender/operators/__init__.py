"""Everything that buttons and scripts can do; each operator is thin: collect, one call, write, one report."""

from . import (
    channel_list,
    channel_presets,
    contacts,
    generalized,
    jiggling,
    joints,
    keying,
    live,
    locomotion,
    performing,
    presets,
    retargeting,
    rigs,
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
)
