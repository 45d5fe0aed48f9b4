"""STEP files as text straight from exact boundaries: no CAD kernel, some 0.2 ms a part.

The same entities that OCCT's XCAF writer makes (`fabrication.export.step`), so every reader finds
names, instances, colours, layers, materials and validation properties where it looks for them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Final

import numpy as np

from ddgfab.errors import KernelError
from fabrication.export.stepgeometry import LOCAL, BoundaryShell
from fabrication.export.stepkernel import KernelShell
from fabrication.export.steprecords import (
    COLOURS,
    GROUPS,
    LAYERS,
    Header,
    Material,
    Product,
    Schema,
    time_stamp,
)
from fabrication.export.steptext import STYLE_IDS, quoted, real, style
from fabrication.export.version import originating_system
from fabrication.solids.boundary import Boundary
from fabrication.specs import Placement, Properties, Role

_SCHEMAS: Final[dict[str, tuple[str, str, str, int]]] = {
    "AP214": (
        "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }",
        "core data for automotive mechanical design processes",
        "automotive_design",
        2000,
    ),
    "AP242": (
        "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF {1 0 10303 442 1 1 4 }",
        "Managed model based 3d engineering",
        "ap242_managed_model_based_3d_engineering",
        2013,
    ),
}
"""FILE_SCHEMA, application, protocol and its year."""

# Entities that every file begins with, by id.
_APPLICATION, _PRODUCT_CONTEXT, _DEFINITION_CONTEXT = "#2", "#3", "#4"
_MILLIMETRE, _UNITS, _UNCERTAINTY, _ORIGIN = "#5", "#5,#6,#7", "#8", "#9"
_AREA_UNIT, _VOLUME_UNIT, _DENSITY_UNIT = "#13", "#15", "#17"
_FILE_CONTEXT: Final = "#22"
_FIRST_FREE: Final = 23
_CONTEXT: Final = (
    f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({_UNCERTAINTY}))"
    f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({_UNITS}))"
    "REPRESENTATION_CONTEXT('Context #1','3D Context with UNIT and UNCERTAINTY'))"
)
_COMMON: Final = """\
#1=APPLICATION_PROTOCOL_DEFINITION('international standard','%s',%d,#2);
#2=APPLICATION_CONTEXT('%s');
#3=PRODUCT_CONTEXT('',#2,'mechanical');
#4=PRODUCT_DEFINITION_CONTEXT('part definition',#2,'design');
#5=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#6=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#7=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#8=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),#5,'distance_accuracy_value',\
'confusion accuracy');
#9=AXIS2_PLACEMENT_3D('',#10,#11,#12);
#10=CARTESIAN_POINT('',(0.,0.,0.));
#11=DIRECTION('',(0.,0.,1.));
#12=DIRECTION('',(1.,0.,0.));
#13=DERIVED_UNIT((#14));
#14=DERIVED_UNIT_ELEMENT(#5,2.);
#15=DERIVED_UNIT((#16));
#16=DERIVED_UNIT_ELEMENT(#5,3.);
#17=DERIVED_UNIT((#18,#20));
#18=DERIVED_UNIT_ELEMENT(#19,1.);
#19=(MASS_UNIT()NAMED_UNIT(*)SI_UNIT($,.GRAM.));
#20=DERIVED_UNIT_ELEMENT(#21,-3.);
#21=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.));
"""
_COMMON_CONTEXT: Final = f"{_FILE_CONTEXT}={_CONTEXT};\n"

# One product; ids in braces are local, %s are filled in. Braces 0..5 serve assemblies as well.
_DEFINITION: Final = (
    "{0}=SHAPE_DEFINITION_REPRESENTATION({1},{6});\n"
    "{1}=PRODUCT_DEFINITION_SHAPE('','',{2});\n"
    f"{{2}}=PRODUCT_DEFINITION('design','',{{3}},{_DEFINITION_CONTEXT});\n"
    "{3}=PRODUCT_DEFINITION_FORMATION('','',{4});\n"
    f"{{4}}=PRODUCT(%s,%s,'',({_PRODUCT_CONTEXT}));\n"
    "{5}=PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({4}));\n"
    f"{{7}}={_CONTEXT};\n"
)
_DEFINED: Final = 2  # local id of a product's definition
_REPRESENTED: Final = 6  # local id of its representation
_SOLID: Final = 8  # local id of its solid
_SHELL: Final = 32  # local id of its shell
_PRODUCT: Final = _DEFINITION + (
    f"{{6}}=ADVANCED_BREP_SHAPE_REPRESENTATION('',({_ORIGIN},{{8}}),{{7}});\n"
    "{8}=MANIFOLD_SOLID_BREP('',{32});\n"
    "{10}=SHAPE_DEFINITION_REPRESENTATION({11},{13});\n"
    "{11}=PROPERTY_DEFINITION('shape with specific properties',"
    "'properties for subshape',{12});\n"
    "{12}=SHAPE_ASPECT('','',{1},.F.);\n"
    "{13}=SHAPE_REPRESENTATION('',({8}),{7});\n"
    "{14}=PROPERTY_DEFINITION_REPRESENTATION({15},{16});\n"
    "{15}=PROPERTY_DEFINITION('geometric validation property','surface area',{12});\n"
    "{16}=REPRESENTATION('surface area',({17}),{7});\n"
    "{17}=MEASURE_REPRESENTATION_ITEM('surface area measure',AREA_MEASURE(%s),"
    f"{_AREA_UNIT});\n"
    "{18}=PROPERTY_DEFINITION_REPRESENTATION({19},{20});\n"
    "{19}=PROPERTY_DEFINITION('geometric validation property','volume',{12});\n"
    "{20}=REPRESENTATION('volume',({21}),{7});\n"
    "{21}=MEASURE_REPRESENTATION_ITEM('volume measure',VOLUME_MEASURE(%s),"
    f"{_VOLUME_UNIT});\n"
    "{22}=PROPERTY_DEFINITION_REPRESENTATION({23},{24});\n"
    "{23}=PROPERTY_DEFINITION('geometric validation property','centroid',{12});\n"
    "{24}=REPRESENTATION('centroid',({25}),{7});\n"
    "{25}=CARTESIAN_POINT('centre point',(%s,%s,%s));\n"
    "{30}=STYLED_ITEM('color',(%s),{8});\n"
    "{31}=MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',({30}),{7});\n"
)
_MATERIAL: Final = (
    "{26}=PROPERTY_DEFINITION('material property','material name',{2});\n"
    "{27}=PROPERTY_DEFINITION_REPRESENTATION({26},%s);\n"
    "{28}=PROPERTY_DEFINITION('material property','density',{2});\n"
    "{29}=PROPERTY_DEFINITION_REPRESENTATION({28},%s);\n"
)

_LEAST_WIDTH: Final = 3
"""Least digits of local ids."""

_INSTANCE: Final = """\
#%d=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#%d,#%d);
#%d=(REPRESENTATION_RELATIONSHIP('','',%s,%s)\
REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#%d)SHAPE_REPRESENTATION_RELATIONSHIP());
#%d=ITEM_DEFINED_TRANSFORMATION('','',#9,#%d);
#%d=PRODUCT_DEFINITION_SHAPE('Placement','Placement of an item',#%d);
#%d=NEXT_ASSEMBLY_USAGE_OCCURRENCE('%d',%s,'',%s,%s,$);
#%d=AXIS2_PLACEMENT_3D('',#%d,#%d,#%d);
#%d=CARTESIAN_POINT('',(%.12f,%.12f,%.12f));
#%d=DIRECTION('',(%.15f,%.15f,%.15f));
#%d=DIRECTION('',(%.15f,%.15f,%.15f));
"""

_LIST_PER_LINE: Final = 12
"""References on a line of a long list."""


def part_text(
    boundary: Boundary,
    *,
    number: str,
    role: Role,
    properties: Properties,
    file_name: str,
    header: Header | None = None,
    material: Material | None = None,
    schema: Schema = "AP214",
) -> bytes:
    """One part number as a STEP file: its bytes.

    Parameters
    ----------
    boundary : in the part's own frame [mm]
    """
    text = _Text([Product(number, role, None, properties, material, boundary)])
    return text.file(header or Header(), file_name, schema)


def assembly_text(
    products: Sequence[Product],
    instances: Iterable[tuple[str, str, Placement]],
    *,
    name: str,
    file_name: str,
    header: Header | None = None,
    schema: Schema = "AP214",
) -> bytes:
    """The whole as a STEP file of true instances, in one sub-assembly a role: its bytes.

    Parameters
    ----------
    products : each with its boundary, or where it has none with its kernel solid
    instances : (part number, piece mark, (4, 4) placement [mm]) of every piece

    Raises
    ------
    KernelError
        An instance of an unknown part number, a product without geometry, or OCCT refused.
    """
    text = _Text(products)
    roles = [role for role in GROUPS if any(product.role == role for product in products)]
    root = text.unit(name)
    groups = {role: text.unit(GROUPS[role]) for role in roles}
    for role in roles:
        root.add(GROUPS[role], groups[role].definition, groups[role].representation, np.eye(4))
    targets = {
        product.number: (groups[product.role], *text.references[index])
        for index, product in enumerate(products)
    }
    for number, mark, placement in instances:
        if number not in targets:
            raise KernelError(f"piece {mark} is an instance of {number}, which has no solid")
        group, definition, representation = targets[number]
        group.add(mark, definition, representation, placement)
    for unit in (root, *groups.values()):
        unit.close()
    return text.file(header or Header(), file_name, schema)


class _Text:
    """The data section of a file: what is shared, the products, and then what else is added.

    Ids: what is shared counts from 1; the local ids of product k follow the digits of k + some.
    """

    def __init__(self, products: Sequence[Product]) -> None:
        self._parts: list[bytes] = []
        self.occurrences = 0
        self._following = _FIRST_FREE
        materials = self._materials(products)
        styles = self._styles(products)
        shells = [_shell_of(product) for product in products]
        most = _SHELL + max((shell.ids for shell in shells), default=0)
        width = max(_LEAST_WIDTH, len(str(most - 1)))
        first = 1 + self._following // 10**width
        self.references: list[tuple[str, str]] = []  # definition, representation
        solids: dict[str, list[str]] = {}
        for index, (product, shell) in enumerate(zip(products, shells, strict=True)):
            prefix = f"#{first + index}"
            self.write(
                _product(
                    product,
                    shell,
                    prefix,
                    width,
                    styles[product.role],
                    materials[product.material] if product.material else None,
                )
            )
            local = [f"{prefix}{i:0{width}d}" for i in (_DEFINED, _REPRESENTED, _SOLID)]
            self.references.append((local[0], local[1]))
            solids.setdefault(product.role, []).append(local[2])
        self._following = (first + len(products)) * 10**width
        for role, members in solids.items():
            self.write(
                f"#{self.take(1)}=PRESENTATION_LAYER_ASSIGNMENT("
                f"{quoted(LAYERS[role])},'visible',({_listed(members)}));\n"
            )

    def take(self, count: int) -> int:
        """The first of some new ids."""
        self._following += count
        return self._following - count

    def write(self, entities: str) -> None:
        """Some more entities."""
        self._parts.append(entities.encode("ascii"))

    def unit(self, name: str) -> _Unit:
        """A new assembly."""
        return _Unit(self, name)

    def file(self, header: Header, file_name: str, schema: Schema) -> bytes:
        """The whole file."""
        identity, application, protocol, year = _SCHEMAS[schema]
        system = quoted(originating_system())
        start = (
            "ISO-10303-21;\nHEADER;\n"
            f"FILE_DESCRIPTION(({quoted(header.description or file_name)}),'2;1');\n"
            f"FILE_NAME({quoted(file_name)},{quoted(time_stamp())},({quoted(header.author)}),"
            f"({quoted(header.organisation)}),{system},{system},'Unknown');\n"
            f"FILE_SCHEMA(('{identity}'));\nENDSEC;\nDATA;\n"
        )
        common = _COMMON % (protocol, year, application) + _COMMON_CONTEXT
        whole = [(start + common).encode("ascii"), *self._parts, b"ENDSEC;\nEND-ISO-10303-21;\n"]
        return b"".join(whole)

    def _materials(self, products: Sequence[Product]) -> dict[Material, tuple[str, str]]:
        """Ids of the representations of each material's name and density, by material."""
        found: dict[Material, tuple[str, str]] = {}
        for product in products:
            material = product.material
            if material is None or material in found:
                continue
            i = self.take(4)
            # Grams per cubic centimetre, as OCCT and its readers have it.
            density = f"POSITIVE_RATIO_MEASURE({real(material.density / 1000.0)})"
            self.write(
                f"#{i}=REPRESENTATION('material name',(#{i + 1}),{_FILE_CONTEXT});\n"
                f"#{i + 1}=DESCRIPTIVE_REPRESENTATION_ITEM({quoted(material.name)},'');\n"
                f"#{i + 2}=REPRESENTATION('density',(#{i + 3}),{_FILE_CONTEXT});\n"
                f"#{i + 3}=MEASURE_REPRESENTATION_ITEM('density',{density},{_DENSITY_UNIT});\n"
            )
            found[material] = (f"#{i}", f"#{i + 2}")
        return found

    def _styles(self, products: Sequence[Product]) -> dict[str, str]:
        """Ids of the presentation styles, by role."""
        found: dict[str, str] = {}
        for role in GROUPS:
            if any(product.role == role for product in products):
                first = self.take(STYLE_IDS)
                self.write("\n".join(style(first, COLOURS[role])) + "\n")
                found[role] = f"#{first}"
        return found


