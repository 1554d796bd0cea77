// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/cyclone/cyclone_participant.hpp"

#include <array>
#include <map>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <fmt/format.h>

#include "swarm_link/adapters/cyclone/byte_type.hpp"
#include "swarm_link/adapters/cyclone/steady_waits.hpp"

namespace swarm::link {
namespace cyclone {
namespace {

// By default Cyclone does not use multicast on the loopback interface and numbers participants up
// to 10 only, so the eleventh process would fail; without an index there is no such limit. A
// participant with static peers announces itself often (every 0.8 s), because only so it discovers
// a peer that was restarted.
std::string config_of(const CycloneOptions& options) {
  std::string discovery =
      fmt::format("<ParticipantIndex>{}</ParticipantIndex>",
                  options.index ? fmt::format("{}", *options.index) : std::string("none"));
  if (!options.peer_ports.empty()) {
    discovery += "<SPDPInterval>0.8 s</SPDPInterval><Peers>";
    for (const std::uint16_t port : options.peer_ports) {
      discovery += fmt::format("<Peer address=\"{}:{}\"/>", options.peer_host, port);
    }
    discovery += "</Peers>";
  } else if (!options.open_peers.empty()) {
    discovery += "<Peers>";
    for (const std::string& peer : options.open_peers) {
      discovery += fmt::format("<Peer address=\"{}\"/>", peer);
    }
    discovery += "</Peers>";
  }
  const std::string interface = options.interface.empty()
                                    ? std::string("autodetermine=\"true\"")
                                    : fmt::format("address=\"{}\"", options.interface);
  return fmt::format(
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface {} "
      "multicast=\"true\"/></Interfaces><AllowMulticast>{}</AllowMulticast></"
      "General><Discovery>{}</Discovery>"
      "</Domain></CycloneDDS>",
      interface, options.peer_ports.empty(), discovery);
}

// Longest time a reliable write may block when its history is full.
constexpr dds_duration_t kMaxBlocking = DDS_MSECS(100);

/// Deletes an entity, and with it all that belongs to it.
class Entity {
 public:
  explicit Entity(dds_entity_t handle = 0) : handle_(handle) {}
  ~Entity() {
    if (handle_ > 0) dds_delete(handle_);
  }
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  dds_entity_t get() const { return handle_; }

