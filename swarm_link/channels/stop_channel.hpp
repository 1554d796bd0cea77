// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "swarm_link/channels/faulty_path.hpp"
#include "swarm_link/channels/launcher_beat.hpp"
#include "swarm_link/messages.hpp"
#include "swarmflow/core/result.hpp"

/// The stop channel: the emergency stop as UDP datagrams of its own, on one multicast group per DDS
/// domain, beside the reliable topic `swarm/command`. It needs no discovery, no match and no living
/// launcher, and each datagram counts by itself: on a lossy network a reliable topic holds later
/// samples back until the lost one is repaired. Any process that reaches the group can stop the
/// robots, as with the topic.
///
/// The launcher's beats go to the same group: they, too, must not depend on discovery.
///
/// A datagram is 8 bytes "SWSTOP", kind and version, then the content: of a stop the CDR bytes of
/// its CommandMessage, of a confirmation the ids of the stopped robots and of the stop that it
/// answers, of a beat see LauncherBeat.
namespace swarm::link {

/// Where the datagrams of a run go.
struct StopChannelOptions {
  std::uint32_t domain = 0;             ///< DDS domain: runs do not stop each other
  std::string interface = "127.0.0.1";  ///< address of the interface
  ReceptionFaults faults{};             ///< simulated loss and delay of what is received
};

/// Robots of one process that have stopped: ids first to first + count − 1.
struct StopConfirmation {
  std::uint32_t first_robot_id = 0;  ///< the smallest id
  std::uint32_t robots = 0;          ///< their number
  std::uint64_t command_id = 0;      ///< the receiver's own stop that it answers
};

/// The end that stops robots: launcher, or a command. Single thread.
class StopSender {
 public:
  /// Fails with kEnvironment if the interface carries no multicast.
  static Result<std::unique_ptr<StopSender>> open(const StopChannelOptions& options);
  ~StopSender();
  StopSender(const StopSender&) = delete;
  StopSender& operator=(const StopSender&) = delete;

  /// Sends one datagram. Call it every 50 ms while robots are to stop: any one is enough.
  /// \pre stop.kind is kStop, asserted
  void send(const CommandMessage& stop);

  /// Sends one datagram to all processes with robots.
  void send(const LauncherBeat& beat);

  /// Appends the confirmations that have arrived since the last call; never waits.
  void take(std::vector<StopConfirmation>& confirmations);

 private:
  struct Impl;
  explicit StopSender(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// The end of a process with robots. Single thread.
class StopReceiver {
 public:
  /// Joins the group. Fails with kEnvironment if the interface carries no multicast.
  static Result<std::unique_ptr<StopReceiver>> open(const StopChannelOptions& options);
  ~StopReceiver();
  StopReceiver(const StopReceiver&) = delete;
  StopReceiver& operator=(const StopReceiver&) = delete;

  /// The last stop that has arrived since the previous call, if any; never waits. Its content is
  /// not checked: that is for Gate::command().
  std::optional<CommandMessage> take();

  /// The beats that the last take() read, in the order of their arrival; of more than eight the
  /// first seven and the last one.
  std::span<const LauncherBeat> beats() const;

  /// Datagrams so far that are no stop and no beat.
  std::uint64_t undecodable() const;

  /// Answers all who have sent a stop since the last confirmation, each with the id of its last
  /// one.
  void confirm(const RobotRange& stopped);

 private:
  struct Impl;
  explicit StopReceiver(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace swarm::link
