"""Batches in processes of Dask have the numbers of this process."""

import subprocess
import sys

CLUSTER = """
import joblib
from distributed import Client, LocalCluster
from tests.core.studies.test_draws import study

if __name__ == "__main__":
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster):
        with joblib.parallel_config("dask"):
            found = study()
    assert found.identical(study())
"""


def test_a_cluster_gives_the_same_numbers():
    subprocess.run([sys.executable, "-c", CLUSTER], timeout=120, check=True)
