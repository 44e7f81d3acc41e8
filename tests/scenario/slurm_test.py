#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that Slurm places and scales a farm's nodes: a cluster of two hosts, both this machine, runs the shipped job
script.

Run: slurm_test.py SOURCE_ROOT BUILD_FOLDER. It ends with 77 (skipped) where Debian's slurm-wlm is not installed, or
with 1 under CYCLORAMA_REQUIRE_SLURM=1.
"""
import getpass
import json
import os
import pathlib
import random
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

KILL_WAIT_S = 30
SLURM_CONF = """
ClusterName=cyclorama-test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SchedulerParameters=batch_sched_delay=0,sched_interval=1
ReturnToService=2
KillWait={kill_wait}
NodeName=host[0-1] NodeHostname={host} NodeAddr=127.0.0.1 Port=[{first}-{last}] CPUs=1 RealMemory=100
PartitionName=all Nodes=ALL Default=YES State=UP
"""


class Machine:
    """The test's processes, each with its log; they are ended in reverse order."""

    def __init__(self, folder):
        self.folder, self.running = pathlib.Path(folder), []

    def start(self, name, *command, **options):
        with open(self.folder / f"{name}.log", "w") as log:
            self.running.append(subprocess.Popen(command, stdout=log, stderr=log, **options))

    def stop(self):
        for process in reversed(self.running):
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def wait(what, is_so, seconds=60):
    until = time.monotonic() + seconds
    while not is_so():
        if time.monotonic() > until:
            raise AssertionError(f"{what}: not within {seconds} s")
        time.sleep(0.2)


class Cluster:
    def __init__(self, machine):
        self.machine, folder = machine, machine.folder
        key = folder / "munge.key"
        key.write_bytes(secrets.token_bytes(64))
        key.chmod(0o600)
        (folder / "state").mkdir()
        port = random.randrange(20000, 31000)
        conf = folder / "slurm.conf"
        conf.write_text(SLURM_CONF.format(host=socket.gethostname(), user=getpass.getuser(), folder=folder, port=port,
                                          first=port + 1, last=port + 2, kill_wait=KILL_WAIT_S))
        self.env = {**os.environ, "SLURM_CONF": str(conf)}
        machine.start("munged", "munged", "--foreground", "--force", f"--key-file={key}", f"--socket={folder}/munge.socket",
                      f"--pid-file={folder}/munge.pid", f"--log-file={folder}/munge.log", f"--seed-file={folder}/munge.seed")
        wait("munge's socket", (folder / "munge.socket").exists, 20)
        machine.start("slurmctld", "slurmctld", "-D", "-c", "-f", conf)
        for i in range(2):
            machine.start(f"slurmd-{i}", "slurmd", "-D", "-N", f"host{i}", "-f", conf)
        wait("two idle hosts", lambda: self.ask("sinfo", "-h", "-t", "idle", "-o", "%D") == "2")

    def ask(self, *command):
        """Returns the command's output, or nothing if it fails, as it does until slurmctld is up."""
        return subprocess.run(command, env=self.env, cwd=self.machine.folder, capture_output=True, text=True).stdout.strip()

    def do(self, *command, **env):
        done = subprocess.run(command, env={**self.env, **env}, cwd=self.machine.folder, capture_output=True, text=True)
        assert done.returncode == 0, f"{command}: {done.stderr}"
        return done.stdout.strip()

    def elements(self, state):
        return sorted(self.ask("squeue", "-h", "-t", state, "-o", "%K", "-r").split())


class Farm:
    def __init__(self, machine, build):
        self.bin, self.folder = pathlib.Path(build) / "bin", machine.folder
        port = random.randrange(10000, 19000)
        museums, self.nodes_at, self.inspect = (f"[::1]:{port + i}" for i in range(3))
        scene = self.folder / "grotto"
        subprocess.run([self.bin / "cyclorama-grotto", "--triangles", "10000", "--out", scene], check=True, capture_output=True)
        machine.start("farm", self.bin / "cyclorama-farm", "--scene", f"visit={scene}", "--museums", museums,
                      "--nodes", self.nodes_at, "--inspect", self.inspect)

    def nodes(self):
        """Returns the number of ready nodes, or -1 if the coordinator does not answer."""
        status = self.folder / "status.json"
        status.unlink(missing_ok=True)
        subprocess.run([self.bin / "cyclorama", "status", "--watch", f"coordinator={self.inspect}", "--json", status], capture_output=True)
        try:
            return json.loads(status.read_text())["processes"][0]["gauges"]["nodes"]
        except (OSError, KeyError, IndexError):
            return -1


def check(root, build, machine):
    cluster, farm = Cluster(machine), Farm(machine, build)
    wait("the coordinator", lambda: farm.nodes() == 0)
    script = f"{root}/renderfarm/slurm/cyclorama-nodes.sbatch"
    job = cluster.do("sbatch", "--parsable", "--array=0-3%1", script, CYCLORAMA_COORDINATORS=farm.nodes_at,
                     CYCLORAMA_NODE=str(farm.bin / "cyclorama-node"))
    wait("the first node", lambda: farm.nodes() == 1)
    cluster.do("scontrol", "update", f"JobId={job}", "ArrayTaskThrottle=2")
    wait("a second node", lambda: farm.nodes() == 2)
    assert cluster.elements("R") == ["0", "1"], cluster.elements("R")
    coordinator_log = (machine.folder / "farm.log").read_text()
    assert coordinator_log.count("with 1 threads") == 2, "each node renders with the processors that Slurm gave it:\n" + coordinator_log

    begun = time.monotonic()
    cluster.do("scancel", f"{job}_0")
    wait("another element in its place", lambda: cluster.elements("R") == ["1", "2"] and farm.nodes() == 2)
    assert time.monotonic() - begun < KILL_WAIT_S, "the node did not stop by itself"
    cluster.do("scancel", job)
    wait("no node", lambda: farm.nodes() == 0)
    wait("no job", lambda: cluster.ask("squeue", "-h") == "")
    print("slurm: ok; 1 node, 2 by the throttle, one replaced, none after scancel")


def main(root, build):
    missing = [program for program in ("munged", "slurmctld", "slurmd", "sbatch") if not shutil.which(program)]
    if missing:
        print(f"slurm: skipped, {', '.join(missing)} not installed; scripts/install-packages test installs them")
        return 1 if os.environ.get("CYCLORAMA_REQUIRE_SLURM") == "1" else 77
    with tempfile.TemporaryDirectory() as folder:
        machine = Machine(folder)
        try:
            check(root, build, machine)
        except AssertionError as error:
            for log in sorted(pathlib.Path(folder).glob("*.log")):
                print(f"{log.name}:\n{log.read_text()[-1500:]}")
            print(error)
            return 1
        finally:
            machine.stop()
    print("slurm: ok")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