 private:
  dds_entity_t handle_;
};

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using QosPtr = std::unique_ptr<dds_qos_t, QosDeleter>;

/// Cyclone configures a domain once per process: the first participant determines the
/// configuration, the last one deletes it.
std::shared_ptr<Entity> domain_of(const CycloneOptions& options) {
  static std::mutex mutex;
  static std::map<std::uint32_t, std::weak_ptr<Entity>> domains;
  const std::lock_guard lock(mutex);
  auto domain = domains[options.domain].lock();
  if (!domain) {
    domain =
        std::make_shared<Entity>(dds_create_domain(options.domain, config_of(options).c_str()));
    domains[options.domain] = domain;
  }
  return domain;
}

// Translates our QoS. The durability service holds as many samples as the history, so that late
// readers of a transient-local topic receive all of them.
QosPtr translate(const Qos& qos, int depth) {
  QosPtr out(dds_create_qos());
  dds_qset_reliability(out.get(),
                       qos.reliability == Reliability::kReliable ? DDS_RELIABILITY_RELIABLE
                                                                 : DDS_RELIABILITY_BEST_EFFORT,
                       kMaxBlocking);
  dds_qset_durability(out.get(), qos.durability == Durability::kTransientLocal
                                     ? DDS_DURABILITY_TRANSIENT_LOCAL
                                     : DDS_DURABILITY_VOLATILE);
  dds_qset_history(out.get(), DDS_HISTORY_KEEP_LAST, depth);
  dds_qset_durability_service(out.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  return out;
}

class CycloneWriter final : public RawWriter {
 public:
  CycloneWriter(Entity topic, Entity writer)
      : topic_(std::move(topic)), writer_(std::move(writer)) {}

  bool write(Bytes bytes) override { return dds_write(writer_.get(), &bytes) == DDS_RETCODE_OK; }

  int matched() const override {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(writer_.get(), &status);
    return static_cast<int>(status.current_count);
  }

 private:
  Entity topic_;  // declared first: destroyed after the writer
  Entity writer_;
};

class CycloneReader final : public RawReader {
 public:
  CycloneReader(Entity topic, Entity reader)
      : topic_(std::move(topic)), reader_(std::move(reader)) {}

  // Takes samples in batches with dds_takecdr(), which hands over their bytes without decoding.
  // Each sample must be released.
  std::size_t take(const Sink& sink) override {
    constexpr std::size_t kAtOnce = 64;
    std::array<ddsi_serdata*, kAtOnce> samples;
    std::array<dds_sample_info_t, kAtOnce> infos;
    std::size_t taken = 0;
    for (;;) {
      const dds_return_t came =
          dds_takecdr(reader_.get(), samples.data(), kAtOnce, infos.data(), DDS_ANY_STATE);
      if (came <= 0) return taken;
      for (std::size_t i = 0; i < static_cast<std::size_t>(came); ++i) {
        if (infos[i].valid_data) {  // else a notice that a writer has left
          sink({.bytes = bytes_of(*samples[i]),
                .published_utc_ns = infos[i].source_timestamp,
                .sender = sender_of(infos[i].publication_handle)});
          ++taken;
        }
        ddsi_serdata_unref(samples[i]);
      }
    }
  }

  int matched() const override {
    dds_subscription_matched_status_t status{};
    dds_get_subscription_matched_status(reader_.get(), &status);
    return static_cast<int>(status.current_count);
  }

 private:
  // By participant: a process that makes many writers is one sender. A writer that has left is no
  // longer known to the library, but to the map.
  std::uint64_t sender_of(dds_instance_handle_t writer) {
    const auto known = senders_.find(writer);
    if (known != senders_.end()) return known->second;
    dds_builtintopic_endpoint_t* const endpoint =
        dds_get_matched_publication_data(reader_.get(), writer);
    if (endpoint == nullptr) return writer;
    const std::uint64_t sender = endpoint->participant_instance_handle;
    dds_builtintopic_free_endpoint(endpoint);
    if (senders_.size() >= kMostSenders) senders_.clear();
    senders_.emplace(writer, sender);
    return sender;
  }

  static constexpr std::size_t kMostSenders = 4096;
  Entity topic_;
  Entity reader_;
  std::unordered_map<dds_instance_handle_t, std::uint64_t> senders_;  ///< participant of a writer
};

class CycloneParticipant final : public Participant {
 public:
  CycloneParticipant(CycloneOptions options, std::shared_ptr<Entity> domain, Entity participant)
      : options_(std::move(options)),
        domain_(std::move(domain)),
        participant_(std::move(participant)) {}

  Result<RawWriterPtr> make_writer(const RawTopic& t) override {
    auto made_topic = topic(t);
    if (!made_topic) return tl::unexpected(made_topic.error());
    const QosPtr qos = translate(t.qos, t.qos.depth);
    Entity made(dds_create_writer(participant_.get(), made_topic->get(), qos.get(), nullptr));
    if (made.get() < 0) return refused("writer", t.name, made.get());
    return std::make_unique<CycloneWriter>(std::move(*made_topic), std::move(made));
  }

  Result<RawReaderPtr> make_reader(const RawTopic& t) override {
    auto made_topic = topic(t);
    if (!made_topic) return tl::unexpected(made_topic.error());
    const QosPtr qos = translate(t.qos, std::max(t.qos.depth, t.qos.reader_depth));
    Entity made(dds_create_reader(participant_.get(), made_topic->get(), qos.get(), nullptr));
    if (made.get() < 0) return refused("reader", t.name, made.get());
    return std::make_unique<CycloneReader>(std::move(*made_topic), std::move(made));
  }

  void receive() override {}  // the vendor's threads receive

  Result<void> self_check() const override { return {}; }  // creation reports failures

 private:
  Result<Entity> topic(const RawTopic& t) const {
    ddsi_sertype* type = make_byte_type(t.type, t.keyed);
    // Without QoS: endpoints carry their own, and creating a topic a second time with a different
    // QoS would fail.
    Entity made(dds_create_topic_sertype(participant_.get(), t.name.c_str(), &type, nullptr,
                                         nullptr, nullptr));
    if (made.get() >= 0) return made;
    ddsi_sertype_unref(type);
    return refused("topic", t.name, made.get());
  }

  tl::unexpected<Error> refused(const char* what, const std::string& topic,
                                dds_return_t code) const {
    return fail(ErrorCode::kEnvironment,
                fmt::format("Cyclone DDS refused participant '{}' a {} of topic '{}': {}",
                            options_.name, what, topic, dds_strretcode(code)));
  }

  CycloneOptions options_;
  std::shared_ptr<Entity> domain_;
  Entity participant_;
};

}  // namespace
}  // namespace cyclone

Result<std::unique_ptr<Participant>> make_cyclone_participant(const CycloneOptions& options) {
  using namespace cyclone;
  wait_by_steady_clock();
  auto domain = domain_of(options);
  if (domain->get() < 0) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("Cyclone DDS refused domain {} on {}: {}; is that interface up?",
                            options.domain, options.interface, dds_strretcode(domain->get())));
  }
  const QosPtr qos(dds_create_qos());
  dds_qset_entity_name(qos.get(), options.name.c_str());
  if (!options.user_data.empty()) {
    dds_qset_userdata(qos.get(), options.user_data.data(), options.user_data.size());
  }
  Entity participant(dds_create_participant(options.domain, qos.get(), nullptr));
  if (participant.get() < 0) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("Cyclone DDS refused participant '{}' in domain {}: {}", options.name,
                            options.domain, dds_strretcode(participant.get())));
  }
  return std::make_unique<CycloneParticipant>(options, std::move(domain), std::move(participant));
}

}  // namespace swarm::link
