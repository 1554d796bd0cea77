// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/fastdds/participant_qos.hpp"

#include <mutex>
#include <random>
#include <utility>

#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/log/StdoutErrConsumer.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <fmt/format.h>

#include "swarm_core/base/foreign_settings.hpp"
#include "swarm_link/adapters/fastdds/cached_thread_id.hpp"
#include "swarm_link/announcement_port.hpp"

namespace swarm::link::fastdds {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

// GUID prefix of the first server of `fast-discovery-server -i 0`, as ROS_DISCOVERY_SERVER means
// it.
constexpr const char* kFirstRosServer = "44.53.00.5f.45.50.52.4f.53.49.4d.41";

rtps::Locator_t locator(const std::string& address, std::uint16_t port) {
  sockaddr_in at{};
  at.sin_addr = to_in_addr(address);
  at.sin_port = htons(port);
  return to_locator(at);
}

rtps::Locator_t loopback(std::uint16_t port) { return locator(kLoopback, port); }

// What clients and the server share. The lease is longer than most flights. Nothing here depends on
// it: who is silent is known from heartbeats and statuses. And where it is checked while its
// participant leaves, as a hundred do at the end of a flight, the vendor's library aborts (an
// assertion of 2.9.1, PDP.cpp:1140).
dds::DomainParticipantQos common_qos(std::shared_ptr<ReceiveSockets> sockets,
                                     const std::string& interface, int buffer_bytes) {
  dds::DomainParticipantQos qos;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(
      std::make_shared<LoopbackTransportDescriptor>(std::move(sockets), interface, buffer_bytes));
  qos.transport().listen_socket_buffer_size = static_cast<std::uint32_t>(buffer_bytes);
  qos.transport().send_socket_buffer_size = static_cast<std::uint32_t>(buffer_bytes);

  // By default the vendor allocates and zeroes a buffer of 64 KiB for every thread that might send.
  qos.allocation().send_buffers.preallocated_number = 1;
  qos.allocation().send_buffers.dynamic = true;

  auto& builtin = qos.wire_protocol().builtin;
  builtin.avoid_builtin_multicast = true;
  builtin.use_WriterLivelinessProtocol = false;  // 12 % of the discovery traffic, unused by us
  auto& discovery = builtin.discovery_config;
  discovery.leaseDuration = {600, 0};
  discovery.leaseDuration_announcementperiod = {8, 0};
  return qos;
}

/// Static peers. Agents announce themselves every 0.8 s, because only so they discover a restarted
/// planner within the two seconds in which robots tolerate its absence. Relay participants announce
/// themselves less often: they answer announcements anyway.
void announce_to(const StaticPeers& static_peers, std::uint32_t domain,
                 rtps::BuiltinAttributes& builtin) {
  auto& discovery = builtin.discovery_config;
  discovery.discoveryProtocol = rtps::DiscoveryProtocol_t::SIMPLE;
  discovery.initial_announcements = {5, {0, 50'000'000}};  // the first is discarded
  discovery.leaseDuration_announcementperiod = static_peers.is_relay
                                                   ? eprosima::fastrtps::Duration_t{3, 0}
                                                   : eprosima::fastrtps::Duration_t{0, 800'000'000};
  for (const std::uint32_t peer : static_peers.peers) {
    builtin.initialPeersList.push_back(locator(static_peers.host, announcement_port(domain, peer)));
  }
}

/// The vendor makes the prefix of the process and a small number, so that the second participant of
/// a process could have that of the first, which peers may take for known.
rtps::GuidPrefix_t random_prefix() {
  std::random_device random;
  rtps::GuidPrefix_t prefix;
  for (rtps::octet& byte : prefix.value) byte = static_cast<rtps::octet>(random());
  prefix.value[0] = rtps::c_VendorId_eProsima[0];
  prefix.value[1] = rtps::c_VendorId_eProsima[1];
  return prefix;
}

}  // namespace

// Ports beyond 65535 do not exist; the limit leaves room for taken ports that are skipped.
Result<Ports> first_ports(std::uint32_t domain, std::uint32_t index) {
  const std::uint64_t metatraffic = 7410 + 250ULL * domain + 2ULL * index;
  if (metatraffic > 65'000) {
    return fail(ErrorCode::kBadInput,
                fmt::format("DDS domain {} with participant index {} needs port {}: out of range, "
                            "use a lower domain",
                            domain, index, metatraffic));
  }
  const auto port = static_cast<std::uint16_t>(metatraffic);
  return Ports{.metatraffic = port, .data = static_cast<std::uint16_t>(port + 1)};
}

