"""Threshold of a gain: formula, calibration, decoys, and fields of the policy."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf import Diagnosis, InputError, Rig, diagnose
from jbf.diagnosis import level as levels
from jbf.diagnosis.directions import (
    DECOY_DRAWS,
    Directions,
    RichestResidual,
    decoy_gains,
    rate_below,
)
from jbf.diagnosis.level import Level, with_decoys
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.policy_sections import Selection
from jbf.estimation.likelihood import independent_share
from jbf.estimation.samples import Samples
from linear_campaigns import CANDIDATES, Textbook, linear_diagnosis, linear_runs
from scipy import signal, stats

N, STEP_S, RUNS, TESTED = 2000, 0.02, 4, 8
SAMPLES = Samples(
    tuple(f"run {i}" for i in range(RUNS)),
    (STEP_S,) * RUNS,
    (np.ones(N, bool),) * RUNS,
    (np.ones(N),) * RUNS,
)
TIME: Array = np.linspace(0.0, RUNS * N * STEP_S, RUNS * N, endpoint=False)
LAW = np.stack([np.ones_like(TIME), np.cos(0.2 * TIME)], axis=1)
NO_ENDS = np.array([], dtype=np.intp)
Draw = Callable[[np.random.Generator], Array]


def test_false_alarm_rate_is_shared_and_minimum_size_grows_with_samples() -> None:
    policy = replace(DEFAULT, false_alarm_rate=0.02, min_effect_share=0.05, artefact_margin=7.0)
    level = Level.in_white_noise(policy, 8, 1000.0, 4.0)
    assert level.chance == 0.02 / 8
    assert level.artefact_margin == 7.0
    assert level.min_gain == pytest.approx(0.05**2 * 1000.0)
    # 1 N is above 5 % of 4 N and below 5 % of 40 N.
    in_newtons = replace(policy, min_effect=1.0)
    assert Level.in_white_noise(in_newtons, 8, 1000.0, 4.0).min_gain == pytest.approx(1000.0 / 16.0)
    assert Level.in_white_noise(in_newtons, 8, 1000.0, 40.0).min_gain == pytest.approx(2.5)
    assert Level.in_white_noise(policy, 0, 1000.0, 4.0).chance == 0.02


def test_effect_must_explain_the_share_of_the_motion_errors_up_to_a_limit() -> None:
    for motion_share, share in ((0.0, 0.0009), (0.002, 0.002), (0.01, 0.01), (0.6, 0.015)):
        least = DEFAULT.least_effect_share(motion_share)
        level = Level.in_white_noise(DEFAULT, 8, 1e4, 4.0, least)
        assert level.min_share == pytest.approx(share)
        assert level.min_gain == pytest.approx(share * 1e4)


def test_threshold_is_the_largest_of_chance_level_margin_and_minimum_size() -> None:
    level = Level(0.02, 8, 1e-4, artefact_margin=5.0, min_gain=3.0)
    assert level.critical == pytest.approx(stats.chi2.isf(1e-4, 1))
    assert level.white_noise_threshold == pytest.approx(stats.chi2.isf(0.0025, 1))
    assert level.price(1, 100) == pytest.approx(level.critical)
    assert replace(level, artefact_margin=9.0).price(1, 100) == pytest.approx(
        level.white_noise_threshold + 9.0
    )
    assert replace(level, min_gain=50.0).price(1, 100) == 50.0


def test_each_further_parameter_raises_the_threshold_by_the_log_of_the_samples() -> None:
    level = Level(0.02, 8, 1e-4, artefact_margin=5.0, min_gain=3.0)
    assert level.price(3, 100) == pytest.approx(level.price(1, 100) + 2.0 * np.log(100.0))
    assert level.price(0, 100) == level.price(1, 100)


def test_threshold_in_a_long_recording_is_the_minimum_effect_size() -> None:
    assert Level.in_white_noise(DEFAULT, 20, 1e5, 0.5).price(1, 100_000) == pytest.approx(90.0)
    in_newtons = replace(DEFAULT, min_effect_share=0.0, min_effect=0.02)
    assert Level.in_white_noise(in_newtons, 20, 1e5, 0.5).price(1, 100_000) == pytest.approx(160.0)
    short = Level.in_white_noise(in_newtons, 20, 1e3, 0.5).price(1, 1000)
    assert short == pytest.approx(stats.chi2.isf(0.01 / 20, 1) + 22.0)


def _shapes() -> list[Array]:
    """Derivatives of the force by eight candidates: waves, a square wave and bumps."""
    waves = [np.sin((0.3 + 0.1 * k) * TIME + k) for k in range(TESTED - 2)]
    bumps: Array = np.exp(-(((TIME % 40.0) - 20.0) ** 2))
    return [*waves, np.sign(np.sin(0.4 * TIME)), bumps]


def _directions(noise: Array, shapes: list[Array] | None = None) -> list[Directions]:
    share = independent_share(np.split(noise, RUNS), SAMPLES.steps_s)
    shapes = _shapes() if shapes is None else shapes
    return [Directions.of(noise, shape[:, None], LAW, SAMPLES, share) for shape in shapes]


def calibrated(level: Level, directions: list[Directions]) -> Level:
    """Calibrated level for the residual without the part that the directions explain."""
    return levels.calibrated(level, directions, RichestResidual.of(directions, SAMPLES))


def _white(random: np.random.Generator) -> Array:
    return random.standard_normal(RUNS * N)


def _slow(random: np.random.Generator) -> Array:
    """First-order autoregressive noise with a memory of half a second."""
    return np.asarray(signal.lfilter([1.0], [1.0, -float(np.exp(-STEP_S / 0.5))], _white(random)))


NOISES: dict[str, Draw] = {
    "white": _white,
    "heavy tails": lambda random: random.standard_t(3.0, RUNS * N),
    "slow": _slow,
    "larger where candidates show": lambda random: _white(random) * (0.2 + np.sin(0.4 * TIME) ** 4),
}


def test_direction_of_an_effect_is_of_unit_length_and_orthogonal_to_the_law() -> None:
    noise = _white(np.random.default_rng(3))
    own = (LAW @ [2.0, 3.0] + _shapes()[2])[:, None]
    for unit in (1e-6, 1.0, 1e6):
        basis = Directions.of(noise, unit * own, LAW, SAMPLES, 1.0).basis
        assert basis.shape == own.shape
        np.testing.assert_allclose(basis.T @ LAW, 0.0, atol=1e-9)
        np.testing.assert_allclose(basis.T @ basis, 1.0)
    # No direction remains of a derivative that the law contains.
    assert Directions.of(noise, LAW[:, :1], LAW, SAMPLES, 1.0).basis.shape[1] == 0


def test_weight_of_a_score_is_reduced_if_the_noise_is_larger_where_the_effect_acts() -> None:
    """The effect acts only at a tenth of the samples, where the noise is five times as large."""
    here = np.arange(RUNS * N) % 400 < 40
    noise: Array = np.where(here, 5.0, 1.0) * _white(np.random.default_rng(2))
    one_run = Samples(("a",), (STEP_S,), (np.ones(RUNS * N, bool),), (np.ones(RUNS * N),))
    found = Directions.of(noise, here[:, None].astype(float), LAW[:, :1], one_run, 1.0)
    assert found.shares[0] == pytest.approx(np.mean(noise**2) / 25.0, rel=0.5)
    even = Directions.of(_white(np.random.default_rng(2)), TIME[:, None], LAW, SAMPLES, 0.25)
    assert even.shares[0] == pytest.approx(0.25, rel=0.1)


def _level(false_alarm_rate: float = 0.01) -> Level:
    policy = replace(DEFAULT, min_effect_share=0.0, false_alarm_rate=false_alarm_rate)
    return Level.in_white_noise(policy, TESTED, RUNS * N, 1.0)


@pytest.mark.extended
@pytest.mark.parametrize("noise", NOISES)
def test_false_alarm_rate_does_not_exceed_the_nominal_rate_in_four_kinds_of_noise(
    noise: str,
) -> None:
    campaigns, false = 120, 0
    for seed in range(campaigns):
        directions = _directions(NOISES[noise](np.random.default_rng(seed)))
        gains = [float(np.sum((d.basis.T @ d.innovations) ** 2 * d.shares)) for d in directions]
        false += bool(max(gains) > calibrated(_level(0.05), directions).critical)
    assert false <= stats.binom.ppf(0.999, campaigns, 0.05)


def test_calibrated_level_in_white_noise_is_at_most_a_fifth_below_bonferroni() -> None:
    found = calibrated(_level(), _directions(_white(np.random.default_rng(0))))
    assert 0.8 * 0.01 / TESTED < found.chance <= 0.01 / TESTED
    assert found.blocks == RUNS * N * STEP_S


def test_calibrated_level_rises_if_the_noise_is_larger_where_an_effect_acts() -> None:
    noise = _white(np.random.default_rng(0)) * (0.1 + 3.0 * _shapes()[-1])
    directions = [replace(d, inflation=np.ones(1), share=1.0) for d in _directions(noise)]
    assert 3.0 < calibrated(_level(), directions).critical / _level().critical < 30.0


def test_residual_that_a_candidate_explains_does_not_raise_the_level() -> None:
    noise = _white(np.random.default_rng(1))
    explained = noise + 5.0 * _shapes()[-1] + 3.0 * _shapes()[2]
    assert calibrated(_level(), _directions(explained)).critical == pytest.approx(
        calibrated(_level(), _directions(noise)).critical, rel=0.02
    )


def test_autocorrelation_by_effects_that_are_missing_as_well_does_not_reduce_the_share() -> None:
    shapes, slow = _shapes(), _slow(np.random.default_rng(2))
    white = _white(np.random.default_rng(1))
    for noise, least, most in ((white, 0.9, 1.0), (slow, 0.01, 0.1)):
        residual_n = noise + 30.0 * np.std(noise) * (shapes[0] + shapes[3])
        residual_n -= LAW @ np.linalg.lstsq(LAW, residual_n)[0]
        directions = _directions(residual_n, shapes)
        assert max(d.share for d in directions) < 0.1
        residual = RichestResidual.of(directions, SAMPLES)
        assert residual is not None
        assert least < residual.share <= most
        assert residual.share == pytest.approx(
            independent_share(np.split(noise, RUNS), SAMPLES.steps_s), abs=0.05
        )


def _one_direction(direction: Array, noise: Array, blocks: list[int]) -> Directions:
    return Directions(direction[:, None], noise, np.ones(1), np.array(blocks), NO_ENDS)


@pytest.mark.parametrize(("rate", "gain"), [(0.1, 16.0), (0.15, 4.0), (0.6, 4.0), (0.7, 0.0)])
def test_calibrated_level_is_the_false_alarm_quantile_of_scores_with_random_signs(
    rate: float, gain: float
) -> None:
    """Signed sums of four unit scores are 4 in 1/8 of the draws, 2 in 1/2, and 0 otherwise."""
    noise = np.repeat([1.0, 1.0, -1.0, -1.0], 4)
    level = Level(false_alarm_rate=rate, candidates=1, chance=1.0)
    directions = [_one_direction(np.full(16, 0.25), noise, [0, 4, 8, 12])]
    found = calibrated(level, directions)
    assert found.chance == pytest.approx(stats.chi2.sf(gain, 1), rel=1e-3)
    assert found.blocks == 4
    # A stricter level is not changed.
    assert calibrated(replace(level, chance=1e-80), directions).chance == 1e-80


def test_candidate_with_two_parameters_has_chi_square_of_two_degrees() -> None:
    basis = np.zeros((8, 2))
    basis[:4, 0] = basis[4:, 1] = 0.5
    noise = np.tile([1.0, 1.0, -1.0, -1.0], 2)
    one = Directions(basis, noise, np.ones(2), np.array([0, 2, 4, 6]), NO_ENDS)
    found = calibrated(Level(false_alarm_rate=0.2, candidates=1, chance=1.0), [one])
    assert found.chance == pytest.approx(stats.chi2.sf(8.0, 2), rel=1e-3)


def test_candidate_without_a_direction_keeps_its_share_of_the_significance_level() -> None:
    one = _one_direction(np.full(4, 0.5), np.array([1.0, 1.0, -1.0, -1.0]), [0, 2])
    level = Level(false_alarm_rate=0.01, candidates=2, chance=1.0)
    chance = stats.chi2.sf(4.0, 1)
    for rate, share in ((0.01, 0.5), (0.06, 1.0)):
        found = calibrated(replace(level, false_alarm_rate=rate), [one])
        assert found.chance == pytest.approx(share * chance, rel=1e-3)
    assert calibrated(level, []) == level


def _decoy(directions: Array, noise: Array, ends: list[int], counted: float = 1.0) -> Directions:
    inflation, blocks = np.full(directions.shape[1], 1.0 / counted), np.arange(0, len(noise), 50)
    ways = np.linalg.qr(directions)[0]
    return Directions(ways, noise, inflation, blocks, np.array(ends, np.intp))


@pytest.mark.parametrize("k", [1, 3])
def test_gains_of_decoys_in_white_noise_follow_chi_square(k: int) -> None:
    random = np.random.default_rng(k)
    decoys = [
        _decoy(random.standard_normal((4000, k)), random.standard_normal(4000), [1500])
        for _ in range(20)
    ]
    gains = np.concatenate([decoy_gains([decoy])[0] for decoy in decoys])
    assert np.mean(gains) == pytest.approx(k, rel=0.1)
    assert np.mean(gains > stats.chi2.isf(0.05, k)) == pytest.approx(0.05, abs=0.015)


@pytest.mark.parametrize("ends", [[300], [0, 300], [300, 300]])
def test_decoy_is_a_candidate_shifted_cyclically_within_each_run(ends: list[int]) -> None:
    """One of the runs may have no samples."""
    random = np.random.default_rng(4)
    noise = random.standard_normal(700)
    one = _decoy(random.standard_normal((700, 1)), noise, ends, counted=0.5)
    scores = np.zeros(DECOY_DRAWS)
    draws = np.random.default_rng(DECOY_DRAWS)
    for way, e in zip(np.split(one.basis[:, 0], ends), np.split(noise, ends), strict=True):
        if len(e):
            by_shift = np.array([np.roll(way, shift) @ e for shift in range(len(e))])
            scores += by_shift[draws.integers(0, len(e), DECOY_DRAWS)]
    np.testing.assert_allclose(decoy_gains([one])[0], 0.5 * scores**2, rtol=1e-9)


def test_decoys_are_named_only_if_their_gain_exceeds_the_threshold() -> None:
    """Every shift of a constant has a score of 16 in a residual of 2: a gain of 256."""
    one = _one_direction(np.full(64, 0.125), np.full(64, 2.0), [0])
    for threshold, named in ((255.9, DECOY_DRAWS), (256.1, 0)):
        level = Level(0.01, 1, 1.0, min_gain=threshold)
        found = with_decoys(level, [one], 100)
        assert (found.decoys, found.decoys_named) == (DECOY_DRAWS, named)
    assert with_decoys(Level(0.01, 1, 1.0), [], 100) == Level(0.01, 1, 1.0)


def test_upper_limit_of_a_false_alarm_rate_is_that_of_clopper_and_pearson() -> None:
    assert rate_below(0, 200) == pytest.approx(1.0 - 0.05 ** (1.0 / 200.0))
    assert stats.binom.cdf(3, 200, rate_below(3, 200)) == pytest.approx(0.05)
    assert rate_below(200, 200) == 1.0


def test_diagnosis_reports_level_and_decoys_of_its_significance_tests() -> None:
    found, level = linear_diagnosis("nothing"), linear_diagnosis("nothing").level
    assert (level.candidates, level.false_alarm_rate) == (len(found.steps[0].trials), 0.01)
    assert level.chance <= 0.01 / level.candidates
    assert level.blocks > 0
    assert (level.decoys, level.decoys_named) == (DECOY_DRAWS, 0)
    assert found.to_dict()["level"]["critical"] == level.critical


def diagnosis_with(hidden: str, **changes: Any) -> Diagnosis:
    """The diagnosis of a linear campaign under a changed policy."""
    return diagnose(Rig(), linear_runs(hidden), law="coulomb", policy=DEFAULT.with_values(changes))


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("selection.weak_evidence", [np.nan]),
        ("false_alarm_rate", [np.nan, 0.0, 1.0]),
        ("selection.min_weight", [0.0, 0.5]),
        ("unknown", [1.0]),
    ],
)
def test_policy_value_outside_its_range_is_rejected(name: str, values: list[float]) -> None:
    for value in values:
        with pytest.raises(InputError, match=name):
            DEFAULT.with_values({name: value})


@pytest.mark.parametrize("weight", [0.018, 0.1, 0.4])
def test_evidence_margin_of_a_tie_is_twice_the_log_odds_of_the_weight(weight: float) -> None:
    assert Selection(min_weight=weight).tie == pytest.approx(2.0 * np.log((1.0 - weight) / weight))


def _margins() -> list[Any]:
    """Policy values at which the gain of the weak mass equals its threshold."""
    book = Textbook(linear_runs("weak mass"))
    gain, rms = book.gain(), book.rms(2)
    at_chance = stats.chi2.isf(0.01 / CANDIDATES, 1)
    rate = CANDIDATES * stats.chi2.sf(gain - 22.0, 1)
    share = np.sqrt(gain / book.samples)
    extended = pytest.mark.extended
    return [
        pytest.param("artefact_margin", gain - at_chance, id="artefact margin"),
        pytest.param("false_alarm_rate", rate, id="false-alarm rate", marks=extended),
        pytest.param("min_effect_share", share, id="minimum effect size", marks=extended),
        pytest.param("min_effect", rms * share, id="minimum effect in N", marks=extended),
    ]


@pytest.mark.parametrize(("name", "at_gain"), _margins())
def test_effect_is_named_only_if_its_gain_exceeds_the_threshold(name: str, at_gain: float) -> None:
    factor = {"false_alarm_rate": 0.1, "artefact_margin": 1.15}.get(name, 1.1)
    lenient = diagnosis_with("weak mass", **{name: at_gain / factor})
    strict = diagnosis_with("weak mass", **{name: at_gain * factor})
    assert (lenient.verdict, lenient.effects) == ("missing", ("inertia",))
    assert (strict.verdict, strict.effects) == ("adequate", ())
    assert getattr(strict.policy, name) == strict.to_dict()["policy"][name]


def test_candidate_beyond_the_effect_limit_is_reported_as_residual_structure() -> None:
    found = diagnosis_with("offset and drag", **{"selection.max_effects": 1})
    assert (found.verdict, len(found.model.effects)) == ("unexplained", 1)
    assert "effects" in [remainder.axis for remainder in found.residual_structure]


@pytest.mark.extended
def test_alternative_below_the_minimum_weight_of_the_policy_is_not_reported() -> None:
    tied = linear_diagnosis("lag")
    (effect,) = tied.effects
    (other,) = tied.alternatives[effect]
    weight = min(tied.weights[effect][other], tied.weights[effect][effect])
    assert DEFAULT.selection.min_weight < weight < 0.49
    dropped = diagnosis_with("lag", **{"selection.min_weight": 1.02 * weight})
    assert (dropped.verdict, len(dropped.effects)) == ("missing", 1)
    assert dropped.alternatives == {dropped.effects[0]: ()}


def test_candidate_with_fewer_samples_keeps_its_share_of_the_significance_level() -> None:
    one = _one_direction(np.full(4, 0.5), np.array([1.0, 1.0, -1.0, -1.0]), [0, 2])
    fewer = _one_direction(np.full(3, 0.577), np.array([1.0, 1.0, -1.0]), [0, 2])
    level = Level(false_alarm_rate=0.01, candidates=3, chance=1.0)
    expected = calibrated(level, [one, one])
    assert calibrated(level, [one, fewer, one]).chance == pytest.approx(expected.chance)


def test_share_of_independent_samples_ignores_runs_without_included_samples() -> None:
    noise = np.random.default_rng(8).normal(size=400)
    parts = [noise[:250], noise[250:]]
    assert independent_share([parts[0], noise[:0], parts[1]], [0.01] * 3) == independent_share(
        parts, [0.01] * 2
    )