class _Unit:
    """An assembly to which instances are added: a product without a shape of its own."""

    def __init__(self, text: _Text, name: str) -> None:
        self._text = text
        first = text.take(8)
        ids = [f"#{first + i}" for i in range(8)]
        self.definition, self.representation, self._context = (
            ids[_DEFINED],
            ids[_REPRESENTED],
            ids[7],
        )
        text.write(_DEFINITION.format(*ids) % (quoted(name), quoted(name)))
        self._placements: list[str] = [_ORIGIN]

    def add(self, name: str, definition: str, representation: str, placement: Placement) -> None:
        """One instance, named."""
        text = self._text
        text.occurrences += 1
        i = text.take(9)
        (xx, _, zx, px), (xy, _, zy, py), (xz, _, zz, pz) = np.asarray(placement)[:3].tolist()
        text.write(
            _INSTANCE
            % (
                *(i, i + 1, i + 3),
                *(i + 1, representation, self.representation, i + 2),
                *(i + 2, i + 5),
                *(i + 3, i + 4),
                *(i + 4, text.occurrences, quoted(name), self.definition, definition),
                *(i + 5, i + 6, i + 7, i + 8),
                *(i + 6, px, py, pz),
                *(i + 7, zx, zy, zz),
                *(i + 8, xx, xy, xz),
            )
        )
        self._placements.append(f"#{i + 5}")

    def close(self) -> None:
        """Write the representation that holds the placements."""
        self._text.write(
            f"{self.representation}=SHAPE_REPRESENTATION('',({_listed(self._placements)}),"
            f"{self._context});\n"
        )


