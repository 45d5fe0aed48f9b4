"""Sections with a kind from a registry, and tables that change them for one place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar, Protocol, Self

from pydantic import ConfigDict, Field, ValidationError, field_validator, model_validator

from ddgfab.suggest import suggestion
from fabrication.gridshell.where import Rule, Vertices, shown
from fabrication.project.sections import Section


class Registry(Protocol):
    """Kinds by name, and the keys that are for some of them only."""

    def names(self) -> tuple[str, ...]:
        """The kinds."""
        ...

    def kinds_of(self, key: str) -> Sequence[str]:
        """The kinds that have a key; none: all of them."""
        ...


class NodeRule(Rule):
    """[[node]] or [[connection]] with `where`: nodes of one place, and any other key that is ruled.

    Attributes
    ----------
    where : "boundary", "supports" (of [ground]), "group:NAME" (a group of the mesh file), or vertex
        numbers as in nodes.csv
    """

    model_config = ConfigDict(extra="allow")

    where: Vertices


class KindSection(Section):
    """A section whose kind stands in a registry; a key of other kinds is refused.

    `registry` has the kinds, `whole` the keys of the whole project, which no rule changes.
    """

    registry: ClassVar[Registry]
    whole: ClassVar[frozenset[str]] = frozenset()

    kind: str
    rules: tuple[NodeRule, ...] = Field(default=(), strict=False)

    @classmethod
    def choices(cls) -> Mapping[str, Sequence[str]]:
        """The kinds by name."""
        return {"kind": cls.registry.names()}

    @classmethod
    def ruled(cls) -> set[str]:
        """The keys that a table with `where` may have beside it."""
        return cls.keys() - cls.whole - {"rules"}

    @field_validator("kind")
    @classmethod
    def _known(cls, value: str) -> str:
        names = cls.registry.names()
        if value not in names:
            raise ValueError(f'"{value}" is unknown; {suggestion(value, names)}')
        return value

    @model_validator(mode="after")
    def _own_keys(self) -> Self:
        """Keys of other kinds; what holds for the whole project may be for a rule's kind."""
        others = {str(rule.own().get("kind", self.kind)) for rule in self.rules}
        for key in sorted(self.changed() - {"kind", "rules"}):
            known = {self.kind, *(others if key in self.whole else ())}
            if (kinds := self.registry.kinds_of(key)) and not known & set(kinds):
                shown_kinds = " or ".join(f'"{kind}"' for kind in kinds)
                raise ValueError(f'{key} is for kind = {shown_kinds}, not for "{self.kind}"')
        return self

    @model_validator(mode="after")
    def _rules_hold(self) -> Self:
        for number, rule in enumerate(self.rules, 1):
            try:
                self.under(rule)
            except ValidationError as error:
                first = error.errors(include_url=False)[0]
                key = ".".join(map(str, first["loc"]))
                text = str(first.get("ctx", {}).get("error", first["msg"]))
                raise ValueError(
                    f"rule {number} (where = {shown(rule.where)}): {key} {text}".replace("  ", " ")
                ) from None
        return self

    def under(self, rule: NodeRule) -> Self:
        """These settings with those of a rule; keys that its kind does not have go."""
        own = self.model_dump(exclude={"rules"}, exclude_defaults=True)
        kind = rule.own().get("kind", self.kind)
        kept = {
            key: value
            for key, value in own.items()
            if not (kinds := self.registry.kinds_of(key)) or kind in kinds
        }
        return type(self).model_validate({**kept, **rule.own()}, strict=None)

    def of_rule(self, number: int) -> Self:
        """The settings of a rule, counted from 1; 0: these themselves."""
        return self.under(self.rules[number - 1]) if number else self