// A fixed tag with domain and port: unique among the servers of a machine.
rtps::GuidPrefix_t server_prefix(std::uint32_t domain, std::uint16_t port) {
  rtps::GuidPrefix_t prefix;
  const auto byte = [](std::uint32_t value) { return static_cast<rtps::octet>(value & 0xFFU); };
  const rtps::octet bytes[] = {
      'S',       'W', 'R', 'M', 'D', 'S', byte(domain >> 8U), byte(domain), 0, 0, byte(port >> 8U),
      byte(port)};
  static_assert(sizeof bytes == rtps::GuidPrefix_t::size);
  std::copy(std::begin(bytes), std::end(bytes), prefix.value);
  return prefix;
}

dds::DomainParticipantQos client_qos(const FastDdsOptions& options, Ports ports,
                                     std::shared_ptr<ReceiveSockets> sockets) {
  auto qos = common_qos(std::move(sockets), options.interface, options.receive_buffer_bytes);
  qos.name(options.name.c_str());
  auto& wire = qos.wire_protocol();
  // Explicit locators, so that the transport knows which port carries data.
  wire.default_unicast_locator_list.push_back(locator(options.interface, ports.data));
  wire.builtin.metatrafficUnicastLocatorList.push_back(
      locator(options.interface, ports.metatraffic));
  wire.builtin.mutation_tries = options.port_tries;
  if (options.static_peers) {
    announce_to(*options.static_peers, options.domain, wire.builtin);
  } else {
    wire.builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::CLIENT;
    eprosima::fastdds::rtps::RemoteServerAttributes server;
    server.guidPrefix = server_prefix(options.domain, options.discovery.port);
    server.metatrafficUnicastLocatorList.push_back(loopback(options.discovery.port));
    wire.builtin.discovery_config.m_DiscoveryServers.push_back(server);
  }
  return qos;
}

// UDP alone: shared memory between versions of the vendor is not to be relied on.
dds::DomainParticipantQos open_qos(const FastDdsOptions& options) {
  const OpenDomain& open = *options.open;
  dds::DomainParticipantQos qos;
  qos.name(options.name.c_str());
  qos.transport().use_builtin_transports = false;
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  if (!options.interface.empty()) udp->interfaceWhiteList.push_back(options.interface);
  qos.transport().user_transports.push_back(udp);
  auto& builtin = qos.wire_protocol().builtin;
  builtin.use_WriterLivelinessProtocol = true;
  qos.wire_protocol().prefix = random_prefix();
  if (open.server) {
    builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::CLIENT;
    eprosima::fastdds::rtps::RemoteServerAttributes server;
    server.ReadguidPrefix(kFirstRosServer);
    server.metatrafficUnicastLocatorList.push_back(locator(open.server->host, open.server->port));
    builtin.discovery_config.m_DiscoveryServers.push_back(server);
  }
  constexpr std::uint32_t kIndicesTried = 20;  // of each address
  for (const std::string& peer : open.peers) {
    for (std::uint32_t index = 0; index < kIndicesTried; ++index) {
      builtin.initialPeersList.push_back(locator(peer, announcement_port(options.domain, index)));
    }
  }
  qos.user_data().setValue({open.user_data.begin(), open.user_data.end()});
  return qos;
}

dds::DomainParticipantQos server_qos(std::uint32_t domain, std::uint16_t port,
                                     Ports unused_data_ports,
                                     std::shared_ptr<ReceiveSockets> sockets) {
  constexpr int kBufferBytes = 8 << 20;  // all clients send to this one socket
  auto qos = common_qos(std::move(sockets), kLoopback, kBufferBytes);
  qos.name("swarm_discovery");
  auto& wire = qos.wire_protocol();
  wire.prefix = server_prefix(domain, port);
  wire.default_unicast_locator_list.push_back(loopback(unused_data_ports.data));
  wire.builtin.metatrafficUnicastLocatorList.push_back(loopback(port));
  wire.builtin.mutation_tries = 4000;  // for the unused data port; the caller checks the other
  wire.builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::SERVER;
  return qos;
}

void set_up_library() {
  static std::once_flag once;
  std::call_once(once, [] {
    ignore_foreign_settings();  // before the library reads them; also in a user's own program
    cache_thread_ids();
    dds::Log::ClearConsumers();
    dds::Log::RegisterConsumer(std::make_unique<dds::StdoutErrConsumer>());  // errors to stderr
    dds::Log::SetVerbosity(dds::Log::Kind::Error);
    auto settings = eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings();
    settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
    eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
  });
}

}  // namespace swarm::link::fastdds
