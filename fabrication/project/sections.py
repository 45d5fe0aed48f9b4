"""What the sections of every product's project file have in common: strict records, and numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, ClassVar, Final, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, field_validator

from ddgfab.errors import InputError
from fabrication.formats.registry import check_names, check_options, defaults, names

LARGEST: Final = 1e9
"""No number of a project is larger: 1,000 km in mm. Beyond, volumes and squares overflow."""

Positive = Annotated[float, Field(gt=0, le=LARGEST, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, le=LARGEST, allow_inf_nan=False)]
Finite = Annotated[float, Field(ge=-LARGEST, le=LARGEST, allow_inf_nan=False)]
Degrees = Annotated[float, Field(ge=0, le=180)]
Verify: TypeAlias = Literal["all", "sample", "none"]
"""Which files are read back: those of every part number, of one in ten, or none."""


class Section(BaseModel):
    """Base of the sections: frozen, strict about types, unknown keys refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    @classmethod
    def choices(cls) -> Mapping[str, Sequence[str]]:
        """Values of the keys that take one of some names, where the type does not say them."""
        return {}

    def changed(self) -> set[str]:
        """The keys whose value is not the default: a default that is written changes nothing."""
        return set(self.model_dump(exclude_defaults=True))

    @classmethod
    def keys(cls) -> set[str]:
        """The keys that a file may have in this section."""
        return set(cls.model_fields)


class OutputSettings(Section):
    """[output].

    Attributes
    ----------
    formats : files to write; manifest and preview are always written
    jobs : processes; 0 = as many as there are cores
    options : of formats, [output.options]: step.schema = "AP214" opens almost everywhere, "AP242"
        is newer
    author, organization : for the STEP headers
    """

    own_formats: ClassVar[tuple[str, ...]] = ()
    """Names of formats that the product brings itself."""

    @classmethod
    def choices(cls) -> Mapping[str, Sequence[str]]:
        """The names of the formats."""
        return {"formats": (*names(), *cls.own_formats)}

    formats: Annotated[tuple[str, ...], Field(strict=False)] = Field(
        default_factory=lambda: defaults(printed=False)
    )
    jobs: Annotated[int, Field(ge=0, le=256)] = 0
    options: dict[str, dict[str, str]] = Field(default_factory=dict)
    author: str = ""
    organization: str = ""

    @field_validator("formats")
    @classmethod
    def _known(cls, value: Iterable[str]) -> tuple[str, ...]:
        try:
            check_names(value, (*names(), *cls.own_formats))
        except InputError as error:
            raise ValueError(str(error)) from None
        return tuple(dict.fromkeys(value))

    @field_validator("options")
    @classmethod
    def _options(cls, value: dict[str, dict[str, str]]) -> dict[str, dict[str, str]]:
        try:
            check_options(value)
        except InputError as error:
            raise ValueError(str(error)) from None
        return value
