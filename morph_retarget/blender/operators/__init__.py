"""Everything that buttons and scripts can do; each operator is thin: collect, one call, write, one report."""

from . import contacts, joints, live, presets, retargeting, rigs

CLASSES = (
    *rigs.CLASSES,
    *joints.CLASSES,
    *presets.CLASSES,
    *contacts.CLASSES,
    *live.CLASSES,
    *retargeting.CLASSES,
)
