"""Concurrent calls from several threads give the same bits as sequential calls."""

import json
import subprocess
import sys
import sysconfig
from concurrent.futures import ThreadPoolExecutor

import jbf
import pytest
from by_hand import coulomb, four_runs
from jbf.threads import one_blas_thread
from threadpoolctl import threadpool_info, threadpool_limits  # type: ignore[import-untyped]

THREADS = 4
Campaigns = list[list[jbf.Run]]


def as_text(diagnosis: jbf.Diagnosis) -> str:
    return json.dumps({**diagnosis.to_dict(), "elapsed_s": None}, sort_keys=True)


@pytest.fixture(scope="module")
def campaigns() -> Campaigns:
    return [four_runs(coulomb, noise_rms=0.1, seed=seed) for seed in range(THREADS)]


@pytest.mark.extended
def test_concurrent_diagnoses_equal_sequential_diagnoses(campaigns: Campaigns) -> None:
    def work(runs: list[jbf.Run]) -> str:
        return as_text(jbf.diagnose(jbf.Rig(), runs, law="stribeck"))

    sequential = [work(runs) for runs in campaigns[:2]]
    assert len(set(sequential)) == 2
    with ThreadPoolExecutor(THREADS) as pool:
        assert list(pool.map(work, campaigns[:2])) == sequential


@pytest.mark.extended
def test_concurrent_fits_and_predictions_equal_sequential_ones(campaigns: Campaigns) -> None:
    def fitted(runs: list[jbf.Run]) -> jbf.Model:
        return jbf.fit(jbf.Rig(), runs, law="coulomb").model

    with ThreadPoolExecutor(THREADS) as pool:
        models = list(pool.map(fitted, campaigns[:2]))
    assert models == [fitted(runs) for runs in campaigns[:2]]
    model = models[0]
    runs = [run for campaign in campaigns for run in campaign]
    with ThreadPoolExecutor(THREADS) as pool:
        result = list(pool.map(model.predict, runs))
    assert [f.tobytes() for f in result] == [model.predict(run).tobytes() for run in runs]


@pytest.mark.skipif(not sysconfig.get_config_var("Py_GIL_DISABLED"), reason="the GIL exists")
def test_extension_does_not_enable_the_gil_of_a_free_threaded_interpreter() -> None:
    # Use a separate process, because another library of the tests may enable the lock.
    code = "import sys, jbf; jbf.effects(); print(sys._is_gil_enabled())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
    assert "lock" not in done.stderr


def blas_threads() -> set[int]:
    return {lib["num_threads"] for lib in threadpool_info() if lib["user_api"] == "blas"}


def test_blas_threads_are_one_in_decorated_calls_and_restored_after_an_error() -> None:
    @one_blas_thread
    def work(depth: int) -> set[int]:
        if depth:
            assert work(depth - 1) <= {1}
        if depth == 2:
            raise RuntimeError
        return blas_threads()

    with threadpool_limits(2, "blas"):
        before = blas_threads()
        assert work(1) <= {1}
        with pytest.raises(RuntimeError):
            work(2)
        assert blas_threads() == before
