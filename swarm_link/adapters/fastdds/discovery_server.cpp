// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <utility>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "swarm_link/adapters/fastdds/fastdds_participant.hpp"
#include "swarm_link/adapters/fastdds/participant_qos.hpp"

namespace swarm::link {

namespace {

namespace dds = eprosima::fastdds::dds;

// Owns the server's participant.
class FastDdsDiscoveryServer final : public DiscoveryServer {
 public:
  FastDdsDiscoveryServer(dds::DomainParticipant* participant, std::uint16_t port)
      : participant_(participant), port_(port) {}
  ~FastDdsDiscoveryServer() override {
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  DiscoveryAddress address() const override { return {.host = "127.0.0.1", .port = port_}; }

 private:
  dds::DomainParticipant* participant_;
  std::uint16_t port_;
};

// A UDP port of the loopback interface that was free a moment ago; 0 if the kernel has none.
std::uint16_t free_udp_port() {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return 0;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  const bool ok = ::bind(fd, reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
                  ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  ::close(fd);
  return ok ? ntohs(address.sin_port) : std::uint16_t{0};
}

// Starts a server at a port and checks that it really got this port, since clients derive the
// server's GUID from it.
Result<std::unique_ptr<DiscoveryServer>> start_at(std::uint32_t domain, std::uint16_t port) {
  using namespace fastdds;
  const auto ports = first_ports(domain, 0);
  if (!ports) return tl::unexpected(ports.error());
  try {
    set_up_library();
    auto sockets = std::make_shared<ReceiveSockets>(std::uint16_t{0}, false, 0);
    auto* participant = dds::DomainParticipantFactory::get_instance()->create_participant(
        domain, server_qos(domain, port, *ports, sockets), nullptr, dds::StatusMask::none());
    if (participant == nullptr) {
      return fail(ErrorCode::kEnvironment,
                  fmt::format("DDS refused a discovery server at 127.0.0.1:{}", port));
    }
    auto server = std::make_unique<FastDdsDiscoveryServer>(participant, port);
    if (!sockets->can_receive(port)) {  // the vendor would use another port without an error
      return fail(ErrorCode::kEnvironment,
                  fmt::format("discovery server: UDP port 127.0.0.1:{} is taken", port));
    }
    return server;
  } catch (const std::exception& e) {
    return fail(ErrorCode::kEnvironment, fmt::format("discovery server: {}", e.what()));
  }
}

}  // namespace

Result<std::unique_ptr<DiscoveryServer>> make_discovery_server(std::uint32_t domain,
                                                               std::uint16_t port) {
  if (port != 0) return start_at(domain, port);
  constexpr int kTries = 8;  // another process may take the port between looking and binding
  for (int i = 1; i < kTries; ++i) {
    auto server = start_at(domain, free_udp_port());
    if (server) return server;
  }
  return start_at(domain, free_udp_port());
}

}  // namespace swarm::link
