"""Every energy term of the model and its forces in plain numpy.

Derived from the model's description alone; nothing of the package is imported, so the two can be
compared. All pair terms see every periodic image within their cutoff; links, hinges, dividing
pairs and nearest membrane particles use the minimum image. x and y are periodic, z is not.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree  # type: ignore[import-untyped, unused-ignore]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Reduced = Callable[[Floats], tuple[Floats, Floats]]  # x -> u(x), du/dx
Term = tuple[float, Floats]  # energy, forces (n, 3)
Pairs = tuple[Ints, Ints, Floats]  # i, j, vectors from i to j

CELLS = "TSN"


@dataclass(frozen=True)
class Parameters:
    """Numbers of the model, by default the paper's."""

    R_d: float = 1.4
    R_m: float = 1.0
    R_c: float = 1.4
    Kdm: float = 0.04
    Kdd: float = 0.04
    Kex: float = 0.04
    Kstr: float = 0.04
    Kbend: float = 0.5
    bending_form: str = "cosine"
    Kad: float = 25.0
    Kbind: float = 25.0
    Kcc: float = 0.03
    Kdiv: float = 5.0
    d1: float = 0.8
    d2: float = 0.25
    Lambda: float = 1.4
    lam: float = 1.4
    a1: float = 0.125
    a2: float = 1.25
    force_scale: str = "printed"
    division_spring: str = "reduced"

    def __post_init__(self) -> None:
        """Refuse words that are unknown, and the one combination nobody defined."""
        words = {"force_scale": ("printed", "direct"), "division_spring": ("length", "reduced")}
        for name, allowed in words.items():
            if getattr(self, name) not in allowed:
                raise ValueError(f"{name} is {getattr(self, name)!r}, not one of {allowed}")
        if (self.force_scale, self.division_spring) == ("direct", "reduced"):
            raise ValueError("force_scale 'direct' is defined with the 'length' spring only")

    def spring_scale(self, contact: float) -> float:
        """Return the factor of the spring-like terms: 1, or their contact length."""
        return contact if self.force_scale == "direct" else 1.0


def named(name: str) -> Parameters:
    """Return one of the named parameter sets."""
    length = Parameters(division_spring="length")
    earlier = replace(length, Kad=5.0, lam=1.2, force_scale="direct")
    sets = {
        "printed": Parameters(),
        "papilla": replace(length, lam=1.2),
        "weak5": replace(length, Kad=5.0),
        "direct5": replace(length, Kad=5.0, force_scale="direct"),
        "earlier": earlier,
        "earlier-stiff": replace(earlier, Kbend=10.0),
        "earlier-full": replace(earlier, bending_form="diverging"),
    }
    if name not in sets:
        raise ValueError(f"parameter set {name!r} is not one of {', '.join(sets)}")
    return sets[name]


@dataclass
class State:
    """Particles, their topology and the box; all indices count particles of this state."""

    kinds: NDArray[np.str_]  # (n,) of D, M, S, T, N
    positions: Floats  # (n, 3)
    box: tuple[float, float]
    divisions_left: Ints  # (n,), a T with 0 is exhausted; without meaning for the others
    links: Ints = field(default_factory=lambda: np.empty((0, 2), np.int64))
    hinges: Ints = field(default_factory=lambda: np.empty((0, 4), np.int64))
    pairs: list[tuple[int, int, float]] = field(default_factory=list)  # i, j, natural length

    def where(self, kinds: str) -> Ints:
        """Return the indices of all particles of the given kinds."""
        return np.flatnonzero(np.isin(self.kinds, list(kinds)))

    @property
    def dividing(self) -> Ints:
        """Return the indices (n_pairs, 2) of the dividing pairs."""
        return np.array([pair[:2] for pair in self.pairs], np.int64).reshape(-1, 2)

    def minimum_image(self, vectors: Floats) -> Floats:
        """Return the shortest periodic equivalents of vectors (..., 3)."""
        shortest = vectors.copy()
        shortest[..., :2] -= np.round(vectors[..., :2] / self.box) * self.box
        return shortest


