#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
"""A cable with loss and delay between two network namespaces, for kernels without netem; as root.

    lossy_cable.py NS_A IF_A NS_B IF_B LOSS DELAY_MS

Makes the TAP devices IF_A and IF_B and carries frames between them until stdin ends. A line on stdin
is the new loss: 1 cuts the cable."""
import collections
import ctypes
import fcntl
import os
import random
import select
import struct
import sys
import time

TUNSETIFF = 0x400454CA
IFF_TAP, IFF_NO_PI = 0x0002, 0x1000
CLONE_NEWNET = 0x40000000
FRAME = 65536
WAITING = 20000  # frames under way, each direction: like a switch, it drops what is more

libc = ctypes.CDLL(None, use_errno=True)


def tap(namespace, name):
    home = os.open("/proc/self/ns/net", os.O_RDONLY)
    there = os.open("/run/netns/" + namespace, os.O_RDONLY)
    if libc.setns(there, CLONE_NEWNET) != 0:
        sys.exit(f"lossy_cable: cannot enter {namespace}: {os.strerror(ctypes.get_errno())}")
    fd = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(fd, TUNSETIFF, struct.pack("16sH", name.encode(), IFF_TAP | IFF_NO_PI))
    libc.setns(home, CLONE_NEWNET)
    os.close(home)
    os.close(there)
    return fd


def main():
    ns_a, if_a, ns_b, if_b, loss, delay_ms = sys.argv[1:7]
    ends = [tap(ns_a, if_a), tap(ns_b, if_b)]
    loss, delay = float(loss), float(delay_ms) / 1000
    queues = {ends[0]: (ends[1], collections.deque()), ends[1]: (ends[0], collections.deque())}
    print("ready", flush=True)
    chance = random.Random(1)
    while True:
        now = time.monotonic()
        due = min((queue[0][0] for _, queue in queues.values() if queue), default=now + 1)
        ready, _, _ = select.select([0, *ends], [], [], max(0.0, due - now))
        now = time.monotonic()
        for fd in ready:
            if fd == 0:
                line = sys.stdin.readline()
                if not line:
                    return
                loss = float(line)
                continue
            queue = queues[fd][1]
            for _ in range(256):
                try:
                    frame = os.read(fd, FRAME)
                except BlockingIOError:
                    break
                if chance.random() >= loss and len(queue) < WAITING:
                    queue.append((now + delay, frame))
        for to, queue in queues.values():
            while queue and queue[0][0] <= now:
                try:
                    os.write(to, queue.popleft()[1])
                except OSError:
                    pass  # the other end is down: lost


main()
