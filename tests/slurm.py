#!/usr/bin/env python3
"""A sweep as a job array of Slurm, on a controller and a node of its own on this machine (Debian: slurm-wlm).

    python3 tests/slurm.py --program ./almesh

Submits the script of `almesh sweep DECK --slurm`, kills the job in the midst, submits it again, gathers the runs, and
checks that none is lost or done twice and that the results are those of runs by hand. Needs root, as Slurm's daemons
do. Exit code: 0 where all holds, 1 where not, 77 where Slurm is not installed.
"""
import argparse
import csv
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CONFIGURATION = """ClusterName=almesh
SlurmctldHost={host}
SlurmUser=root
SlurmctldPort=16817
SlurmdPort=16818
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
KillWait=2
NodeName={host} CPUs={cpus} State=UNKNOWN
PartitionName=here Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""
DECK = """mesh = {root}/inputs/meshes/circle.msh
output = {folder}/results
boundary inner = translate 8 0
boundary outer = fixed
sweep refine = 1, 2
sweep mu0 = 10, 100, 1000
sweep omega_star = 1e-6, 1e-7
"""


class Cluster:
    """munged, slurmctld and slurmd with their files in `folder`, until the end of the `with`."""

    def __init__(self, folder):
        self.folder = folder
        self.daemons = []

    def __enter__(self):
        host = subprocess.check_output(["hostname", "-s"], text=True).strip()
        for name in "state", "spool":
            (self.folder / name).mkdir()
        text = CONFIGURATION.format(host=host, folder=self.folder, cpus=os.cpu_count())
        (self.folder / "slurm.conf").write_text(text)
        os.environ["SLURM_CONF"] = str(self.folder / "slurm.conf")
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        self.start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={self.folder}/munge.socket",
                   *(f"--{kind}-file={self.folder}/munged.{kind}" for kind in ("pid", "seed", "log")))
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D")
        try:
            wait_until(lambda: "idle" in run("sinfo", "-h", "-o", "%t", check=False), "no node becomes idle", 20)
        except RuntimeError:
            self.__exit__()
            raise
        return self

    def start(self, *command):
        self.daemons.append(subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
        time.sleep(0.5)

    def __exit__(self, *_):
        for daemon in reversed(self.daemons):
            daemon.terminate()
            daemon.wait()


def run(*command, check=True):
    done = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if check and done.returncode:
        raise RuntimeError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout


def submit(script):
    job = run("sbatch", "--parsable", str(script)).strip()
    print(f"submitted {script.name}: job {job}", flush=True)
    return job


def wait_until(holds, otherwise, seconds=600):
    end = time.monotonic() + seconds
    while not holds():
        if time.monotonic() > end:
            log = Path(os.environ["SLURM_CONF"]).parent / "slurmctld.log"
            raise RuntimeError(f"{otherwise} in {seconds} s: " + (log.read_text()[-2000:] if log.exists() else ""))
        time.sleep(0.05)


def wait_for(job):
    wait_until(lambda: not run("squeue", "-h", "-j", job, check=False).strip().startswith(job),
               f"job {job} does not end")


def rows_in(results):
    return {row: row.stat().st_mtime_ns for row in results.glob("*/sweep.row")}


def check_array(program, folder):
    deck, results = folder / "circle.deck", folder / "results"
    deck.write_text(DECK.format(root=ROOT, folder=folder))
    print(run(program, "sweep", str(deck), "--slurm"), end="")
    job = submit(results / "sweep.sh")
    wait_until(lambda: rows_in(results), "no task of the job array ends")
    run("scancel", "--signal=KILL", job)
    run("scancel", job)
    wait_for(job)
    before = rows_in(results)
    print(f"killed with {len(before)} of 12 runs done", flush=True)
    wait_for(submit(results / "sweep.sh"))
    after = rows_in(results)
    print(run(program, "sweep", str(deck), "--collect"), end="")
    table = list(csv.DictReader(open(results / "sweep.csv")))
    by_hand = folder / "by-hand"
    run(program, str(deck), "refine=2", "mu0=1000", "omega_star=1e-7", "threads=1", f"output={by_hand}")
    final = results / "refine=2,mu0=1000,omega_star=1e-7" / "final.msh"
    return {"the kill was in the midst": 0 < len(before) < 12,
            "no run is lost": len(after) == 12 and len(table) == 12,
            "no run is done twice": all(after[row] == time for row, time in before.items()),
            "all are certified": all(row["exit_code"] == "0" for row in table),
            "the bits are those of the run by hand": final.read_bytes() == (by_hand / "final.msh").read_bytes()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--program", default="./almesh")
    program = str(Path(parser.parse_args().program).resolve())
    missing = [name for name in ("munged", "slurmctld", "slurmd", "sbatch") if not shutil.which(name)]
    if missing or os.geteuid() != 0:
        reason = f"there is no {missing[0]}" if missing else "Slurm's daemons want root"
        print(f"not run: {reason}; Debian: apt install slurm-wlm")
        return 77
    with tempfile.TemporaryDirectory() as name, Cluster(Path(name)):
        held = check_array(program, Path(name))
    for what, holds in held.items():
        print(f"{what}: {'yes' if holds else 'NO'}")
    return 0 if all(held.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
