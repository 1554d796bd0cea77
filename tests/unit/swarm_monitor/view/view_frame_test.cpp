// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/view_frame.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "swarm_monitor/view/view_frame_reader.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::monitor {
namespace {

/// Reads a frame number by number, in the order of PROTOCOL.md.
class ByteReader {
 public:
  explicit ByteReader(const std::vector<std::byte>& bytes) : bytes_(bytes) {}
  template <class T>
  T next() {
    T value{};
    EXPECT_LE(at_ + sizeof(T), bytes_.size());
    if (at_ + sizeof(T) <= bytes_.size()) std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  const std::vector<std::byte>& bytes_;
  std::size_t at_ = 0;
};

std::optional<Mixture> two_components() {
  Mat2 covariance;
  covariance << 4.0, 0.5, 0.5, 1.0;
  auto mixture = Mixture::make({{0.25, Gaussian::from_valid({1, 2}, covariance)},
                                {0.75, Gaussian::from_valid({-3, 4}, Mat2::Identity())}});
  EXPECT_TRUE(mixture.has_value());
  return *mixture;
}

TEST(ViewFrame, IsTheTableOfTheProtocol) {
  const auto mixture = two_components();
  std::vector<std::byte> bytes(99);  // an earlier frame, which is replaced
  ViewFrameEncoder encoder(bytes, 2, 12.5, 1, mixture);
  encoder.add({.position_m = {7.5, -8.25},
               .heading_rad = 0.5,
               .mode = RobotMode::kMoving,
               .goal = 3,
               .neighbours = 9,
               .was_received = true,
               .lost = true});
  encoder.add({.arrived = true});
  encoder.finish(RobotId(1), {{RobotId(0), {7.0, -8.0}}});

  ByteReader reader(bytes);
  for (const char c : {'S', 'W', 'F', '1'}) EXPECT_EQ(reader.next<char>(), c);
  EXPECT_EQ(reader.next<std::uint32_t>(), 2U);
  EXPECT_EQ(reader.next<double>(), 12.5);
  EXPECT_EQ(reader.next<std::uint32_t>(), 1U) << "phase";
  EXPECT_EQ(reader.next<std::uint32_t>(), 2U) << "components";
  for (const float value : {7.5F, -8.25F, 0.5F}) EXPECT_EQ(reader.next<float>(), value);
  for (const int value : {1, 3, 1 | 4, 9}) EXPECT_EQ(reader.next<std::uint8_t>(), value);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(reader.next<float>(), 0.0F);
  for (const int value : {0, 255, 2, 0}) EXPECT_EQ(reader.next<std::uint8_t>(), value);
  for (const float value :
       {1.0F, 2.0F, 4.0F, 0.5F, 1.0F, 0.25F, -3.0F, 4.0F, 1.0F, 0.0F, 1.0F, 0.75F}) {
    EXPECT_EQ(reader.next<float>(), value);
  }
  EXPECT_EQ(reader.next<std::uint32_t>(), 1U) << "the robot in focus";
  EXPECT_EQ(reader.next<std::uint32_t>(), 1U) << "its estimates";
  EXPECT_EQ(reader.next<std::uint32_t>(), 0U);
  for (const float value : {7.0F, -8.0F}) EXPECT_EQ(reader.next<float>(), value);
  EXPECT_TRUE(reader.at_end());
}

TEST(ViewFrame, OfNothingIsAHeadAndATail) {
  std::vector<std::byte> bytes;
  ViewFrameEncoder(bytes, 0, 0.0, kEndedPhase, std::nullopt).finish(std::nullopt, {});

  ASSERT_EQ(bytes.size(), 24U + 8U);
  ByteReader reader(bytes);
  for (int k = 0; k < 4; ++k) reader.next<std::uint32_t>();
  EXPECT_EQ(reader.next<std::uint32_t>(), 4U) << "ended";
  EXPECT_EQ(reader.next<std::uint32_t>(), 0U);
  EXPECT_EQ(reader.next<std::uint32_t>(), 0xFFFF'FFFFU) << "no robot in focus";
  EXPECT_EQ(reader.next<std::uint32_t>(), 0U);
  const auto read = read_view_frame(bytes);
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->robots.empty() && read->mixture.empty());
}

TEST(ViewFrame, IsReadAsItWasWritten) {
  Rng rng(12);
  for (int round = 0; round < 50; ++round) {
    const std::size_t robots = rng() % 40;
    const auto mixture = round % 3 == 0 ? std::nullopt : two_components();
    std::vector<FrameRobot> written;
    std::vector<std::byte> bytes;
    ViewFrameEncoder encoder(bytes, static_cast<std::uint32_t>(robots), 1.0, 1, mixture);
    for (std::size_t i = 0; i < robots; ++i) {
      written.push_back({.position_m = {uniform(rng, -1e4, 1e4), uniform(rng, -1e4, 1e4)},
                         .heading_rad = uniform(rng, -3.2, 3.2),
                         .was_received = rng() % 2 == 0,
                         .arrived = rng() % 2 == 0});
      encoder.add(written.back());
    }
    encoder.finish(std::nullopt, {});

    const auto read = read_view_frame(bytes);

    ASSERT_TRUE(read);
    ASSERT_EQ(read->robots.size(), robots);
    for (std::size_t i = 0; i < robots; ++i) {
      EXPECT_EQ(read->robots[i].x_m,
                static_cast<double>(static_cast<float>(written[i].position_m.x())));
      EXPECT_EQ(read->robots[i].y_m, static_cast<float>(written[i].position_m.y()));
      EXPECT_EQ(read->robots[i].heading, static_cast<float>(written[i].heading_rad));
      EXPECT_EQ(read->robots[i].was_received, written[i].was_received);
    }
    ASSERT_EQ(read->mixture.size(), mixture ? 2U : 0U);
    if (!mixture) continue;
    EXPECT_EQ(read->mixture[0].xy, 0.5F);
    EXPECT_EQ(read->mixture[1].weight, 0.75F);
  }
}

TEST(ViewFrameReader, RefusesCountsBeyondTheBytes) {
  std::vector<std::byte> bytes;
  ViewFrameEncoder(bytes, 0, 0.0, 0, std::nullopt).finish(std::nullopt, {});
  // A product of 2³² − 1 with the size of an entry does not fit into 32 bits.
  for (const std::size_t count_at : {4U, 20U}) {
    for (const std::uint32_t count : {1U, 0x1000'0000U, 0xFFFF'FFFFU}) {
      std::vector<std::byte> changed = bytes;
      std::memcpy(changed.data() + count_at, &count, sizeof(count));
      EXPECT_FALSE(read_view_frame(changed)) << count << " at byte " << count_at;
    }
  }
}

TEST(ViewFrameReader, RefusesAnotherMagicAndTakesAnyOtherBytes) {
  std::vector<std::byte> bytes;
  ViewFrameEncoder(bytes, 0, 0.0, 0, std::nullopt).finish(std::nullopt, {});
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<std::byte> changed = bytes;
    changed[k] ^= std::byte{0x20};
    EXPECT_FALSE(read_view_frame(changed)) << k;
  }
  Rng rng(9);
  for (int round = 0; round < 500; ++round) {
    std::vector<std::byte> rubbish(rng() % 200);
    for (std::byte& b : rubbish) b = static_cast<std::byte>(rng() & 0xFFU);
    if (round % 2 == 0 && rubbish.size() >= 24) {
      std::memcpy(rubbish.data(), bytes.data(), 4);
      rubbish[4] &= std::byte{7};  // few robots and components, so that some frames fit
      for (const std::size_t k : {5U, 6U, 7U, 21U, 22U, 23U}) rubbish[k] = std::byte{0};
      rubbish[20] &= std::byte{3};
    }
    const auto read = read_view_frame(rubbish);
    if (!read) continue;
    EXPECT_LE(24 + 16 * read->robots.size() + 24 * read->mixture.size(), rubbish.size());
  }
}

TEST(ViewFrame, BeginsAtTheOriginUnlessTheWorldIsFarAway) {
  EXPECT_EQ(view_origin_m({{-50, -50}, {1000, 4096}}), Vec2(0, 0));
  EXPECT_EQ(view_origin_m({{500'300, 5'700'900}, {500'400, 5'701'000}}), Vec2(500'000, 5'701'000));
  EXPECT_EQ(view_origin_m({{-9'400, 0}, {-9'300, 10}}), Vec2(-9'000, 0));
}

// Coordinates of a map of Europe: a float there is half a metre off.
TEST(ViewFrame, IsExactFarFromTheOrigin) {
  const Vec2 corner_m(512'345, 5'412'345);
  const Vec2 origin_m = view_origin_m({corner_m, corner_m + Vec2(200, 160)});
  const Vec2 at_m = corner_m + Vec2(12.34, 56.78);
  const auto mixture = Mixture::make({{1.0, Gaussian::from_valid(at_m, Mat2::Identity())}});
  std::vector<std::byte> bytes;
  const std::optional<Mixture> planned = *mixture;
  ViewFrameEncoder encoder(bytes, 1, 0.0, 1, planned);
  encoder.set_origin(origin_m);
  encoder.add({.position_m = at_m, .was_received = true});
  encoder.finish(std::nullopt, {});

  const auto read = read_view_frame(bytes, origin_m);

  ASSERT_TRUE(read);
  EXPECT_NEAR(read->robots[0].x_m, at_m.x(), 1e-3);
  EXPECT_NEAR(read->robots[0].y_m, at_m.y(), 1e-3);
  EXPECT_NEAR(read->mixture[0].x_m, at_m.x(), 1e-3);
  EXPECT_NEAR(read->mixture[0].y_m, at_m.y(), 1e-3);
}

}  // namespace
}  // namespace swarm::monitor
