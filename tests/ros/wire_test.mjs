// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Each ROS message as ros_wire_samples writes it, with all fields filled, is read by the official definitions, and
// written again gives the same bytes.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { test } from "node:test";
import serialization from "@foxglove/rosmsg2-serialization";
import { definitionOf } from "./ros_node.mjs";

const samples = execFileSync(`${process.env.SWARM_BIN}/ros_wire_samples`, { encoding: "utf8" })
  .trim()
  .split("\n")
  .map((line) => line.split(" "));

for (const [type, hex] of samples) {
  const name = type.replace("/msg/", "/");
  test(type, () => {
    const definition = definitionOf(name);
    const bytes = Buffer.from(hex, "hex");
    const message = new serialization.MessageReader(definition).readMessage(bytes);
    const again = Buffer.from(new serialization.MessageWriter(definition).writeMessage(message));
    assert.equal(again.toString("hex"), hex);
  });
}

test("all of the messages have a sample", () => {
  assert.ok(samples.length >= 10, `${samples.length}`);
});
