"""Submits the parts of a render to HyperQueue, submits again what is missing, and merges.

Used by hyperqueue.sh. HQ_SERVER_DIR names the folder of a running server; without it, a server and WORKERS workers of
one core each are started in this process. Parts whose films have arrived are not rendered again, so this may be killed
and started anew.
"""

import os
import subprocess
import sys
from pathlib import Path

from hyperqueue import Client, Job, LocalCluster
from hyperqueue.cluster import WorkerConfig

HERE = Path(__file__).resolve().parent
ROUNDS = 3


def missing(folder, parts, passes):
    """Numbers of the parts that have passes, and no film yet."""

    def has_passes(n):
        return n * passes // parts < (n + 1) * passes // parts

    return [n for n in range(parts) if has_passes(n) and not (folder / f"{n}.film").exists()]


def submit(client, folder, parts, passes, flags):
    """Has the missing parts rendered, and tells which films arrive."""
    todo = missing(folder, parts, passes)
    job = Job(max_fails=None, default_workdir=os.getcwd(), name=folder.name)
    for n in todo:
        command = [str(HERE / "part.sh"), str(folder), str(n), str(parts), str(passes), *flags]
        log = str(folder / f"{n}.log")
        job.program(command, name=f"part {n}", stdout=log, stderr=log, env=dict(os.environ), crash_limit=5)
    submitted = client.submit(job)

    arrived = -1

    def progress(_jobs):
        nonlocal arrived
        now = parts - len(missing(folder, parts, passes))
        if now != arrived:
            arrived = now
            print(f"{arrived} of {parts} parts are there", flush=True)

    client.connection.wait_for_jobs((submitted.id,), progress)


def main(folder, parts, passes, output, *flags):
    folder, parts, passes = Path(folder).resolve(), int(parts), int(passes)
    folder.mkdir(parents=True, exist_ok=True)
    server, cluster = os.environ.get("HQ_SERVER_DIR"), None
    if server is None:
        cluster = LocalCluster()
        for _ in range(int(os.environ.get("WORKERS", "2"))):
            cluster.start_worker(WorkerConfig(cores=1))
        client = cluster.client()
    else:
        client = Client(server)
    for _ in range(ROUNDS):
        if missing(folder, parts, passes):
            submit(client, folder, parts, passes, flags)
    if cluster is not None:
        cluster.stop()
    lost = missing(folder, parts, passes)
    if lost:
        print(f"missing are {len(lost)} parts; see {folder}/{lost[0]}.log", file=sys.stderr)
    sys.exit(subprocess.run([str(HERE / "merge.sh"), str(folder), str(parts), output]).returncode)


if __name__ == "__main__":
    main(*sys.argv[1:])
