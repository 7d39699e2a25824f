"""The command on a real Dask cluster of two worker processes; prints the number of workers.

A program of its own: a cluster started inside a test runner's worker process does not end with it.
"""

import sys

from dask.distributed import Client, LocalCluster

from fuzzynav.benchmark.__main__ import main


def run(arguments: list[str]) -> int:
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, host="127.0.0.1")
    with cluster, Client(cluster) as client:
        done = main([*arguments, "--dask", cluster.scheduler_address])
        print(len(client.scheduler_info()["workers"]), "workers")
        return done


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
