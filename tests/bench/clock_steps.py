#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
"""The wall clock is set in flight: two flights of a hundred real robot processes, with the same commands at the same times.

    tests/bench/clock_steps.py [--robots N] [--channel auto|groups|topics] [--seed N]

In one of them the clock of all programs is stepped five times; after each step both flights get a pause, a resume, a kill of
the planner and a new obstacle. One JSON line a flight: the longest time from a pause to a robot's hold and from a resume to a
robot's moving on [ms], and the audit. Exit code 1 unless both are at most 500 ms with the steps, too, and the two audits have
the same outcome, arrivals and contacts. About four minutes."""
import argparse
import json
import os
import pathlib
import signal
import struct
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("SWARM_BIN", ROOT / "build/release/bin"))
MISSION = ROOT / "deploy/missions/swarmprm_standin.yaml"
STEPS_S = [-3600, -60, -8, 60, 3600]
BETWEEN_S = 25
PAUSE_S = 1
LIMIT_MS = 500


def events_of(run):
    """What the launcher and others reported; the last line may be incomplete."""
    lines = (run / "events.jsonl").read_text().splitlines() if (run / "events.jsonl").exists() else []
    return [json.loads(line) for line in lines if line.endswith("}")]


class Flight:
    """A run with a clock of its own."""

    def __init__(self, folder, steps_s, options):
        self.dir = folder / "run"
        self.offset = folder / "offset"
        self.steps_s = steps_s
        self.offset.write_bytes(struct.pack("q", 0))
        clock = {"LD_PRELOAD": str(options.clock_shim), "SWARM_CLOCK_OFFSET_FILE": str(self.offset)}
        arguments = ["--robots", str(options.robots), "--seed", str(options.seed), "--channel", options.channel]
        self.launcher = subprocess.Popen([BIN / "swarm_launcher", "run", MISSION, "--out", self.dir, *arguments],
                                         stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env={**os.environ, **clock})

    def has_started(self):
        return any(event["text"] == "start" for event in events_of(self.dir))

    def set_clock(self, number):
        offset_s = sum(self.steps_s[:number + 1])
        with self.offset.open("r+b") as mapped:  # in place, since the programs have it mapped
            mapped.write(struct.pack("q", offset_s))

    def command(self, *arguments):
        subprocess.run([BIN / "swarm_launcher", "command", self.dir, *arguments], stdout=subprocess.DEVNULL, check=True, timeout=60)

    def kill_planner(self):
        found = subprocess.run(["pgrep", "-P", str(self.launcher.pid), "-x", "planner_service"], capture_output=True, text=True)
        for pid in found.stdout.split():
            os.kill(int(pid), signal.SIGKILL)

    def obeyed_after_ms(self, command, is_obeyed):
        """The longest time from that command to a robot's change to a mode that obeys it, over commands and robots; None if a
        robot did not obey one."""
        published_ns = [e["utc_ns"] for e in events_of(self.dir) if e["code"] == "command" and e["text"] == command]
        longest_ns = 0
        for log in sorted((self.dir / "blackbox").glob("*.mcap")):
            notes = subprocess.run([BIN / "swarm_monitor", "cat", log, "--topics", "blackbox/note"], capture_output=True, text=True)
            changes = [json.loads(line)["data"] for line in notes.stdout.splitlines()]
            times_ns = [int(c["stamp_utc_ns"]) for c in changes if c["code"] == "mode" and is_obeyed(c["text"])]
            for stamp_ns in published_ns:
                after_ns = [t - stamp_ns for t in times_ns if t >= stamp_ns]
                if not after_ns:
                    return None
                longest_ns = max(longest_ns, min(after_ns))
        return longest_ns / 1e6

    def result(self, name):
        audit = subprocess.run([BIN / "swarm_monitor", "audit", self.dir, "--json"], capture_output=True, text=True)
        judged = json.loads(audit.stdout)
        keys = ["outcome", "arrived", "lost", "collisions_robot", "collisions_obstacle", "min_robot_gap_m", "mission_s", "path_ratio",
                "refused_messages", "deadline_miss_ratio"]
        return {"flight": name, "exit": self.launcher.wait(timeout=600), **{key: judged.get(key) for key in keys},
                "w2_ratio": judged["tracking"]["swarm"]["ratio"],
                "pause_ms": self.obeyed_after_ms("pause", lambda mode: mode == "holding"),
                "resume_ms": self.obeyed_after_ms("resume", lambda mode: mode != "holding"),
                "planners_started": 1 + sum(e["code"] == "respawn" for e in events_of(self.dir))}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--robots", type=int, default=100)
    parser.add_argument("--channel", default="auto")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--clock-shim", type=pathlib.Path, default=BIN.parent / "libexec/swarmflow/clock_shim.so")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as other:
        flights = [Flight(pathlib.Path(one), [0] * len(STEPS_S), options), Flight(pathlib.Path(other), STEPS_S, options)]
        for _ in range(600):
            if all(flight.has_started() for flight in flights):
                break
            time.sleep(0.1)
        for number in range(len(STEPS_S)):
            time.sleep(BETWEEN_S)
            for flight in flights:
                flight.set_clock(number)
            for command in (["pause"], ["resume"], None, ["add_obstacle", f"circle_m: {{center: [{5 + 2 * number}, 5], radius: 0.3}}"]):
                for flight in flights:
                    flight.command(*command) if command else flight.kill_planner()
                time.sleep(PAUSE_S)
        for flight in flights:
            flight.launcher.wait(timeout=600)
        steady, stepped = flights[0].result("steady clock"), flights[1].result("stepped clock")
    for result in (steady, stepped):
        print(json.dumps(result), flush=True)
    same = all(steady[key] == stepped[key] for key in ("outcome", "arrived", "lost", "collisions_robot", "collisions_obstacle"))
    obeyed = all(stepped[key] is not None and stepped[key] <= LIMIT_MS for key in ("pause_ms", "resume_ms"))
    return 0 if same and obeyed else 1


if __name__ == "__main__":
    sys.exit(main())