def triangular_lattice(nx: int, ny: int) -> tuple[Ints, Ints, Ints]:
    """Return links (3n, 2), triangles (2n, 3) and hinges (3n, 4) of the periodic lattice.

    Row-major, odd rows shifted by half a spacing; triangles run anticlockwise seen from above.
    A hinge is (opposite1, i, j, opposite2) with opposite1 to the left of the way from i to j.
    """
    if nx < 3 or ny < 4 or ny % 2:
        raise ValueError(f"lattice of {nx} x {ny}: needs nx >= 3 and an even ny >= 4")
    row, column = (axis.ravel() for axis in np.indices((ny, nx)))
    odd = row % 2

    def site(rows_up: int, columns_right: int | Ints) -> Ints:
        return (row + rows_up) % ny * nx + (column + columns_right) % nx

    own, right, left = site(0, 0), site(0, 1), site(0, -1)
    up_right, up_left, down_right = site(1, odd), site(1, odd - 1), site(-1, odd)
    triangles = [(own, right, up_right), (own, up_right, up_left)]
    hinges = [
        (up_right, own, right, down_right),
        (up_left, own, up_right, right),
        (left, own, up_left, up_right),
    ]
    corners, hinge = (np.concatenate([np.stack(c, 1) for c in x]) for x in (triangles, hinges))
    return hinge[:, 1:3].copy(), corners, hinge


def read_configuration(path: str | Path) -> State:
    """Read a configuration: a lattice line, one line per particle, one per dividing pair."""
    kinds, positions, left, pairs = [], [], [], []
    text = Path(path).read_text()
    (head, *size), *lines = (line.split() for line in text.splitlines() if line.strip())
    if head != "lattice":
        raise ValueError(f"{path}: begins with {head!r}, not 'lattice'")
    nx, ny, box = int(size[0]), int(size[1]), (float(size[2]), float(size[3]))
    for first, *numbers in lines:
        if first == "pair":
            pairs.append((int(numbers[0]), int(numbers[1]), float(numbers[2])))
        elif first in ("D", "M", "S", "T", "N"):
            kinds.append(first)
            positions.append([float(number) for number in numbers[:3]])
            left.append(int(numbers[3]) if first == "T" else 0)
        else:
            raise ValueError(f"{path}: a line begins with {first!r}")
    state = State(np.array(kinds), np.array(positions), box, np.array(left), pairs=pairs)
    membrane = state.where("M")
    if len(membrane) != nx * ny:
        raise ValueError(f"{path}: {len(membrane)} membrane particles, lattice {nx} x {ny}")
    links, _, hinges = triangular_lattice(nx, ny)
    state.links, state.hinges = membrane[links], membrane[hinges]
    return state


# ---- potentials of x = distance / contact length: value and slope ----


def phi(x: Floats) -> tuple[Floats, Floats]:
    """Return x^-12/12 - x^-6/6."""
    return x**-12 / 12 - x**-6 / 6, x**-7 - x**-13


def u_exclusion(x: Floats) -> tuple[Floats, Floats]:
    """Return the repulsion that ends at contact."""
    value, slope = phi(np.minimum(x, 1.0))
    return value + 1 / 12, slope


def u_dermis_membrane(x: Floats, p: Parameters) -> tuple[Floats, Floats]:
    """Return phi cut and shifted at Lambda."""
    value, slope = phi(np.minimum(x, p.Lambda))
    return value - phi(np.array(p.Lambda))[0], np.where(x < p.Lambda, slope, 0.0)


def u_dermis_dermis(x: Floats, p: Parameters) -> tuple[Floats, Floats]:
    """Return the dermal potential: phi with a soft parabola put in between d1 and 1."""
    core, core_slope = phi(np.minimum(x + 1 - p.d1, 1.0))
    tail, tail_slope = u_dermis_membrane(np.maximum(x, 1.0), p)
    inside = np.minimum(x - 1, 0.0)  # 0 from contact on, where only the tail is left
    value = p.a1 / 2 * inside**2 + (core + 1 / 12) + tail
    return value, p.a1 * inside + core_slope + tail_slope


