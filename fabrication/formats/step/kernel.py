"""Geometry of STEP files from kernel solids, for parts without an exact boundary.

OCCT translates the solid; its text, renumbered, stands in the place of our own.
"""

from __future__ import annotations

import io
import re
import threading
from typing import Any, Final

from ddgfab.errors import KernelError
from fabrication.formats.step.xcaf import mute

_SHELL: Final = re.compile(rb"#(\d+) = CLOSED_SHELL")
_CONTEXT: Final = re.compile(rb"#(\d+) = \( GEOMETRIC_REPRESENTATION_CONTEXT")
_ID: Final = re.compile(rb"#(\d+)")
# The kernel's settings for writing are global to the process, so one solid is written at a time.
_WRITING: Final = threading.Lock()


def solid_text(solid: Any) -> bytes:
    """The STEP file that OCCT makes of one solid [mm], without parametric curves.

    Raises
    ------
    KernelError
        OCCT refused the solid.
    """
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    with _WRITING:
        mute()
        writer = STEPControl_Writer()  # the settings exist only after a writer does
        Interface_Static.SetCVal_s("write.step.schema", "AP214IS")
        Interface_Static.SetCVal_s("write.step.unit", "MM")
        Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
        done = IFSelect_ReturnStatus.IFSelect_RetDone
        kind = STEPControl_StepModelType.STEPControl_ManifoldSolidBrep
        if writer.Transfer(solid, kind) != done:
            raise KernelError("OCCT cannot translate the solid to STEP")
        stream = io.BytesIO()
        if writer.WriteStream(stream) != done:
            raise KernelError("OCCT cannot write the STEP text")
    return stream.getvalue()


class KernelShell:
    """The CLOSED_SHELL of a kernel solid, and all that hangs below it, as text.

    Attributes
    ----------
    ids : how many ids it takes

    Raises
    ------
    KernelError
        OCCT refused the solid, or its text is not laid out as it should be: one closed shell,
        all of whose parts stand between it and the context.
    """

    def __init__(self, solid: Any) -> None:
        text = solid_text(solid)
        start, end = _SHELL.search(text), _CONTEXT.search(text)
        if start is None or end is None or len(_SHELL.findall(text)) != 1:
            raise KernelError("unexpected STEP text from OCCT: not one closed shell")
        self._text = text[start.start() : end.start()]
        self._first = int(start.group(1))
        self.ids = int(end.group(1)) - self._first
        found = {int(number) for number in _ID.findall(self._text)}
        if min(found) < self._first or max(found) >= self._first + self.ids:
            raise KernelError("unexpected STEP text from OCCT: a shell refers to what is not in it")

    def text(self, prefix: str, first: int, width: int) -> str:
        """The entities; an id is the prefix and a number of that width, `first` the shell's."""
        start, offset = prefix.encode("ascii"), first - self._first

        def local(match: re.Match[bytes]) -> bytes:
            return b"%s%0*d" % (start, width, int(match.group(1)) + offset)

        return _ID.sub(local, self._text).decode("ascii")
