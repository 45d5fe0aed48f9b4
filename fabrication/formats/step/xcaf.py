"""OCCT's extended (XCAF) documents, as read back from STEP: labels, names, components."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from ddgfab.errors import InputError


@cache
def mute() -> None:
    """Keep OCCT from printing transfer statistics to the standard output of this process."""
    from OCP.Message import Message, Message_Gravity

    for printer in Message.DefaultMessenger_s().Printers():
        printer.SetTraceLevel(Message_Gravity.Message_Fail)


def new_document() -> Any:
    """An empty XCAF document in millimetres."""
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFApp import XCAFApp_Application
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    # Initialises the document for the attributes of shapes, colors and layers.
    XCAFApp_Application.GetApplication_s().InitDocument(document)
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, 0.001)
    return document


def get_name(label: Any) -> str:
    """The name of a label, or an empty text."""
    from OCP.TDataStd import TDataStd_Name

    attribute = TDataStd_Name()
    if not label.FindAttribute(TDataStd_Name.GetID_s(), attribute):
        return ""
    return str(attribute.Get().ToExtString())


def read_document(path: Path) -> tuple[Any, tuple[str, ...]]:
    """The XCAF document of a STEP file, lengths in millimetres, and the file's own length units.

    The units are the distinct ones of its representation contexts, such as ("millimetre",).

    Raises
    ------
    InputError
        The file is missing or is not a STEP file that OCCT can read.
    """
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TColStd import TColStd_SequenceOfAsciiString

    mute()
    if not path.is_file():
        raise InputError("no such file", file=str(path))
    document = new_document()
    reader = STEPCAFControl_Reader()
    for switch in (
        reader.SetNameMode,
        reader.SetColorMode,
        reader.SetLayerMode,
        reader.SetPropsMode,
        reader.SetMatMode,
    ):
        switch(True)
    if reader.ReadFile(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise InputError("not a readable STEP file (truncated, or another format)", file=str(path))
    if not reader.Transfer(document):
        raise InputError("the STEP file holds no shape that can be read", file=str(path))
    units = [TColStd_SequenceOfAsciiString() for _ in range(3)]  # lengths, angles, solid angles
    reader.ChangeReader().FileUnits(*units)
    lengths = {units[0].Value(i).ToCString() for i in range(1, units[0].Length() + 1)}
    return document, tuple(sorted(lengths))


def free_labels(document: Any) -> list[Any]:
    """Labels of the top-level shapes."""
    from OCP.TDF import TDF_LabelSequence
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    labels = TDF_LabelSequence()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes(labels)
    return [labels.Value(i) for i in range(1, labels.Length() + 1)]


def components(label: Any) -> list[tuple[Any, Any]]:
    """The components of an assembly label with the labels of the shapes that they refer to."""
    from OCP.TDF import TDF_Label, TDF_LabelSequence
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    sequence = TDF_LabelSequence()
    XCAFDoc_ShapeTool.GetComponents_s(label, sequence)
    pairs = []
    for i in range(1, sequence.Length() + 1):
        component, target = sequence.Value(i), TDF_Label()
        XCAFDoc_ShapeTool.GetReferredShape_s(component, target)
        pairs.append((component, target))
    return pairs


def layers_by_tag(document: Any) -> dict[str, frozenset[str]]:
    """Names of the layers of each shape, by the tag of its label."""
    from OCP.TDF import TDF_LabelSequence
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    tool = XCAFDoc_DocumentTool.LayerTool_s(document.Main())
    labels = TDF_LabelSequence()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetShapes(labels)
    found = {}
    for i in range(1, labels.Length() + 1):
        names = tool.GetLayers(labels.Value(i))
        if names is not None:
            texts = (names.Value(k).ToExtString() for k in range(1, names.Length() + 1))
            found[str(labels.Value(i).Tag())] = frozenset(map(str, texts))
    return found