def u_stretch(x: Floats, p: Parameters, scale: float) -> tuple[Floats, Floats]:
    """Return the link potential, `scale` multiplying what is not phi."""
    if np.any(x >= 1 + p.d2):
        raise ValueError(f"link at x = {x.max():.6g}, singular from {1 + p.d2}")
    constant, linear = -p.a2 * (1 - p.d2**2) / (2 * p.d2**2), p.a2 * (1 - p.d2) / p.d2**2
    short, short_slope = phi(np.minimum(x, p.d2) / p.d2)
    long, long_slope = phi((1 + p.d2 - np.maximum(x, 1.0)) / p.d2)
    y = (x - p.d2) / p.d2
    middle, end = scale * p.a2 / 2 * y**2 - 1 / 12, scale * (constant + linear * x)
    branch = [x < p.d2, x <= 1]
    value = np.select(branch, [short, middle], long + end)
    long_slope = scale * linear - long_slope / p.d2
    return value, np.select(branch, [short_slope / p.d2, scale * p.a2 * y / p.d2], long_slope)


def u_adhesion(x: Floats, p: Parameters) -> tuple[Floats, Floats]:
    """Return the adhesion, 0 up to contact and constant from lambda on."""
    y, width = np.clip(x, 1.0, p.lam) - 1, p.lam - 1
    return y**2 / 2 - y**4 / (4 * width**2), y - y**3 / width**2


def u_binding(x: Floats) -> tuple[Floats, Floats]:
    """Return the parabola beyond contact."""
    y = np.maximum(x - 1, 0.0)
    return y**2 / 2, y


def u_kind(
    x: Floats, law: str, lam: float = np.inf, detach: float = np.inf
) -> tuple[Floats, Floats]:
    """Return what a kind of cell feels of the membrane at x, and its slope; K = 1.

    Beyond its range, or beyond where the cell leaves, the energy stays what it is there.
    """
    end = min(lam, detach)
    near = np.clip(x, 1, end) - 1
    if law == "none":
        return np.zeros_like(x), np.zeros_like(x)
    q = (near / (lam - 1)) ** 2 if law == "adhesive" else 0.0
    return near**2 / 2 * (1 - q / 2), np.where(x > end, 0.0, near * (1 - q))


# ---- searches ----


def neighbour_pairs(state: State, first: Ints, second: Ints, cutoff: float) -> Pairs:
    """Return i, j and the vector from i to j for all j images within the cutoff of each i.

    With `first` and `second` the same group every pair appears twice, once from each side.
    """
    if not len(first) or not len(second):
        return np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 3))
    box = np.array(state.box)
    wrapped = state.positions.copy()
    wrapped[:, :2] -= np.floor(wrapped[:, :2] / box) * box
    reach = np.ceil(cutoff / box).astype(int)
    images, owners = [], []
    for step in np.ndindex(*(2 * reach + 1)):
        image = wrapped[second] + np.append((step - reach) * box, 0.0)
        near = np.all((image[:, :2] >= -cutoff) & (image[:, :2] <= box + cutoff), axis=1)
        images.append(image[near])
        owners.append(second[near])
    image = np.concatenate(images)
    here, there = cKDTree(wrapped[first]), cKDTree(image)
    found = here.sparse_distance_matrix(there, cutoff, output_type="ndarray")
    i, j = first[found["i"]], np.concatenate(owners)[found["j"]]
    vectors = image[found["j"]] - wrapped[i]
    other = (i != j) | vectors.any(axis=1)  # not itself, but its own images
    return i[other], j[other], vectors[other]


def nearest_membrane(state: State) -> tuple[Ints, Floats]:
    """Return index and distance of the membrane particle nearest to each cell, in cell order."""
    membrane, cells = state.where("M"), state.where(CELLS)
    index, distance = np.empty(len(cells), np.int64), np.empty(len(cells))
    for start in range(0, len(cells), 64):  # in blocks, for the memory
        block = slice(start, start + 64)
        vectors = state.positions[membrane] - state.positions[cells[block], None, :]
        distances = np.linalg.norm(state.minimum_image(vectors), axis=2)
        index[block] = membrane[np.argmin(distances, axis=1)]
        distance[block] = np.min(distances, axis=1)
    return index, distance


