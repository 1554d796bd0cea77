// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/shared_steps.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "swarm_core/base/assert.hpp"

namespace swarm::shell {
namespace {

/// A step as it is in memory: eight-byte parts that are written and read one by one, since another
/// process may do both at the same time.
struct Packed {
  std::int64_t stamp_ns;
  double x_m, y_m, vx_mps, vy_mps;
  std::int32_t lateness_us;
  std::uint8_t mode, goal;
  std::uint16_t neighbours;
  std::uint32_t plan_version;
  float plan_time_s, reference_x_m, reference_y_m;
};
constexpr std::size_t kParts = sizeof(Packed) / sizeof(std::uint64_t);
using Parts = std::array<std::uint64_t, kParts>;
static_assert(sizeof(Packed) == sizeof(Parts));

using Part = std::atomic<std::uint64_t>;
static_assert(Part::is_always_lock_free, "a lock cannot be shared with a process that is killed");

/// Two steps are read while a third one is written; the fourth gives a reader time to finish.
constexpr std::uint64_t kSteps = 4;
/// A reader that the writer overtakes tries again: it takes microseconds, a control period passes
/// between two steps.
constexpr int kTries = 8;

struct Header {
  std::uint64_t magic;
  std::uint32_t first;
  std::uint32_t count;
};
constexpr std::uint64_t kMagic = 0x3153504554534653;  // "SFSTEPS1"
constexpr std::uint32_t kMostRobots = 1U << 20U;
constexpr double kMost = 1e6;  // as in states: [m], [m/s]

Packed pack(const robot_log::Step& s) {
  return {.stamp_ns = s.stamp.time_since_epoch().count(),
          .x_m = s.position_m.x(),
          .y_m = s.position_m.y(),
          .vx_mps = s.velocity_mps.x(),
          .vy_mps = s.velocity_mps.y(),
          .lateness_us = s.lateness_us,
          .mode = s.mode,
          .goal = s.goal,
          .neighbours = s.neighbours,
          .plan_version = s.plan_version,
          .plan_time_s = s.plan_time_s,
          .reference_x_m = s.reference_x_m,
          .reference_y_m = s.reference_y_m};
}

robot_log::Step unpack(const Packed& p) {
  return {.stamp = UtcTime(Duration(p.stamp_ns)),
          .position_m = Vec2(p.x_m, p.y_m),
          .velocity_mps = Vec2(p.vx_mps, p.vy_mps),
          .lateness_us = p.lateness_us,
          .mode = p.mode,
          .goal = p.goal,
          .neighbours = p.neighbours,
          .plan_version = p.plan_version,
          .plan_time_s = p.plan_time_s,
          .reference_x_m = p.reference_x_m,
          .reference_y_m = p.reference_y_m};
}

bool can_be_step(const Packed& p) {
  const auto in_range = [](double value) { return std::abs(value) <= kMost; };  // not for NaN
  return p.stamp_ns > 0 && in_range(p.x_m) && in_range(p.y_m) && in_range(p.vx_mps) &&
         in_range(p.vy_mps);
}

Packed load(const std::array<Part, kParts>& parts) {
  Parts copy{};
  for (std::size_t i = 0; i < kParts; ++i) copy[i] = parts[i].load(std::memory_order_acquire);
  return std::bit_cast<Packed>(copy);
}

constexpr std::size_t kSlotBytes = sizeof(Part) * (1 + kSteps * kParts);

std::size_t bytes_for(std::uint32_t count) { return sizeof(Header) + count * kSlotBytes; }

tl::unexpected<Error> no_memory() {
  return fail(ErrorCode::kEnvironment,
              fmt::format("no memory to share with processes: {}", std::strerror(errno)));
}

}  // namespace

struct SharedSteps::Slot {
  Part steps_made;  ///< step number n (from 0) is at n % kSteps
  std::array<std::array<Part, kParts>, kSteps> steps;
};

// The size is sealed: a process that uses a file which another one has cut is killed. So is one
// that writes to a page for which there is no memory left, so all of it is taken now.
Result<SharedSteps> SharedSteps::make(RobotId first, std::uint32_t count) {
  SWARM_ASSERT(count <= kMostRobots);
  SharedSteps made(::memfd_create("swarmflow-steps", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  const Header header{.magic = kMagic, .first = first.value(), .count = count};
  const bool is_made =
      made.fd_ >= 0 && ::fallocate(made.fd_, 0, 0, static_cast<off_t>(bytes_for(count))) == 0 &&
      ::pwrite(made.fd_, &header, sizeof(header), 0) == sizeof(header) &&
      ::fcntl(made.fd_, F_ADD_SEALS, F_SEAL_GROW | F_SEAL_SHRINK | F_SEAL_SEAL) == 0;
  if (!is_made) return no_memory();
  if (auto mapped = made.map(); !mapped) return tl::unexpected(mapped.error());
  return made;
}

Result<SharedSteps> SharedSteps::open(const std::string& path) {
  SharedSteps opened(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (opened.fd_ < 0) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("cannot open {}: {}", path, std::strerror(errno)));
  }
  if (auto mapped = opened.map(); !mapped) return tl::unexpected(mapped.error());
  return opened;
}

/// The header is read once: what another process writes there later changes nothing here.
Result<void> SharedSteps::map() {
  struct stat file = {};
  Header header{};
  const int seals = ::fcntl(fd_, F_GET_SEALS);  // −1: not such memory
  const bool fits = seals >= 0 && (seals & F_SEAL_SHRINK) != 0 &&
                    ::pread(fd_, &header, sizeof(header), 0) == sizeof(header) &&
                    header.magic == kMagic && header.count <= kMostRobots &&
                    ::fstat(fd_, &file) == 0 &&
                    static_cast<std::size_t>(file.st_size) == bytes_for(header.count);
  if (!fits) return fail(ErrorCode::kBadInput, "the file is not the shared steps of a run");
  void* const memory =
      ::mmap(nullptr, bytes_for(header.count), PROT_READ | PROT_WRITE, MAP_SHARED, fd_, 0);
  if (memory == MAP_FAILED) return no_memory();
  static_assert(sizeof(Slot) == kSlotBytes);
  slots_ = reinterpret_cast<Slot*>(static_cast<unsigned char*>(memory) + sizeof(Header));
  first_ = RobotId(header.first);
  count_ = header.count;
  return {};
}

SharedSteps::~SharedSteps() {
  if (slots_ != nullptr) {
    ::munmap(reinterpret_cast<unsigned char*>(slots_) - sizeof(Header), bytes_for(count_));
  }
  if (fd_ >= 0) ::close(fd_);
}

std::string SharedSteps::path() const { return fmt::format("/proc/{}/fd/{}", ::getpid(), fd_); }

SharedSteps::Slot& SharedSteps::slot(RobotId robot) const {
  SWARM_ASSERT(has(robot));
  return slots_[robot.value() - first_.value()];
}

// A process that is killed in between has changed a step that is not counted yet.
void SharedSteps::record(RobotId robot, const robot_log::Step& step) {
  Slot& own = slot(robot);
  const std::uint64_t number = own.steps_made.load(std::memory_order_relaxed);
  const auto parts = std::bit_cast<Parts>(pack(step));
  for (std::size_t i = 0; i < kParts; ++i) {
    own.steps[number % kSteps][i].store(parts[i], std::memory_order_release);
  }
  own.steps_made.store(number + 1, std::memory_order_release);
}

std::vector<robot_log::Step> SharedSteps::last(RobotId robot) const {
  const Slot& of = slot(robot);
  std::vector<robot_log::Step> steps;
  for (int tries = 0; tries < kTries; ++tries) {
    steps.clear();
    const std::uint64_t made = of.steps_made.load(std::memory_order_acquire);
    for (std::uint64_t number = made - std::min<std::uint64_t>(made, 2); number < made; ++number) {
      const Packed packed = load(of.steps[number % kSteps]);
      // Without the newest one an older one would be taken for it.
      if (can_be_step(packed)) {
        steps.push_back(unpack(packed));
      } else {
        steps.clear();
      }
    }
    // The older of the two is overwritten two steps later.
    if (of.steps_made.load(std::memory_order_acquire) - made < kSteps - 2) return steps;
  }
  return {};
}

}  // namespace swarm::shell
