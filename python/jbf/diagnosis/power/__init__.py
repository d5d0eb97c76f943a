"""Power of runs: the strength from which an effect is detectable and distinguishable.

An effect of given strength changes the friction. The parameters of the law can reproduce a part of
this change. The sum of squares of the other part, in units of the noise variance, is the
non-centrality of the likelihood ratio (Wald 1943). The power of the test is the probability that
the likelihood ratio exceeds the threshold. The part that another effect can also reproduce does not
help to distinguish the two.

The change is computed at strengths of ratio 2^(1/3) and scaled between them, not extrapolated from
the null; the rest of the model is linearised.

Modules: `strength` computes the change of the friction by an effect as a function of its strength.
`distinction` compares this change with those of other effects. `detection_limits` computes the
detectable strengths of all effects in recorded runs, and `planned_runs` in planned runs.
"""

from jbf.diagnosis.power.detection_limits import Power, power

__all__ = ["Power", "power"]
