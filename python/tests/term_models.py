"""Fitted models for tests of the terms of the observation model."""

from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.terms.proposal import Model
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution


def model_of(
    problem: Problem,
    solution: Solution,
    *,
    reference: Solution | None = None,
    price_of_effect: float = 0.0,
) -> Model:
    """A fitted model, compared with itself or with a fit that has more effects."""
    if reference is None:
        return Model(problem, solution, problem, solution, DEFAULT, price_of_effect)
    effects = reference.effects
    richer = Problem(problem.campaign, problem.law, problem.clock, effects, problem.fixed)
    return Model(problem, solution, richer, reference, DEFAULT, price_of_effect)
