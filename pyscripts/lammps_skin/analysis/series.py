"""Observables of every frame of a trajectory, as analyses of MDAnalysis.

Each takes a universe of `open_trajectory`; after ``run()``, `results` has the time (f,) of the f
frames and what the class says.

Examples
--------
>>> universe = open_trajectory("runs/one-stem/skin.h5")
>>> found = OrderParameters(universe).run(start=10).results
>>> found.time, found.zeta
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from lammps_skin.analysis.coverage import count_by_kind
from lammps_skin.analysis.curvature import curvature
from lammps_skin.analysis.lineage import Events, founder_of, mixing
from lammps_skin.analysis.spectrum import height_spectrum
from lammps_skin.analysis.state import State, StateAnalysis
from lammps_skin.kinds import KINDS, Kind, is_cell


class MembraneCurvature(StateAnalysis):
    """Curvature at the n particles of the membrane, in the order of their ids.

    ``results.mean`` (f, n), 1/length, and ``results.gaussian`` (f, n), 1/length^2: positive
    where convex toward the cells; ``results.area`` (f, n), length^2. See `curvature.curvature`.
    """

    columns = ("mean", "gaussian", "area")

    def _measure(self, state: State) -> tuple[Any, ...]:
        bent = curvature(state.membrane, state.triangles, state.box)
        return bent.mean, bent.gaussian, bent.area


class OrderParameters(StateAnalysis):
    """``results.chi_H``, ``chi_G``, ``zeta``, ``sigma`` (f,) of the cells of a kind.

    NaN in frames without a cell of that kind. See `order.Order`.

    Parameters
    ----------
    universe : Universe
    of : Kind
    """

    columns = ("chi_H", "chi_G", "zeta", "sigma")

    def __init__(self, universe: Any, of: Kind = Kind.STEM, **options: Any) -> None:
        super().__init__(universe, **options)
        self._of = of

    def _measure(self, state: State) -> tuple[Any, ...]:
        return state.order(self._of)


class Coverage(StateAnalysis):
    """``results.fraction`` (f,) of the membrane within reach of a cell. See `State.coverage`."""

    columns = ("fraction",)

    def _measure(self, state: State) -> tuple[Any, ...]:
        return (state.coverage,)


class CellCounts(StateAnalysis):
    """``results.stem``, ``ta``, ``exhausted``, ``nd`` (f,): numbers of living cells.

    Kinds that the scene adds have theirs by their labels.
    """

    columns = tuple(kind.label for kind in KINDS if is_cell(kind))

    def __init__(self, universe: Any, **options: Any) -> None:
        super().__init__(universe, **options)
        self.columns = tuple(kind.label for kind in self.scene.kinds_of_cells)

    def _measure(self, state: State) -> tuple[Any, ...]:
        return tuple(count_by_kind(state.kinds, state.scene.kinds_of_cells).values())


class HeightSpectrum(StateAnalysis):
    """``results.power`` (f, b), length^2, at wave numbers ``q`` (f, b), ``modes`` (f, b) of each.

    The wave numbers are the same in all frames. See `spectrum.Spectrum`.
    """

    columns = ("q", "power", "modes")

    def _measure(self, state: State) -> tuple[Any, ...]:
        return height_spectrum(state.height, state.box)


class PapillaShapes(StateAnalysis):
    """``results.number`` (f,) of papillae, means of ``height``, ``width``, ``spacing`` (f,).

    Lengths; NaN in frames without papillae, the spacing also with a single one. What a papilla
    is, and its measures: `State.papillae`, `papillae.Papillae`.
    """

    columns = ("number", "height", "width", "spacing")

    def _measure(self, state: State) -> tuple[Any, ...]:
        return (len(state.papillae.height), *state.papilla_means())


class HeightSkewness(StateAnalysis):
    """``results.value`` (f,) of the skewness of the height, 95 % interval ``low``, ``high`` (f,).

    The interval is a bootstrap over blocks of about 10 x 10, NaN if there is but one.
    NaN while the membrane is flat. See `papillae.skewness`.
    """

    columns = ("value", "low", "high")

    def _measure(self, state: State) -> tuple[Any, ...]:
        return state.skewness()


class TipOccupancy(StateAnalysis):
    """``results.fraction`` (f,) of the cells of a kind on tips, against cells drawn at random.

    ``results.expected`` and ``sd`` (f,): mean and standard deviation of that fraction for as
    many of the other cells; ``z`` (f,) = (fraction - expected)/sd; ``p_value`` (f,). NaN where
    not defined. See `papillae.TipFraction`.

    Parameters
    ----------
    universe : Universe
    of : Kind
    others : sequence of Kind, optional
        Kinds that stand for no preference; all others that may detach if not given, which are
        TA cells with or without divisions left unless the scene has kinds of its own.
    """

    columns = ("fraction", "expected", "sd", "z", "p_value")

    def __init__(
        self,
        universe: Any,
        of: Kind = Kind.STEM,
        others: Sequence[Kind] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(universe, **options)
        self._of, self._others = of, others

    def _measure(self, state: State) -> tuple[Any, ...]:
        return state.tips(self._of, self._others)


class CloneMixing(StateAnalysis):
    """``results.mixing`` (f,) of clones among touching cells, see `lineage.mixing`.

    Cells touch where cell-cell adhesion acts, within lambda 2 R_c.

    Parameters
    ----------
    universe : Universe
    events : Events
        Of the same run, see `lineage.read_events`.
    """

    columns = ("mixing",)

    def __init__(self, universe: Any, events: Events, **options: Any) -> None:
        super().__init__(universe, **options)
        self._events = events

    def _measure(self, state: State) -> tuple[Any, ...]:
        cells = state.scene.cells
        clones = founder_of(state.ids, self._events)
        return (mixing(state.cells, clones, state.box, cells.adhesion_range * 2 * cells.radius),)
