"""Tables of Cohn (1998) recomputed under other assumptions about unstated details.

Each assumption changes one element of the tables; only the affected columns are recomputed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from jbf.control.bench import thesis_model
from jbf.control.schemes import LISTED_VOLTS, Coulomb, Learning
from jbf.control.task import TASKS
from jbf.control.thesis_tables import Tables, fit_friction, standard_schemes, tables
from jbf.models.model import Model

Report = Callable[[str, int, int], None]

_SEEDS = 3
_COUNT = 9


def assumptions(base: Tables, report: Report | None = None) -> Iterator[tuple[str, Tables]]:
    """Yield name and tables of each alternative assumption, the base case first."""
    done = 0

    def case(name: str, changed: Tables | None = None) -> tuple[str, Tables]:
        """Report progress, and return the name and the complete tables of a case."""
        nonlocal done
        done += 1
        if report is not None:
            report("other assumptions", done, _COUNT)
        return name, base if changed is None else base.replaced(changed)

    def learning(scheme: Learning) -> Tables:
        schemes = {"learning": scheme}
        return tables(base.model, base.bench, schemes=schemes, seeds=_SEEDS)

    def elastic(place: str, scheme: Learning) -> Tables:
        model = _with_elastic(base.model, place)
        schemes = {**standard_schemes(model), "learning": scheme}
        del schemes["observed"]
        return tables(model, base.bench, schemes=schemes, seeds=_SEEDS)

    published = Learning(volts=LISTED_VOLTS)
    yield case("scale of the rig, elastic belt")
    yield case("scale 3.5 V", learning(Learning(volts=3.5)))
    yield case("scale 25.5 V, as listed", learning(published))
    yield case("compensator's film on the journal clock", learning(Learning(clock="journal")))
    yield case("k_F 0.02", tables(base.model, base.bench, schemes={"coulomb": Coulomb(gain=0.02)}))
    yield case("elastic contact, no belt", elastic("contact", Learning()))
    yield case("elastic contact, scale 25.5 V", elastic("contact", published))
    yield case("no elasticity", elastic("nothing", Learning()))
    counted = {name: replace(task, skip_s=0.0) for name, task in TASKS.items()}
    schemes = standard_schemes(base.model)
    del schemes["observed"]
    yield case(
        "with the first seconds",
        tables(base.model, base.bench, schemes=schemes, tasks=counted, seeds=_SEEDS),
    )


def on_the_journal_clock(report: Report | None = None) -> float:
    """Largest deviation of the ratios to the thesis for the film time constant `journal`.

    Only the cells without compensation are evaluated. The time constant of Cohn (1998) is `thesis`.
    """
    model, bench = fit_friction(clock="journal", report=report)
    schemes = {"none": standard_schemes(model)["none"]}
    cells = tables(model, bench, schemes=schemes, seeds=_SEEDS).column("none")
    return max(abs(c.ratio - 1.0) for c in cells if c.ratio is not None)


def _with_elastic(model: Model, place: str) -> Model:
    """Model with the compliance `place` of `ELASTIC` in place of its own."""
    values = {n: p.value for n, p in model.parameters.items()}
    u_tr, k0, gamma = (values[n] for n in ("U_tr_m_s", "K0", "gamma"))
    return thesis_model(elastic=place, U_tr_m_s=u_tr, K0=k0, gamma=gamma)