# ---- terms ----


def _central(state: State, i: Ints, j: Ints, vectors: Floats, slopes: Floats) -> Floats:
    """Return the forces of pair energies with slopes dE/d(distance), vectors from i to j."""
    pull = (slopes / np.linalg.norm(vectors, axis=1))[:, None] * vectors
    forces = np.zeros_like(state.positions)
    np.add.at(forces, i, pull)
    np.add.at(forces, j, -pull)
    return forces


def _pair_term(
    state: State,
    groups: tuple[str, str],
    contact: float,
    reach: float,
    strength: float,
    u: Reduced,
    excluded: Ints | None = None,
) -> Term:
    """Return the energy and forces of all pairs of two groups within reach * contact."""
    first, second = map(state.where, groups)
    i, j, vectors = neighbour_pairs(state, first, second, reach * contact)
    if excluded is not None:
        n = len(state.kinds)
        forbidden = excluded.min(axis=1) * n + excluded.max(axis=1)
        keep = ~np.isin(np.minimum(i, j) * n + np.maximum(i, j), forbidden)
        i, j, vectors = i[keep], j[keep], vectors[keep]
    if groups[0] == groups[1]:
        strength /= 2  # each pair is there twice
    value, slope = u(np.linalg.norm(vectors, axis=1) / contact)
    return strength * float(value.sum()), _central(state, i, j, vectors, strength * slope / contact)


def _nearest_term(
    state: State, taking_part: NDArray[np.bool_], contact: float, strength: float, u: Reduced
) -> Term:
    """Return the energy and forces between some of the cells and their nearest membrane."""
    if not taking_part.any() or not len(state.where("M")):
        return 0.0, np.zeros_like(state.positions)
    i, j = state.where(CELLS)[taking_part], nearest_membrane(state)[0][taking_part]
    vectors = state.minimum_image(state.positions[j] - state.positions[i])
    value, slope = u(np.linalg.norm(vectors, axis=1) / contact)
    return strength * float(value.sum()), _central(state, i, j, vectors, strength * slope / contact)


def _wall(state: State, p: Parameters) -> Term:
    """Return the energy and forces between the dermis and its mirror image below z = 0."""
    dermis = state.where("D")
    x = state.positions[dermis, 2] / p.R_d
    if np.any(x <= 0):
        raise ValueError(f"dermal particle at z = {x.min() * p.R_d:.6g}, in or below the wall")
    value, slope = u_exclusion(x)
    forces = np.zeros_like(state.positions)
    forces[dermis, 2] = -p.Kex * slope / p.R_d
    return p.Kex * float(value.sum()), forces


def _stretch(state: State, p: Parameters) -> Term:
    """Return the energy and forces of the links."""
    (i, j), contact = state.links.T, 2 * p.R_m
    vectors = state.minimum_image(state.positions[j] - state.positions[i])
    x = np.linalg.norm(vectors, axis=1) / contact
    value, slope = u_stretch(x, p, p.spring_scale(contact))
    return p.Kstr * float(value.sum()), _central(state, i, j, vectors, p.Kstr * slope / contact)


