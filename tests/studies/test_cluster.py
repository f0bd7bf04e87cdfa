"""Batches on a cluster of Dask have the numbers of this process."""

import re
import subprocess
import sys

CLUSTER = """
import os
from distributed import LocalCluster
import metafem as mf
from metafem.studies.sampling import batches
from tests.core.studies.test_batches import Execution, study

def refused(execution):
    try:
        study(execution)
    except mf.InvalidInput as error:
        print(error)

if __name__ == "__main__":
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        execution = Execution(scheduler=cluster.scheduler_address)
        print(study(execution).identical(study()))
        here, own_version = os.getpid(), batches.own_version
        batches.own_version = lambda: "another" if os.getpid() == here else "theirs"
        refused(execution)
        cluster.scale(0)
        while cluster.scheduler.workers:
            pass
        refused(execution)
"""


def test_a_cluster_gives_the_same_numbers():
    command = [sys.executable, "-c", CLUSTER]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    same, other, none = done.stdout.splitlines()
    assert same == "True"
    assert re.search("theirs.*another", other)
    assert re.search("scheduler.*tcp://.*no workers", none)
