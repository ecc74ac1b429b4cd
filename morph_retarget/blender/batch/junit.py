"""The report in the XML that CI systems read: one test case a job."""

import re
from collections.abc import Sequence
from xml.etree import ElementTree as Xml

from .results import Result, Status

_KINDS = {Status.FAILED: "failure", Status.CRASHED: "error", Status.TIMEOUT: "error", Status.STOPPED: "error"}
_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def document(results: Sequence[Result], seconds: float) -> str:
    """Return the document.

    Args:
        results: Of all jobs.
        seconds: That the batch took.
    """
    statuses = [result.answer.status for result in results]
    counts = {
        "tests": str(len(results)),
        "failures": str(statuses.count(Status.FAILED)),
        "errors": str(sum(_KINDS.get(status) == "error" for status in statuses)),
        "skipped": str(statuses.count(Status.SKIPPED)),
        "time": f"{seconds:.3f}",
    }
    root = Xml.Element("testsuites", counts)
    suite = Xml.SubElement(root, "testsuite", {"name": "morph_retarget batch", **counts})
    for result in results:
        source, target = map(_clean, result.job.labels)
        answer = result.answer
        about = {"classname": target, "name": _clean(result.job.name), "time": f"{answer.seconds:.3f}"}
        case = Xml.SubElement(suite, "testcase", about)
        if answer.status is Status.SKIPPED:
            Xml.SubElement(case, "skipped", {"message": "done by an earlier run, and unchanged"})
        elif answer.status in _KINDS:
            told = {"message": _clean(answer.error), "type": answer.status.value}
            lines = [f"{source} on {target}", answer.error, *answer.log]
            Xml.SubElement(case, _KINDS[answer.status], told).text = _clean("\n".join(lines))
    Xml.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + Xml.tostring(root, encoding="unicode") + "\n"


def _clean(text: str) -> str:
    """Return text without the characters that XML cannot hold."""
    return _NOT_XML.sub("\ufffd", text)
