// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A node of ROS 2 by Foxglove's libraries, on loopback: an RTPS participant and messages by the official definitions.
import definitions from "@foxglove/rosmsg-msgs-common";
import serialization from "@foxglove/rosmsg2-serialization";
import ros2 from "@foxglove/ros2";
import rtps from "@foxglove/rtps";
import nodejs from "@foxglove/rtps/nodejs";

const { MessageReader, MessageWriter } = serialization;
const { rosTopicToDds, rosTypeToDds } = ros2;

const kLoopback = "127.0.0.1";
const kBestEffort = { kind: rtps.Reliability.BestEffort, maxBlockingTime: { sec: 0, nsec: 0 } };
const kKeepLast = { kind: rtps.HistoryKind.KeepLast, depth: 5 };

// The library wants the parameter in each announcement, and Cyclone DDS leaves default values out.
const stated = rtps.ParametersView.prototype.reliability;
rtps.ParametersView.prototype.reliability = function () {
  return stated.call(this) ?? kBestEffort;
};

// Not in the package: of Crazyswarm2.
const kOthers = {
  "crazyflie_interfaces/VelocityWorld": {
    definitions: [
      { type: "std_msgs/Header", name: "header", isComplex: true },
      { type: "geometry_msgs/Vector3", name: "vel", isComplex: true },
      { type: "float32", name: "yaw_rate" },
    ],
  },
};

/// The official definition of a type, "geometry_msgs/Twist", with those that it contains.
export function definitionOf(name) {
  const found = new Map();
  const add = (type) => {
    if (found.has(type)) return;
    const definition = definitions.ros2jazzy[type] ?? kOthers[type];
    if (definition === undefined) throw new Error(`no official definition of ${type}`);
    found.set(type, { name: type, definitions: definition.definitions });
    for (const field of definition.definitions) if (field.isComplex) add(field.type);
  };
  add(name);
  return [...found.values()];
}

async function loopbackSocket(options) {
  const socket = await nodejs.UdpSocketNode.Create(options);
  const bind = socket.bind.bind(socket);
  const join = socket.addMembership.bind(socket);
  socket.bind = async (to) => {
    await bind(to);
    await socket.setMulticastInterface(kLoopback);
  };
  socket.addMembership = (group) => join(group, kLoopback);
  return socket;
}

export class RosNode {
  constructor(name, domain) {
    this.participant = new rtps.Participant({
      name,
      addresses: [kLoopback],
      domainId: domain,
      udpSocketCreate: loopbackSocket,
    });
    this.handlers = new Map();
    this.participant.on("userData", ({ subscription, serializedData }) => {
      this.handlers.get(subscription.topicName)?.(serializedData);
    });
    this.participant.on("error", (error) => console.error(`${name}: ${error}`));
  }

  // The library announces itself once. One that starts meanwhile would miss it.
  async start() {
    await this.participant.start();
    const announce = () => this.participant.broadcastParticipant(this.participant.attributes);
    this.announcing = setInterval(announce, 1000);
  }
  stop() {
    clearInterval(this.announcing);
    return this.participant.shutdown();
  }

  /// Calls `take(message, bytes)` for each message of a topic from now on. The library acknowledges user data where Fast
  /// DDS does not listen, so nothing is repeated for it.
  subscribe(topic, type, take) {
    const reader = new MessageReader(definitionOf(type));
    const topicName = rosTopicToDds(topic);
    this.handlers.set(topicName, (bytes) => take(reader.readMessage(bytes), bytes));
    this.participant.subscribe({
      topicName,
      typeName: rosTypeToDds(type.replace("/", "/msg/")),
      durability: rtps.Durability.Volatile,
      reliability: kBestEffort,
      history: kKeepLast,
    });
  }

  /// A function that publishes a message. The library has no public writers: this one is announced as its readers are,
  /// and sends each sample to the readers of the topic that were found.
  advertise(topic, type) {
    const p = this.participant;
    const topicName = rosTopicToDds(topic);
    const writerId = rtps.makeEntityId(p.nextEndpointId++, rtps.EntityKind.AppdefWriterNoKey);
    const guid = rtps.makeGuid(p.attributes.guidPrefix, writerId);
    const about = new rtps.Parameters();
    about.topicName(topicName);
    about.typeName(rosTypeToDds(type.replace("/", "/msg/")));
    about.durability(rtps.Durability.Volatile);
    about.reliability(kBestEffort);
    about.history(kKeepLast);
    about.protocolVersion(p.attributes.protocolVersion);
    about.vendorId(p.attributes.vendorId);
    about.endpointGuid(guid);
    about.finish();
    const announcer = p._writers.get(rtps.EntityIdBuiltin.PublicationsWriter);
    announcer.history.set({
      timestamp: now(),
      kind: rtps.ChangeKind.Alive,
      writerGuid: rtps.makeGuid(p.attributes.guidPrefix, rtps.EntityIdBuiltin.PublicationsWriter),
      sequenceNumber: announcer.history.nextSequenceNum(),
      data: about.data,
      instanceHandle: guid,
    });
    void p.sendMetatrafficChanges(announcer);

    const encoder = new MessageWriter(definitionOf(type));
    const writer = new rtps.Writer({
      ...p.attributes,
      entityId: writerId,
      durability: rtps.Durability.Volatile,
      reliability: kBestEffort,
      history: { kind: rtps.HistoryKind.KeepLast, depth: 1 },
    });
    p._writers.set(writerId, writer);
    return (message) => {
      writer.history.set({
        timestamp: now(),
        kind: rtps.ChangeKind.Alive,
        writerGuid: guid,
        sequenceNumber: writer.history.nextSequenceNum(),
        data: padded(encoder.writeMessage(message)),
        instanceHandle: guid,
      });
      for (const peer of p._participants.values()) {
        for (const reader of peer.remoteReaders.values()) {
          if (reader.attributes.topicName !== topicName) continue;
          void p.sendChangesTo(reader, writer, peer.attributes.defaultUnicastLocatorList);
        }
      }
    };
  }
}

/// To a multiple of four bytes, as RTPS has it and Cyclone DDS demands.
function padded(bytes) {
  const all = new Uint8Array(4 * Math.ceil(bytes.length / 4));
  all.set(bytes);
  return all;
}

export function now() {
  const ns = BigInt(Math.round((performance.timeOrigin + performance.now()) * 1000)) * 1000n;
  return { sec: Number(ns / 1000000000n), nsec: Number(ns % 1000000000n) };
}
