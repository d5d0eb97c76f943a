"""Significant effects below the minimum effect size."""

import pytest
from jbf import Diagnosis, Policy, Rig, diagnose
from linear_campaigns import reversing_runs

NOISE_N = 0.1


def diagnosed(offset_n: float) -> Diagnosis:
    """Six runs with an offset; the minimum effect size is 12 % of the noise."""
    runs = reversing_runs(
        lambda i, t, f, random: f + offset_n + NOISE_N * random.standard_normal(len(t)),
    )
    return diagnose(Rig(), runs, law="coulomb", policy=Policy(min_effect_share=0.12))


@pytest.mark.parametrize(
    ("share", "effects", "negligible"),
    [
        (0.0, (), ()),
        (0.1, (), ("sensor_offset",)),
        (0.5, ("sensor_offset",), ()),
    ],
)
def test_effect_below_the_smallest_size_is_listed_and_not_named(
    share: float, effects: tuple[str, ...], negligible: tuple[str, ...]
) -> None:
    found = diagnosed(share * NOISE_N)
    assert found.effects == effects
    assert set(negligible) <= set(found.negligible)
    assert share > 0.0 or found.negligible == ()
    assert not set(effects) & set(found.negligible)
    assert ("below the minimum effect size" in found.summary(full=True)) == bool(found.negligible)
    assert found.to_dict()["negligible"] == list(found.negligible)
