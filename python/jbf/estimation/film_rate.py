"""Check of whether a film is slow enough to be followed at the sampling rate of the records.

A film that reaches equilibrium long before the next sample is a function of speed, and the records
do not determine its rate. Integrating it takes hundreds of steps between samples, in each of the
thousands of predictions of a search. Times given in milliseconds have this symptom.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from jbf import _core
from jbf.errors import InputError
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.models.catalogue import find_law
from jbf.models.vocabulary import Clock


def check_film(
    campaign: Campaign, law: str, clock: Clock, seed: Mapping[str, float] | None = None
) -> None:
    """Raise an InputError if the film of a law is too fast for these records at every start.

    Parameters
    ----------
    seed
        Starting values by name.
    """
    if not find_law(law).has_film:
        return
    problem = Problem(campaign, law, clock, ())
    known = {name: value for name, value in (seed or {}).items() if name in problem.names}
    rate = min(
        problem.chain.film_rate_1_s(start, campaign.motions) for start in problem.starts(known)
    )
    followed = min(rate, _core.FASTEST_FILM_1_S)
    seconds = math.fsum(p.run.duration_s for p in campaign.prepared)
    steps = followed * seconds
    samples = sum(len(p.friction) for p in campaign.prepared)
    settings = campaign.settings.film
    if steps <= max(settings.max_steps * samples, settings.any_steps):
        return
    every = float(np.median([p.step_s for p in campaign.prepared]))
    first = campaign.prepared[0].run
    raise InputError(
        file=first.path or first.name,
        column="time_s",
        problem=f"the film of the law {law} cannot be identified from these runs: on this rig it "
        f"answers within {1.0 / rate:.1g} s, and there is a sample every {every:.2g} s",
        mend="check that times are in seconds, and the rig's bearing and load, or take a law "
        "without a film, such as stribeck",
    )
