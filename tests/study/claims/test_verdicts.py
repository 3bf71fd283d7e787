"""Every claim gets every verdict from tables that deserve it, and seldom by chance."""

from __future__ import annotations

import numpy as np
import pytest
from lammps_skin.study.claims.catalogue import CLAIMS, judge_all
from lammps_skin.study.claims.rules import POSITIVE, Finding, Range, Word, judge, word
from lammps_skin.study.ranges import Window

from tests.study.claims.made_up import Change, ensembles, ramp

TESTED = [claim for claim in CLAIMS if claim.test]
Case = dict[str, Change]


def constant(value: float) -> Change:
    return lambda scene, times, values: value


def times(factor: float, only: tuple[str, ...] = ()) -> Change:
    return lambda scene, _, values: values * (factor if not only or scene in only else 1)


def graded(scene: str, _: object, values: np.ndarray) -> np.ndarray:
    """Levels of the arrangements that are far apart, each from each."""
    return values * {"cluster": 3, "random": 6}.get(scene, 1)


def fallen(scene: str, _: object, values: np.ndarray) -> np.ndarray:
    """sigma from a cluster falls to that of the others."""
    return 1.3 - 1.0 * ramp(0, 300) if scene == "cluster" else 0 * values + 0.3


CASES: dict[tuple[int, Word], Case] = {
    (1, "does not"): {"coverage": constant(0.5), "height_std": constant(1.0)},
    (1, "partly"): {"height_std": constant(1.0)},
    (2, "does not"): {"skewness": constant(-1.0), "papillae": constant(3.0)},
    (2, "partly"): {"skewness": constant(-1.0)},
    (3, "does not"): {
        "stem_on_tips": constant(0.4), "chi_H": times(-1), "chi_G": times(-1), "zeta": times(-1)
    },
    (3, "partly"): {"chi_G": lambda _, time, values: values * (time < 700)},
    (4, "does not"): {
        "zeta": lambda *_: 0.5 * ramp(200, 250), "chi_H": lambda *_: 0.3 * ramp(300, 400),
        "chi_G": lambda *_: 0.2 * ramp(300, 400),
    },
    (4, "partly"): {"chi_H": lambda *_: 0.3 * ramp(400, 600)},
    (5, "does not"): {"chi_H": graded, "chi_G": graded, "zeta": graded},
    (5, "partly"): {"chi_H": times(2.5, only=("cluster",))},
    (6, "does not"): {"sigma": constant(0.3)},
    (6, "partly"): {"sigma": fallen},
    (7, "does not"): {
        "nd_on_tips": constant(0.3), "chi_H_nd": times(-1), "chi_G_nd": times(-1)
    },
    (7, "partly"): {"nd_on_tips": constant(0.3)},
    (8, "does not"): {"sigma_nd": constant(0.1)},
    (8, "partly"): {"sigma_nd": times(0.2, only=("nd-a", "nd-c"))},
    (9, "does not"): {"zeta_nd": lambda *_: 0.5 * ramp(300, 500) - 1},
    (9, "partly"): {"zeta_nd": lambda *_: 0.5 * ramp(300, 500) - 0.2},
}  # fmt: skip


def test_all_claims_hold() -> None:
    verdicts = judge_all(ensembles())
    assert [one.claim.number for one in verdicts] == list(range(1, 12))
    for one in verdicts[:9]:
        assert one.word == "holds", (one.claim, one.parts, one.weakest)
        assert set(one.seeds.values()) == {8}
    for one in verdicts[9:]:
        assert one.word == "not tested" and one.notes.startswith("needs ")


@pytest.mark.parametrize(("number", "expected"), CASES)
def test_a_claim_that_is_not_so(number: int, expected: Word) -> None:
    found = judge(CLAIMS[number - 1], ensembles(CASES[number, expected]))
    assert found.word == expected, (found.parts, found.weakest)
    assert found.weakest.outcome() != "yes"


def zeta(_: object, __: object, values: np.ndarray) -> np.ndarray:
    return 0 * values + 0.5 * ramp(300, 500)


# just beyond the range of one part, all others as they should be
PARTS: dict[tuple[int, str], Case] = {
    (1, "covered"): {"coverage": lambda _, time, values: np.where(time > 600, 0.88, values)},
    (1, "near t = 300"): {"coverage": lambda _, time, __: np.minimum(time / 180, 0.99)},
    (1, "flat while bare"): {"height_std": lambda _, time, __: np.where(time < 200, 0.65, 1.2)},
    (2, "outward"): {"skewness": constant(-0.1)},
    (2, "many"): {"papillae": constant(7.5)},
    (3, "on tips"): {"stem_on_tips": constant(0.47)},
    (3, "from 0"): {"chi_H": constant(0.3)},
    (3, "stationary"): {"zeta": lambda *_: 0.5 * ramp(300, 500) + 0.6 * ramp(750, 800)},
    (4, "later"): {"zeta": lambda *_: 0.5 * ramp(230, 330)},
    (5, "chi_H alike"): {"chi_H": times(1.8, only=("ring",))},
    (5, "chi_G alike"): {"chi_G": times(1.8, only=("cluster",))},
    (5, "zeta alike"): {"zeta": times(1.8, only=("random",))},
    (6, "falls"): {"sigma": lambda scene, _, values: 0.7 if scene == "cluster" else values},
    (6, "settled"): {"sigma": lambda scene, time, values: values * np.where(time > 600, 1.6, 1)},
    (6, "remembers"): {"sigma": times(2.05, only=("ring",))},
    (7, "on tips"): {"nd_on_tips": constant(0.47)},
    (7, "as stem cells"): {"chi_G_nd": times(1.6)},
    (8, "more clustered"): {"sigma_nd": times(0.3, only=("nd-c",))},
    (8, "most where apart"): {"sigma_nd": times(2.2, only=("nd-a",))},
    (9, "a little below"): {
        "zeta_nd": lambda *given: zeta(*given) - 0.6 * ramp(250, 300) + ramp(600, 900)
    },
    (9, "late above"): {"zeta_nd": lambda *given: zeta(*given) - 0.1 * ramp(250, 300)},
}


