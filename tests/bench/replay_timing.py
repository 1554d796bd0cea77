#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
"""How true a replay at rate 1 keeps its times:  replay_timing.py FIRST.mcap SECOND.mcap

Both are recordings of the same messages, the second of a replay of the first. Compares content and order on
every topic, and when each message was published, since the first of all. Needs swarm_monitor on the PATH."""
import collections
import json
import subprocess
import sys


def messages(file):
    topics = collections.defaultdict(list)
    cat = subprocess.Popen(["swarm_monitor", "cat", file], stdout=subprocess.PIPE, text=True)
    for line in cat.stdout:
        message = json.loads(line)
        topics[message["topic"]].append((int(message["publish_time_ns"]), message["data"]))
    if cat.wait() != 0:
        sys.exit(f"{file} cannot be read")
    return topics


first, second = messages(sys.argv[1]), messages(sys.argv[2])
same = all([data for _, data in first[topic]] == [data for _, data in second[topic]] for topic in first)
begin_first = min(topic[0][0] for topic in first.values())
begin_second = min(topic[0][0] for topic in second.values())
errors = []
for topic, sent in first.items():
    last = 0
    for (at, _), (again, _) in zip(sent, second[topic]):
        last = max(last, at)  # a writer's clock that steps back stands still
        errors.append(abs((again - begin_second) - (last - begin_first)) / 1e6)
errors.sort()
print(json.dumps({"messages": sum(map(len, first.values())), "same_content_and_order": same,
                  "timing_error_ms": {q: round(errors[min(len(errors) - 1, int(p * len(errors)))], 3)
                                      for q, p in (("p50", 0.5), ("p99", 0.99), ("max", 1.0))}}))
