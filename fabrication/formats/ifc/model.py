"""The model as IFC4 text: an assembly of members, plates, accessories and fasteners.

ISO 16739-1:2018 (IFC4 ADD2 TC1). Every part number is a type with its geometry, which its pieces
show by mapped items where they stand.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from fabrication.formats.base import FAILED_COLOR, REJECTED_KIND, Material, Part, Whole
from fabrication.formats.ifc.geometry import Body, body
from fabrication.formats.ifc.guid import Guids
from fabrication.formats.ifc.lines import Lines, listed
from fabrication.formats.step.records import time_stamp
from fabrication.formats.step.text import header_list, header_text, plain, quoted, real
from fabrication.specs import Color, Finish, IfcClass, Kind, Placement
from fabrication.version import originating_system

SCHEMA: Final = "IFC4"
METER: Final = "IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.)"
LABEL: Final = 255
"""Most characters of an IfcLabel."""

TRANSPARENCY: Final[Mapping[Finish, float]] = {"glass": 0.65}

_PREDEFINED: Final[Mapping[IfcClass, str]] = {
    "IfcMember": ".MEMBER.",
    "IfcPlate": ".CURTAIN_PANEL.",
    "IfcDiscreteAccessory": ".USERDEFINED.",
    "IfcMechanicalFastener": ".USERDEFINED.",
}
_QUANTITIES: Final[Mapping[IfcClass, str]] = {
    "IfcMember": "Qto_MemberBaseQuantities",
    "IfcPlate": "Qto_PlateBaseQuantities",
}
_MM2, _MM3 = 1e-6, 1e-9


def model_bytes(whole: Whole, file_name: str) -> bytes:
    """All pieces of a structure as an IFC4 file [mm, m2, m3, kg]."""
    return _Model(whole).file(file_name)


class _Model:
    """The file being made."""

    def __init__(self, whole: Whole) -> None:
        self.whole, self.lines = whole, Lines()
        self.guid = Guids(whole.about.project)
        self._layers: dict[str, list[str]] = {}
        self._styles: dict[tuple[str, Color, float], str] = {}
        self._made_of: dict[Material, list[str]] = {}
        lines = self.lines
        self._units = _units(lines)
        self._origin = lines.axes(np.eye(4))
        context = lines.add(
            f"IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,{self._origin},$)"
        )
        self._context = lines.add(
            f"IFCGEOMETRICREPRESENTATIONSUBCONTEXT('Body','Model',*,*,*,*,{context},$,.MODEL_VIEW.,$)"
        )
        if any(whole.about.origin):
            self._map(context, whole.about.origin)
        self._identity = lines.add(
            f"IFCCARTESIANTRANSFORMATIONOPERATOR3D($,$,{lines.point(0.0, 0.0, 0.0)},1.,$)"
        )
        self._structure(context)
        for number, standing in self._by_number().items():
            self._part(whole.parts[number], standing)
        self._close()

    def _map(self, context: str, origin: Sequence[float]) -> None:
        """Where the origin is in the coordinates of the input, whose system is not known [m]."""
        meter = self.lines.share(METER)
        crs = self.lines.add(f"IFCPROJECTEDCRS('unknown',$,$,$,$,$,{meter})")
        at = ",".join(real(value * 1e-3) for value in origin)
        self.lines.add(f"IFCMAPCONVERSION({context},{crs},{at},1.,0.,0.001)")

    def file(self, file_name: str) -> bytes:
        """Header and data."""
        header, system = self.whole.about.header, header_text(originating_system())
        start = (
            "ISO-10303-21;\nHEADER;\n"
            "FILE_DESCRIPTION(('ViewDefinition [DesignTransferView_V1.0]'),'2;1');\n"
            f"FILE_NAME({header_text(file_name)},{header_text(time_stamp())},"
            f"{header_list(header.author)},{header_list(header.organization)},"
            f"{system},{system},'');\nFILE_SCHEMA(('{SCHEMA}'));\nENDSEC;\nDATA;\n"
        )
        return (start + self.lines.text() + "ENDSEC;\nEND-ISO-10303-21;\n").encode("ascii")

    def _by_number(self) -> dict[str, list[tuple[str, Placement]]]:
        found: dict[str, list[tuple[str, Placement]]] = {}
        for number, mark, placement in self.whole.standing():
            found.setdefault(number, []).append((mark, placement))
        return found

    def _structure(self, context: str) -> None:
        """Project, site, building and the assembly of all pieces."""
        add, guid, about = self.lines.add, self.guid, self.whole.about
        name, title = _label(about.project), _label(about.title.title or about.project)
        project = add(
            f"IFCPROJECT('{guid('project')}',$,{name},$,$,{title},$,({context}),{self._units})"
        )
        at = add(f"IFCLOCALPLACEMENT($,{self._origin})")
        site = add(f"IFCSITE('{guid('site')}',$,'Site',$,$,{at},$,$,.ELEMENT.,$,$,$,$,$)")
        at = add(f"IFCLOCALPLACEMENT({at},{self._origin})")
        building = add(f"IFCBUILDING('{guid('building')}',$,{name},$,$,{at},$,$,.ELEMENT.,$,$,$)")
        self._placed_in = add(f"IFCLOCALPLACEMENT({at},{self._origin})")
        self._assembly = add(
            f"IFCELEMENTASSEMBLY('{guid('assembly')}',$,{name},$,'Structure',{self._placed_in},$,$,"
            ".SITE.,.USERDEFINED.)"
        )
        for name, above, below in (("site", project, site), ("building", site, building)):
            self._relate("IFCRELAGGREGATES", f"tree {name}", f"{above},({below})")
        self._relate(
            "IFCRELCONTAINEDINSPATIALSTRUCTURE", "contained", f"({self._assembly}),{building}"
        )
        self._pieces: list[str] = []

    def _part(self, part: Part, standing: list[tuple[str, Placement]]) -> None:
        """A part number: its type, and every piece of it."""
        add, guid, number = self.lines.add, self.guid, part.number
        made = body(self.lines, part)
        add(f"IFCSTYLEDITEM({made.reference},({self._style(part.kind)}),$)")
        shape = add(
            f"IFCSHAPEREPRESENTATION({self._context},'Body','{made.type}',({made.reference}))"
        )
        mapped = add(f"IFCREPRESENTATIONMAP({self._origin},{shape})")
        name, entity = _label(number), part.kind.ifc.upper()
        role, predefined = _label(part.kind.role), _PREDEFINED[part.kind.ifc]
        nominal = ",$,$" if part.kind.ifc == "IfcMechanicalFastener" else ""
        sets = self._property_set("dimensions", number, "ddgfab_Dimensions", _values(part))
        type_ = add(
            f"{entity}TYPE('{guid('type', number)}',$,{name},$,$,{sets},({mapped}),{name},{role},"
            f"{predefined}{nominal})"
        )
        self._made_of.setdefault(part.material, []).append(type_)
        nominal = "$,$," if nominal else ""
        constant = {"PartNumber": number, "Mass_kg": part.mass}
        shared = [self._property(key, value) for key, value in constant.items()]
        pieces = []
        for mark, placement in standing:
            failed = mark in self.whole.failed
            item = add(f"IFCMAPPEDITEM({mapped},{self._identity})")
            shown = add(
                f"IFCSHAPEREPRESENTATION({self._context},'Body','MappedRepresentation',({item}))"
            )
            if failed:
                add(f"IFCSTYLEDITEM({item},({self._style(REJECTED_KIND)}),$)")
            layer = REJECTED_KIND.layer if failed else part.kind.layer
            self._layers.setdefault(layer, []).append(shown)
            outline = add(f"IFCPRODUCTDEFINITIONSHAPE($,$,({shown}))")
            at = add(f"IFCLOCALPLACEMENT({self._placed_in},{self.lines.axes(placement)})")
            piece = add(
                f"{entity}('{guid('piece', mark)}',$,{_label(mark)},$,{role},{at},{outline},{name},"
                f"{nominal}{predefined})"
            )
            status = self._property("Status", "rejected" if failed else "ok")
            own = [self.lines.add(_single("Mark", mark)), *shared, status]
            values = add(
                f"IFCPROPERTYSET('{guid('properties', mark)}',$,'ddgfab_Part',$,{listed(own)})"
            )
            self._relate(
                "IFCRELDEFINESBYPROPERTIES", f"properties of {mark}", f"({piece}),{values}"
            )
            pieces.append(piece)
        self._pieces += pieces
        self._relate("IFCRELDEFINESBYTYPE", f"type of {number}", f"{listed(pieces)},{type_}")
        quantities = self._quantities(part, made)
        self._relate(
            "IFCRELDEFINESBYPROPERTIES", f"quantities of {number}", f"{listed(pieces)},{quantities}"
        )

    def _close(self) -> None:
        """What relates many: the assembly, materials, layers."""
        add = self.lines.add
        if self._pieces:
            self._relate("IFCRELAGGREGATES", "pieces", f"{self._assembly},{listed(self._pieces)}")
        for material, types in self._made_of.items():
            category = _label(material.category.lower()) if material.category else "$"
            made = add(f"IFCMATERIAL({_label(material.name)},$,{category})")
            density = f"IFCMASSDENSITYMEASURE({real(material.density)})"
            own = add(f"IFCPROPERTYSINGLEVALUE('MassDensity',$,{density},$)")
            add(f"IFCMATERIALPROPERTIES('Pset_MaterialCommon',$,({own}),{made})")
            key = f"material {material.name} {material.density:.15g}"
            self._relate("IFCRELASSOCIATESMATERIAL", key, f"{listed(types)},{made}")
        for layer, shapes in self._layers.items():
            add(f"IFCPRESENTATIONLAYERASSIGNMENT({_label(layer)},$,{listed(shapes)},$)")

    def _relate(self, entity: str, name: str, rest: str) -> None:
        self.lines.add(f"{entity}('{self.guid('relation', name)}',$,$,$,{rest})")

    def _style(self, kind: Kind) -> str:
        """IfcSurfaceStyle of a kind."""
        color = FAILED_COLOR if kind == REJECTED_KIND else kind.color
        key = (kind.title, color, TRANSPARENCY.get(kind.finish, 0.0))
        if key not in self._styles:
            rgb = self.lines.add(f"IFCCOLOURRGB($,{','.join(map(real, color))})")
            look = self.lines.add(
                f"IFCSURFACESTYLERENDERING({rgb},{real(key[2])},$,$,$,$,$,$,.NOTDEFINED.)"
            )
            self._styles[key] = self.lines.add(
                f"IFCSURFACESTYLE({_label(kind.title)},.BOTH.,({look}))"
            )
        return self._styles[key]

    def _property(self, name: str, value: Any) -> str:
        return self.lines.share(_single(name, value))

    def _property_set(self, kind: str, owner: str, name: str, values: Mapping[str, Any]) -> str:
        """A list of one property set, or $ where there are no values."""
        if not values:
            return "$"
        own = listed(self._property(key, value) for key, value in values.items())
        made = self.lines.add(f"IFCPROPERTYSET('{self.guid(kind, owner)}',$,'{name}',$,{own})")
        return f"({made})"

    def _quantities(self, part: Part, made: Body) -> str:
        """IfcElementQuantity of a part number: the standard's set where its class has one."""
        own = []
        if part.kind.form == "bar":
            own.append(f"IFCQUANTITYLENGTH('Length',$,$,{real(part.length)},$)")
        if made.prism is not None and part.kind.form == "sheet":
            own.append(f"IFCQUANTITYLENGTH('Width',$,$,{real(made.prism.length)},$)")
            net = real(part.properties.volume / made.prism.length * _MM2)
            own.append(f"IFCQUANTITYAREA('NetArea',$,$,{net},$)")
        else:
            surface = "OuterSurfaceArea" if part.kind.ifc == "IfcMember" else "SurfaceArea"
            own.append(f"IFCQUANTITYAREA('{surface}',$,$,{real(part.properties.area * _MM2)},$)")
        own.append(f"IFCQUANTITYVOLUME('NetVolume',$,$,{real(part.properties.volume * _MM3)},$)")
        own.append(f"IFCQUANTITYWEIGHT('NetWeight',$,$,{real(part.mass)},$)")
        name = _QUANTITIES.get(part.kind.ifc, "ddgfab_Quantities")
        quantities = listed(map(self.lines.share, own))
        guid = self.guid("quantities", part.number)
        return self.lines.add(f"IFCELEMENTQUANTITY('{guid}',$,'{name}',$,$,{quantities})")


