"""Limits that are known before a part is made: the job stops there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from ddgfab.errors import DdgError
from fabrication.job.problems import FailedCheck, problems_of
from fabrication.job.product import Product
from fabrication.project.toml import argument_text


class LimitError(DdgError):
    """Pieces are beyond limits of the project, so that nothing was made.

    Attributes
    ----------
    summary : the limits, with how many pieces are beyond them and the worst, in one line
    problems : the same in full
    settings : (section, key, value) with which the limits may be kept
    advice : what else to do where no setting helps
    """

    def __init__(
        self,
        problems: Sequence[FailedCheck],
        settings: Sequence[tuple[str, str, Any]],
        advice: str = "",
    ) -> None:
        self.summary = "; ".join(problem.short() for problem in problems)
        self.problems, self.settings = tuple(problems), tuple(settings)
        self.advice = "" if settings else advice
        lines = [f"{self.summary}; nothing was made"]
        if settings:
            what = ", ".join(
                f"{section}.{key} = {argument_text(value)}" for section, key, value in settings
            )
            lines.append(f"What helps: {what}")
        elif advice:
            lines.append(advice)
        lines.append("To make the parts all the same, and reject them: anyway=True")
        super().__init__("\n".join(lines))


def set_arguments(settings: Iterable[tuple[str, str, Any]]) -> list[str]:
    """Settings (section, key, value) as arguments of the command line."""
    return [
        argument
        for section, key, value in settings
        for argument in ("--set", f"{section}.{key}={argument_text(value)}")
    ]


def check_limits(product: Product) -> None:
    """Raise where pieces are beyond limits.

    Raises
    ------
    LimitError
        Names limits and pieces, the worst first, and the settings that help.
    """
    problems = problems_known(product)
    if problems:
        raise LimitError(problems, product.remedies(problems), product.nothing_helps)


def problems_known(product: Product) -> tuple[FailedCheck, ...]:
    """Limits that pieces are beyond, as far as is known before parts are made."""
    roles = {piece.mark: piece.kind.role for piece in product.pieces}
    checks = ((piece.mark, check) for piece in product.pieces for check in piece.checks)
    return problems_of(roles, checks)
