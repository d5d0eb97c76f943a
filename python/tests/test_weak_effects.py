"""An effect far weaker than where a search starts: from where its score leads it is found."""

from __future__ import annotations

from dataclasses import replace

from jbf import Model, effects, fit
from jbf.diagnosis.candidates import Candidates
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import likelihood_gain
from jbf.estimation.wild_bootstrap import recorded_by
from rigruns import simulated


def test_a_weak_effect_is_found_from_where_its_score_leads() -> None:
    # What rests add, less than a hundredth of the load: from the catalogue's ten times as much a
    # search ends beside it.
    rig, runs, _ = simulated(9862, campaign="short", coloured=False)
    bare = fit(rig, runs).model
    usual = {p.name: p.starts[0] for p in effects()["dwell_stiction"].parameters}
    own = {f"dwell_stiction.{name}": value for name, value in usual.items()}
    own["dwell_stiction.a"] = 0.008
    strong = Model(rig, bare.law, ["dwell_stiction"], {**bare.parameters, **own})
    changed = zip(strong.predict_many(runs), bare.predict_many(runs), strict=True)
    again = [
        replace(run, friction_n=run.friction_n + there - here)
        for run, (there, here) in zip(recorded_by(bare, runs, (), 3), changed, strict=True)
    ]
    every = Candidates(Campaign.prepare(rig, again), strong.law, strong.clock)
    base = every.converge([])
    promised = every.score_test(["dwell_stiction"], base)
    found = every.rank(["dwell_stiction"], base)
    assert likelihood_gain(found, base) > 0.95 * promised > 30.0