def _shell_of(product: Product) -> BoundaryShell | KernelShell:
    if product.boundary is not None:
        return BoundaryShell(product.boundary)
    if product.solid is None:
        raise KernelError(f"{product.number} has neither an exact boundary nor a solid to write")
    try:
        return KernelShell(product.solid)
    except KernelError as error:
        raise KernelError(f"{product.number}: {error}") from error


def _product(
    product: Product,
    shell: BoundaryShell | KernelShell,
    prefix: str,
    width: int,
    style_id: str,
    material: tuple[str, str] | None,
) -> str:
    """All entities of one product; its ids are the prefix and local ids of some width."""
    number, values = quoted(product.number), product.properties
    measures = (real(values.area), real(values.volume), *map(real, values.centroid))
    text = _numbered(_PRODUCT, width).replace(LOCAL, prefix) % (
        number,
        number,
        *measures,
        style_id,
    )
    if material is not None:
        text += _numbered(_MATERIAL, width).replace(LOCAL, prefix) % material
    return text + shell.text(prefix, _SHELL, width)


@lru_cache(maxsize=16)
def _numbered(template: str, width: int) -> str:
    """A template with local ids in its braces."""
    return template.format(*(f"{LOCAL}{i:0{width}d}" for i in range(_SHELL + 1)))


def _listed(references: Sequence[str]) -> str:
    """References separated by commas, in lines of readable length."""
    step = _LIST_PER_LINE
    rows = [",".join(references[i : i + step]) for i in range(0, len(references), step)]
    return ",\n".join(rows)
