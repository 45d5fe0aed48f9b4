"""The entities of STEP files besides geometry, as templates.

The same that OCCT's XCAF writer makes, so that every reader finds names, instances, colors,
layers, materials and validation properties where it looks for them. Units are shared by all.
"""

from __future__ import annotations

from typing import Final

SCHEMAS: Final[dict[str, tuple[str, str, str, int]]] = {
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
_PRODUCT_CONTEXT, _DEFINITION_CONTEXT = "#3", "#4"
LENGTH_UNIT: Final = "#5"
_UNITS, _UNCERTAINTY = "#5,#6,#7", "#8"
ORIGIN: Final = "#9"
_AREA_UNIT, _VOLUME_UNIT = "#13", "#15"
DENSITY_UNIT: Final = "#17"
FILE_CONTEXT: Final = "#22"
MASS_UNIT: Final = "#23"
FIRST_FREE: Final = 24
_CONTEXT: Final = (
    f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({_UNCERTAINTY}))"
    f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({_UNITS}))"
    "REPRESENTATION_CONTEXT('Context #1','3D Context with UNIT and UNCERTAINTY'))"
)
COMMON: Final = """\
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
COMMON_CONTEXT: Final = (
    f"{FILE_CONTEXT}={_CONTEXT};\n{MASS_UNIT}=(MASS_UNIT()NAMED_UNIT(*)SI_UNIT(.KILO.,.GRAM.));\n"
)

# One product; ids in braces are local, %s are filled in. Braces 0..5 serve assemblies as well.
DEFINITION: Final = (
    "{0}=SHAPE_DEFINITION_REPRESENTATION({1},{6});\n"
    "{1}=PRODUCT_DEFINITION_SHAPE('','',{2});\n"
    f"{{2}}=PRODUCT_DEFINITION('design','',{{3}},{_DEFINITION_CONTEXT});\n"
    "{3}=PRODUCT_DEFINITION_FORMATION('','',{4});\n"
    f"{{4}}=PRODUCT(%s,%s,'',({_PRODUCT_CONTEXT}));\n"
    "{5}=PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({4}));\n"
    f"{{7}}={_CONTEXT};\n"
)
DEFINED: Final = 2  # local id of a product's definition
REPRESENTED: Final = 6  # local id of its representation
SOLID: Final = 8  # local id of its solid
SHELL: Final = 32  # local id of its shell
PRODUCT: Final = DEFINITION + (
    f"{{6}}=ADVANCED_BREP_SHAPE_REPRESENTATION('',({ORIGIN},{{8}}),{{7}});\n"
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
MATERIAL: Final = (
    "{26}=PROPERTY_DEFINITION('material property','material name',{2});\n"
    "{27}=PROPERTY_DEFINITION_REPRESENTATION({26},%s);\n"
    "{28}=PROPERTY_DEFINITION('material property','density',{2});\n"
    "{29}=PROPERTY_DEFINITION_REPRESENTATION({28},%s);\n"
)

INSTANCE: Final = """\
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
