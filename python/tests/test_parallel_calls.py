"""Calls from several threads at once give the bits of calls one after the other."""

from __future__ import annotations

import json
import subprocess
import sys
import sysconfig
from concurrent.futures import ThreadPoolExecutor

import jbf
import pytest
from by_hand import coulomb, four_runs

THREADS = 4


def _said(found: jbf.Diagnosis) -> str:
    return json.dumps({**found.to_dict(), "elapsed_s": None}, sort_keys=True)


@pytest.fixture(scope="module")
def campaigns() -> list[list[jbf.Run]]:
    return [four_runs(coulomb, noise_n=0.1, seed=seed) for seed in range(THREADS)]


def test_diagnoses_side_by_side(campaigns: list[list[jbf.Run]]) -> None:
    def work(runs: list[jbf.Run]) -> str:
        return _said(jbf.diagnose(jbf.Rig(), runs, law="stribeck"))

    one_by_one = [work(runs) for runs in campaigns[:2]]
    assert len(set(one_by_one)) == 2
    with ThreadPoolExecutor(THREADS) as pool:
        assert list(pool.map(work, campaigns[:2])) == one_by_one


def test_one_model_predicts_on_many_threads(campaigns: list[list[jbf.Run]]) -> None:
    model = jbf.fit(jbf.Rig(), campaigns[0], law="stribeck").model
    runs = [run for campaign in campaigns for run in campaign] * 4
    with ThreadPoolExecutor(THREADS) as pool:
        found = list(pool.map(model.predict, runs))
    assert [f.tobytes() for f in found] == [model.predict(run).tobytes() for run in runs]


@pytest.mark.skipif(
    not sysconfig.get_config_var("Py_GIL_DISABLED"), reason="this interpreter has a lock"
)
def test_the_extension_brings_no_lock_back() -> None:
    # In a process of its own: some other library of the tests may ask for one.
    asked = "import sys, jbf; jbf.effects(); print(sys._is_gil_enabled())"
    told = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "False"
    assert "lock" not in told.stderr