def _units(lines: Lines) -> str:
    """Millimeters, radians, m2, m3, kg, kg/m3."""
    meter = lines.share(METER)
    kilogram = lines.add("IFCSIUNIT(*,.MASSUNIT.,.KILO.,.GRAM.)")
    of_mass = lines.add(f"IFCDERIVEDUNITELEMENT({kilogram},1)")
    of_length = lines.add(f"IFCDERIVEDUNITELEMENT({meter},-3)")
    units = [
        lines.add("IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.)"),
        lines.add("IFCSIUNIT(*,.AREAUNIT.,$,.SQUARE_METRE.)"),
        lines.add("IFCSIUNIT(*,.VOLUMEUNIT.,$,.CUBIC_METRE.)"),
        lines.add("IFCSIUNIT(*,.PLANEANGLEUNIT.,$,.RADIAN.)"),
        kilogram,
        lines.add(f"IFCDERIVEDUNIT(({of_mass},{of_length}),.MASSDENSITYUNIT.,$)"),
    ]
    return lines.add(f"IFCUNITASSIGNMENT({listed(units)})")


def _values(part: Part) -> dict[str, Any]:
    """What schedules list of a shape, where it is a plain value."""
    values = part.shape.dimensions().items()
    return {key: value for key, value in values if isinstance(value, bool | int | float | str)}


def _label(text: str) -> str:
    """Text as an IfcLabel."""
    return quoted(plain(text)[:LABEL])


def _single(name: str, value: Any) -> str:
    """IfcPropertySingleValue without a unit of its own."""
    return f"IFCPROPERTYSINGLEVALUE({_label(name)},$,{_typed(value)},$)"


def _typed(value: Any) -> str:
    if isinstance(value, bool | np.bool_):
        return f"IFCBOOLEAN({'.T.' if value else '.F.'})"
    if isinstance(value, int):
        return f"IFCINTEGER({value})"
    if isinstance(value, float):
        return f"IFCREAL({real(value)})"
    return f"IFCLABEL({_label(str(value))})"
