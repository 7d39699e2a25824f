"""A sweep on a real Dask cluster of two worker processes; prints the number of workers, then the table as CSV.

A program of its own: a cluster started inside a test runner's worker process does not end with it.
"""

import sys

import numpy as np
from dask.distributed import Client, LocalCluster

from fuzzynav import batch


def experiment(seed: int) -> dict[str, object]:
    rng = np.random.default_rng(seed)
    return {"success": bool(rng.random() < 0.7), "length": float(rng.normal(10.0, 1.0)), "seed": seed}


def main() -> None:
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, host="127.0.0.1")
    with cluster, Client(cluster) as client:
        table = batch.run(experiment, range(37), executor=client.get_executor(), progress=False)
        print(len(client.scheduler_info()["workers"]))
        table.to_csv(sys.stdout, index=False)


if __name__ == "__main__":
    main()