@pytest.mark.parametrize(("number", "part"), PARTS)
def test_each_part_has_its_range(number: int, part: str) -> None:
    found = judge(CLAIMS[number - 1], ensembles(PARTS[number, part], spread=0.005))
    assert {one.part for one in found.findings if one.outcome() != "yes"} == {part}
    assert found.word != "holds"


@pytest.mark.parametrize("claim", TESTED, ids=lambda claim: str(claim.number))
def test_what_is_missing(claim) -> None:
    all_there = ensembles(seeds=3)
    few = judge(claim, all_there)
    assert few.word == "too few seeds" and few.notes.startswith("needs 4 seeds, not 3 (")
    assert few.findings and not few.parts
    lacking = {scene: one for scene, one in all_there.items() if scene not in claim.scenes[0]}
    found = judge(claim, lacking)
    assert found.word == "not tested" and found.notes == f"needs {' or '.join(claim.scenes[0])}"
    for one in all_there.values():
        one.table = one.table[one.table["time"] <= 900]
    assert "ends at t = 900" in judge(claim, all_there).notes


# ---- power and false positives

TRIALS = 100
SPREAD = 0.15  # of seeds, and again of frames, over the level

# what is claimed lies on the very edge of the range, or there is nothing
NULLS: dict[int, Case] = {
    1: {"coverage": lambda _, time, __: np.minimum(time / 300, 0.9),
        "height_std": lambda _, time, __: np.where(time < 200, 0.6, 1.2)},
    2: {"skewness": constant(0.0), "papillae": constant(8.0)},
    3: {"stem_on_tips": constant(0.5), "chi_H": constant(0.0), "chi_G": constant(0.0),
        "zeta": constant(0.0)},
    4: {"zeta": lambda *_: 0.5 * ramp(250, 350)},
    5: {name: lambda scene, _, values: values * {"cluster": 2, "random": 3}.get(scene, 1)
        for name in ("chi_H", "chi_G", "zeta")},
    6: {"sigma": constant(0.4)},
    7: {"nd_on_tips": constant(0.5), "chi_H_nd": constant(0.0), "chi_G_nd": constant(0.0)},
    8: {"sigma_nd": constant(0.25), "sigma": constant(0.25)},
    9: {"zeta_nd": lambda *_: 0.5 * ramp(300, 500)},
}  # fmt: skip


def verdicts(number: int, case: Case) -> list[Word]:
    """Of many ensembles of 8 seeds."""
    claim, random = CLAIMS[number - 1], np.random.default_rng(number)
    used = {scene for group in claim.scenes for scene in group}
    return [
        judge(claim, ensembles(case, SPREAD, random=random, only=used)).word for _ in range(TRIALS)
    ]


@pytest.mark.parametrize("claim", TESTED, ids=lambda claim: str(claim.number))
def test_what_is_so_is_found(claim) -> None:
    assert verdicts(claim.number, {}).count("holds") >= 0.8 * TRIALS


@pytest.mark.parametrize("number", NULLS)
def test_nothing_is_seldom_taken_for_something(number: int) -> None:
    found = verdicts(number, NULLS[number])
    error = 3 * np.sqrt(0.05 * 0.95 / TRIALS)
    assert found.count("holds") <= 0.05 * TRIALS
    assert found.count("partly") <= (0.05 + error) * TRIALS


def test_the_rule_of_one_and_of_many_findings() -> None:
    """One finding holds by chance in 2.5 % of cases; of 20, one speaks in no more."""
    random = np.random.default_rng(5)

    def findings(mean: float, n: int = 1, claimed: Range = POSITIVE) -> list[Finding]:
        drawn = random.normal(mean, 1.0, (n, 8))
        return [Finding("", "", "", Window(0, 1), claimed, (values,)) for values in drawn]

    trials = 400
    alone = sum(word(findings(0.0)) == "holds" for _ in range(trials))
    assert abs(alone - 0.025 * trials) < 3 * np.sqrt(0.025 * trials)
    among = [word(findings(0.0, n=20)) for _ in range(100)]
    assert "holds" not in among and among.count("partly") <= 9
    assert word([*findings(3.0), *findings(0.0, n=5)]) == "partly"
    outcomes = [one.outcome() for mean in (3, -3, 0) for one in findings(mean)]
    assert outcomes == ["yes", "no", "undecided"]
    assert findings(0.0, claimed=Range(-3, 3))[0].outcome() == "yes"