def _bend(state: State, p: Parameters) -> Term:
    """Return the bending energy and forces, the latter by way of dE/dN of each triangle."""
    forces = np.zeros_like(state.positions)
    above, i, j, below = state.hinges.T
    # both triangles of every hinge, smallest corner first, so that each is found once
    corners = np.concatenate([np.stack([i, j, above], 1), np.stack([j, i, below], 1)])
    turns = (np.argmin(corners, axis=1)[:, None] + np.arange(3)) % 3
    triangles, which = np.unique(np.take_along_axis(corners, turns, 1), axis=0, return_inverse=True)
    one, two = which.reshape(2, -1)

    r0, r1, r2 = (state.positions[corner] for corner in triangles.T)
    e1, e2 = state.minimum_image(r1 - r0), state.minimum_image(r2 - r0)
    product = np.cross(e1, e2)
    length = np.linalg.norm(product, axis=1)[:, None]
    normal = product / length
    # 1 - N1.N2 without cancellation where the membrane is flat
    off = np.sum((normal[one] - normal[two]) ** 2, axis=1) / 2

    value, slope = off**2 / 2, off  # for K = 1, and minus its derivative by N1.N2
    if p.bending_form == "diverging":
        wide = off > 1
        open_ = np.where(wide, 2 - off, 1)
        value, slope = np.where(wide, 1 / open_ - 0.5, value), np.where(wide, open_**-2, slope)

    by_normal = np.zeros_like(normal)  # dE/dN
    np.add.at(by_normal, one, -p.Kbend * slope[:, None] * normal[two])
    np.add.at(by_normal, two, -p.Kbend * slope[:, None] * normal[one])
    # N stays a unit vector: dN = (1 - N N) d(product) / length
    along = normal * np.sum(normal * by_normal, axis=1, keepdims=True)
    by_product = (by_normal - along) / length
    by_e1, by_e2 = np.cross(e2, by_product), np.cross(by_product, e1)
    for corner, gradient in zip(triangles.T, (-by_e1 - by_e2, by_e1, by_e2), strict=True):
        np.add.at(forces, corner, -gradient)
    return p.Kbend * float(np.sum(value)), forces


def _division(state: State, p: Parameters) -> Term:
    """Return the energy and forces of the springs of the dividing pairs."""
    i, j = state.dividing.T
    natural = np.array([pair[2] for pair in state.pairs])
    stiffness = p.Kdiv / (2 * p.R_c) ** 2 if p.division_spring == "reduced" else p.Kdiv
    vectors = state.minimum_image(state.positions[j] - state.positions[i])
    excess = np.linalg.norm(vectors, axis=1) - natural
    forces = _central(state, i, j, vectors, stiffness * excess)
    return stiffness / 2 * float(np.sum(excess**2)), forces


def energies_and_forces(
    state: State, parameters: Parameters
) -> tuple[dict[str, float], dict[str, Floats]]:
    """Return the energy and the forces (n, 3) of each term, by the term's name."""
    p = parameters
    near, cells, unlinked = p.R_c + p.R_m, 2 * p.R_c, 2 * p.R_m * p.d2  # contact lengths
    ad, bind = p.Kad * p.spring_scale(near), p.Kbind * p.spring_scale(near)
    cc = p.Kcc * p.spring_scale(cells)
    is_ta = state.kinds[state.where(CELLS)] == "T"
    adheres = is_ta & (state.divisions_left[state.where(CELLS)] > 0)

    def shifted(x: Floats) -> tuple[Floats, Floats]:
        value, slope = u_adhesion(x, p)
        return value - (p.lam - 1) ** 2 / 4, slope

    dermal, below = partial(u_dermis_dermis, p=p), partial(u_dermis_membrane, p=p)
    pairs, nearest = partial(_pair_term, state), partial(_nearest_term, state)
    between = partial(pairs, (CELLS, CELLS))
    terms: dict[str, Term] = {
        "dermis_dermis": pairs(("D", "D"), 2 * p.R_d, p.Lambda, p.Kdd, dermal),
        "dermis_membrane": pairs(("D", "M"), p.R_d + p.R_m, p.Lambda, p.Kdm, below),
        "wall": _wall(state, p),
        "stretch": _stretch(state, p),
        "bend": _bend(state, p),
        "membrane_exclusion": pairs(("M", "M"), unlinked, 1.0, p.Kex, u_exclusion, state.links),
        "cell_membrane_exclusion": pairs((CELLS, "M"), near, 1.0, p.Kex, u_exclusion),
        "adhesion": nearest(adheres, near, ad, partial(u_adhesion, p=p)),
        "binding": nearest(~is_ta, near, bind, u_binding),
        "cell_cell_exclusion": between(cells, 1.0, p.Kex, u_exclusion, state.dividing),
        "cell_cell_adhesion": between(cells, p.lam, cc, shifted, state.dividing),
        "division": _division(state, p),
    }
    return {name: t[0] for name, t in terms.items()}, {name: t[1] for name, t in terms.items()}
