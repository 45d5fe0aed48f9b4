"""What the sections of every product's project file have in common: strict records, and numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from datetime import date, datetime
from typing import Annotated, ClassVar, Final, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, field_validator

from ddgfab.errors import InputError, clipped
from fabrication.formats.base import Title
from fabrication.formats.dates import epoch_time
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


class TitleSettings(Section):
    """[project].

    Attributes
    ----------
    name : of the output folder; empty: the file's stem
    title : of the project in what people print; empty: its name
    number, revision : the project's number; which version of it this is
    date : YYYY-MM-DD, in what people print; empty: that of SOURCE_DATE_EPOCH, or none
    author : who made it; empty: the author of [output]
    client : whom it is for
    """

    name: str = ""
    title: str = ""
    number: str = ""
    revision: str = ""
    date: str = ""
    author: str = ""
    client: str = ""

    @field_validator("date", mode="before")
    @classmethod
    def _calendar(cls, value: object) -> object:
        """A date as TOML has it, or as text."""
        if isinstance(value, str) and value:
            try:
                if date.fromisoformat(value).isoformat() == value:
                    return value
            except ValueError:
                pass
        elif value == "":
            return value
        elif isinstance(value, date) and not isinstance(value, datetime):
            return value.isoformat()
        raise ValueError(f"date = {clipped(value)} must be a date such as 2026-11-30")

    def block(self, name: str, author: str = "") -> Title:
        """The title block; texts on one line, without what cannot be printed.

        Parameters
        ----------
        name : of the project, where it has no title
        author : where [project] has none
        """
        epoch = epoch_time()
        texts = {
            "title": self.title or name,
            "number": self.number,
            "revision": self.revision,
            "date": self.date or (epoch.date().isoformat() if epoch else ""),
            "author": self.author or author,
            "client": self.client,
        }
        return Title(**{key: one_line(text) for key, text in texts.items()})


def one_line(text: str) -> str:
    r"""A text on one line, without control characters and others that no file can hold.

    >>> one_line("Roof\n of\tthe \x00hall")
    'Roof of the hall'
    """
    spaced = " ".join(text.split())
    return "".join(character for character in spaced if character.isprintable())


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
