"""What an optimisation is: unknowns in one vector, terms on them, unknowns that are fixed.

All unknowns lie in one flat vector: first the 3V vertex coordinates (vertex after vertex), then
the auxiliary blocks a problem adds (node axes, normals, heights). `Layout` has their places.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints, Mesh

VERTICES = "vertices"
"""Name of the first block of every layout."""


@runtime_checkable
class Term(Protocol):
    """One goal: residuals of the unknowns that should vanish, without unit.

    Attributes
    ----------
    name : for histories and errors
    weight : factor of the squared residuals in the objective; a hard term has none
    hard : an equation to be met, not only approached
    """

    @property
    def name(self) -> str:
        """For histories and errors."""

    @property
    def weight(self) -> float:
        """Factor of the squared residuals."""

    @property
    def hard(self) -> bool:
        """Whether it is an equation to be met."""

    def residual(self, x: Floats) -> Floats:
        """(m,) values at the (n,) unknowns."""
        ...

    def jacobian(self, x: Floats) -> csr_array:
        """(m, n) derivative; its pattern of entries does not depend on x."""
        ...


class Following(Protocol):
    """A soft term that follows the unknowns: `at` gives the term to use near a state."""

    @property
    def weight(self) -> float:
        """Factor of the squared residuals."""

    def at(self, x: Floats) -> Term:
        """The term at the (n,) unknowns."""
        ...


class Barrier(Protocol):
    """What the unknowns may never lose: a cost that rises without limit before it is lost."""

    def value(self, x: Floats) -> float:
        """The cost at the (n,) unknowns; infinite where it is lost."""
        ...

    def active(self, x: Floats) -> tuple[csr_array, Floats, Floats]:
        """(a, n) slopes of what costs something, (a,) first and second derivatives of the cost."""
        ...


@dataclass(frozen=True)
class Layout:
    """Where each block of unknowns lies: names, numbers of elements, numbers per element."""

    names: tuple[str, ...]
    counts: tuple[int, ...]
    widths: tuple[int, ...]

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return sum(c * w for c, w in zip(self.counts, self.widths, strict=True))

    def block(self, name: str) -> slice:
        """The part of the vector that holds a block."""
        at = self._find(name)
        start = sum(c * w for c, w in zip(self.counts[:at], self.widths[:at], strict=True))
        return slice(start, start + self.counts[at] * self.widths[at])

    def index(self, name: str, elements: Ints | Sequence[int]) -> Ints:
        """(..., width) unknowns of elements (...) of a block."""
        width = self.widths[self._find(name)]
        ids = np.asarray(elements, dtype=np.int64)
        return np.asarray(self.block(name).start + width * ids[..., None] + np.arange(width))

    def values(self, x: Floats, name: str) -> Floats:
        """(count, width) values of a block: a view of x."""
        return x[self.block(name)].reshape(-1, self.widths[self._find(name)])

    def _find(self, name: str) -> int:
        if name not in self.names:
            raise InputError(f"no block {name!r} of unknowns; there are {', '.join(self.names)}")
        return self.names.index(name)


@dataclass(frozen=True, eq=False)
class Problem:
    """Unknowns, where they start, how large they are, which are fixed, and the terms on them.

    Make one with `Problem.build`.

    Attributes
    ----------
    start : (n,) first values
    scale : (n,) what counts as a step of size one for each unknown: the mean edge for coordinates
    free : (n,) whether an unknown may change
    following : soft terms that are frozen at each state (nearest points of a surface)
    barriers : what may never be lost
    """

    mesh: Mesh
    layout: Layout
    start: Floats
    scale: Floats
    free: NDArray[np.bool_]
    terms: tuple[Term, ...] = field(default=())
    following: tuple[Following, ...] = ()
    barriers: tuple[Barrier, ...] = ()

    @staticmethod
    def build(
        mesh: Mesh,
        terms: Sequence[Term] = (),
        *,
        blocks: Mapping[str, Floats] | None = None,
        fixed: Ints | Sequence[int] = (),
    ) -> Problem:
        """Problem on the vertices of a mesh and further blocks.

        Parameters
        ----------
        terms : may also be added later, `with_terms`, when they need the layout
        blocks : by name, (count, width) first values of auxiliary unknowns of size about one
        fixed : ids of vertices that stay where they are
        """
        given = {
            name: np.atleast_2d(np.asarray(b, dtype=np.float64))
            for name, b in (blocks or {}).items()
        }
        layout = Layout(
            (VERTICES, *given),
            (mesh.n_vertices, *(len(b) for b in given.values())),
            (3, *(b.shape[1] for b in given.values())),
        )
        start = np.concatenate([mesh.vertices.ravel(), *(b.ravel() for b in given.values())])
        scale = np.ones(layout.size)
        scale[: 3 * mesh.n_vertices] = mean_edge(mesh)
        free = np.ones(layout.size, dtype=bool)
        free[layout.index(VERTICES, fixed).ravel()] = False
        free[: 3 * mesh.n_vertices] &= np.repeat(mesh.valences > 0, 3)
        return Problem(mesh, layout, start, scale, free, tuple(terms))

    def with_terms(self, *terms: Term) -> Problem:
        """The same problem with further terms."""
        return replace(self, terms=(*self.terms, *terms))

    def with_start(self, x: Floats) -> Problem:
        """The same problem from another start."""
        return replace(self, start=x)

    def vertices(self, x: Floats) -> Floats:
        """(V, 3) vertices in a vector of unknowns."""
        return self.layout.values(x, VERTICES)


@checked
def mean_edge(mesh: Mesh) -> float:
    """Mean length of the edges: the unit in which movements and residuals are measured."""
    length = float(mesh.edge_lengths.mean())
    if not length > 0:
        raise InputError("all edges of the mesh have length zero")
    return length
