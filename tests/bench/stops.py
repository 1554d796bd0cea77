#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
"""The emergency stop of a hundred real robot processes whose planner is dead, in eight situations.

    tests/bench/stops.py [--robots N] [--channel auto|groups|topics] [CASE ...]

Prints one JSON line a case: what the command answered, and the time from the stop's stamp to rest of the 50th and
99th percentile and the last robot [ms], by the robots' own logs. Exit code 1 unless in every case all robots
confirmed without a contact, and p99 is at most 0.5 s, or 1 s where the launcher, its disk or the clocks fail. `disk` needs root. About a minute a case."""
import argparse
import json
import os
import pty
import pathlib
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("SWARM_BIN", ROOT / "build/release/bin"))
MISSION = ROOT / "deploy/missions/swarmprm_standin.yaml"
FLIES_FOR_S = 20
FAULTS = {"plain": None, "loss20": "loss=0.2,delay-ms=150", "loss50": "loss=0.5,delay-ms=150,from=15"}
CASES = [*FAULTS, "suspended", "ctrl-s", "disk", "removed", "clocks"]


def wait_for(condition, what, limit_s=120):
    end = time.monotonic() + limit_s
    while not condition():
        if time.monotonic() > end:
            sys.exit(f"stops.py: waited {limit_s} s for {what}")
        time.sleep(0.1)


def children(parent, name):
    found = subprocess.run(["pgrep", "-P", str(parent), "-x", name], capture_output=True, text=True)
    return [int(pid) for pid in found.stdout.split()]


class Flight:
    """A run of the launcher at a terminal of its own, with its planner killed in flight."""

    def __init__(self, folder, arguments, robots, environment=None):
        self.dir = folder / "run"
        self.master, self.slave = pty.openpty()
        threading.Thread(target=self.read, daemon=True).start()
        self.launcher = subprocess.Popen(
            [BIN / "swarm_launcher", "run", MISSION, "--robots", str(robots), "--out", self.dir, *arguments],
            stdout=self.slave, stderr=self.slave, env={**os.environ, **(environment or {})})
        events = self.dir / "events.jsonl"
        wait_for(lambda: events.exists() and '"text":"start"' in events.read_text(), "the start")
        time.sleep(FLIES_FOR_S)
        for pid in children(self.launcher.pid, "planner_service"):
            os.kill(pid, signal.SIGKILL)

    def read(self):
        try:
            while os.read(self.master, 4096):
                pass
        except OSError:
            pass

    def stop(self):
        """By the command line, as a user would; returns its answer."""
        command = [BIN / "swarm_launcher", "command", self.dir, "stop"]
        if not self.dir.exists():
            domain = pathlib.Path(str(self.dir) + ".domain").read_text()
            command = [BIN / "swarm_launcher", "command", "--domain", domain, "stop"]
        return subprocess.run(command, capture_output=True, text=True, timeout=60).stdout.strip()

    def keep_domain(self):
        """What the launcher printed: a run whose directory is gone is named by its domain."""
        domain = json.loads((self.dir / "run.json").read_text())["domain"]
        pathlib.Path(str(self.dir) + ".domain").write_text(str(domain))


def stop_in(case, folder, options):
    """Flies and stops; the run directory that the audit reads."""
    arguments = ["--channel", options.channel]
    if FAULTS.get(case):
        arguments += ["--fault", FAULTS[case]]
    environment = None
    if case == "clocks":
        # The launcher and the command are an hour ahead of the planner and the robots.
        offset = folder / "offset"
        offset.write_bytes(struct.pack("q", 0))
        environment = {"LD_PRELOAD": str(options.clock_shim), "SWARM_CLOCK_OFFSET_FILE": str(offset)}
    place = folder
    if case == "disk":
        place = folder / "disk"
        place.mkdir()
        image = folder / "image"
        subprocess.run(f"truncate -s 200M {image} && mkfs.ext4 -q -F {image} && mount -o loop {image} {place}",
                       shell=True, check=True)
    try:
        flight = Flight(place, arguments, options.robots, environment)
        flight.keep_domain()
        if case == "suspended":
            os.kill(flight.launcher.pid, signal.SIGSTOP)
        elif case == "ctrl-s":
            termios.tcflow(flight.slave, termios.TCOOFF)
        elif case == "disk":
            subprocess.run(["fsfreeze", "-f", place], check=True)
        elif case == "removed":
            kept = folder / "kept"
            flight.dir.rename(kept)
        elif case == "clocks":
            for step in (3600, -3600):
                with offset.open("r+b") as mapped:  # in place, since the programs have it mapped
                    mapped.write(struct.pack("q", step))
                time.sleep(1)
        answer = flight.stop()
        time.sleep(3)
        os.kill(flight.launcher.pid, signal.SIGCONT)
        termios.tcflow(flight.slave, termios.TCOON)
        if case == "disk":
            subprocess.run(["fsfreeze", "-u", place], check=True)
        flight.launcher.wait(timeout=60)
        if case == "removed":
            flight.dir = kept  # where the logs that were open go on
        if case == "disk":
            shutil.copytree(flight.dir, folder / "copy")
            flight.dir = folder / "copy"
        return flight.dir, answer
    finally:
        if case == "disk":
            subprocess.run(["umount", "-l", place])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("cases", nargs="*", metavar="CASE", help=" ".join(CASES))
    parser.add_argument("--robots", type=int, default=100)
    parser.add_argument("--channel", default="auto")
    parser.add_argument("--clock-shim", type=pathlib.Path, default=BIN.parent / "libexec/swarmflow/clock_shim.so")
    options = parser.parse_args()
    failed = False
    for case in options.cases or CASES:
        with tempfile.TemporaryDirectory() as folder:
            run, answer = stop_in(case, pathlib.Path(folder), options)
            audit = subprocess.run([BIN / "swarm_monitor", "audit", run, "--json"], capture_output=True, text=True)
            print(audit.stderr, end="", file=sys.stderr)
            try:
                judged = json.loads(audit.stdout)
            except ValueError:
                judged = {}
            latency = judged.get("stop_latency_ms") or {}
            print(json.dumps({"case": case, "channel": options.channel, "stop_latency_ms": latency, "outcome": judged.get("outcome"),
                              "contacts": judged.get("collisions_robot"), "command": answer[-200:]}), flush=True)
            limit_ms = 500 if case in FAULTS else 1000
            confirmed = answer.startswith("done") and f"{options.robots} robots" in answer
            holds = confirmed and latency.get("p99", limit_ms + 1) <= limit_ms and judged.get("collisions_robot") == 0
            failed = failed or not holds
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
