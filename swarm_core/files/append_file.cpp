// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/files/append_file.hpp"

#include <cerrno>
#include <cstddef>

namespace swarm::files {
namespace {

/// With these errors the descriptor stays good; after others the file is opened anew.
bool is_lack_of_room(int error) { return error == ENOSPC || error == EDQUOT || error == EAGAIN; }

}  // namespace

int AppendFile::open(Disk& disk) {
  const auto opened = disk.open(format_.file);
  if (!opened) return opened.error();
  fd_ = *opened;
  auto state = disk.state(fd_);
  if (!state) {
    close(disk);
    return state.error();
  }
  remove_end(disk, *state);
  unsigned char last = 0;
  const Bytes& ending = format_.record_end;
  // An earlier writer may have been killed within a record.
  if (!ending.empty() && state->is_regular && state->size > 0 &&
      disk.read_at(fd_, state->size - 1, {&last, 1}) == 1U && last != ending.back()) {
    is_torn_ = true;
  }
  return 0;
}

/// An earlier writer that finished left its end, behind which no reader looks for records.
void AppendFile::remove_end(Disk& disk, Disk::State& state) {
  const std::size_t length = format_.end.size();
  if (length == 0 || !state.is_regular || state.size < length) return;
  buffer_.resize(length);
  const std::uint64_t begin = state.size - length;
  if (disk.read_at(fd_, begin, buffer_) != length || buffer_ != format_.end) return;
  if (disk.truncate(fd_, begin) == 0) state.size = begin;
}

int AppendFile::append(Disk& disk, std::span<const unsigned char> bytes) {
  if (fd_ < 0) {
    if (const int error = open(disk); error != 0) return error;
  }
  auto state = disk.state(fd_);
  if (state && !state->is_linked) {
    close(disk);
    ++times_removed_;
    is_torn_ = false;
    if (const int error = open(disk); error != 0) return error;
    state = disk.state(fd_);
  }
  if (!state) {
    close(disk);
    return state.error();
  }
  buffer_.clear();
  const auto put = [this](const Bytes& part) {
    buffer_.insert(buffer_.end(), part.begin(), part.end());
  };
  const bool is_empty = state->is_regular && state->size == 0;
  if (is_empty) put(format_.preamble);
  if (is_torn_ && !is_empty) put(format_.record_end);
  if (is_empty || !has_begun_) put(format_.begin);
  int error = 0;
  if (buffer_.empty()) {
    error = write_whole(disk, *state, bytes);
  } else {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    error = write_whole(disk, *state, buffer_);
  }
  if (error == 0) {
    has_begun_ = true;
  } else if (!is_lack_of_room(error)) {
    close(disk);
  }
  return error;
}

int AppendFile::write_whole(Disk& disk, const Disk::State& before,
                            std::span<const unsigned char> bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const auto written = disk.write(fd_, bytes.subspan(done));
    if (written) {
      done += *written;
      continue;
    }
    // A part of a record would hide the next one from a simple reader.
    if (done > 0) is_torn_ = !before.is_regular || disk.truncate(fd_, before.size) != 0;
    return written.error();
  }
  is_torn_ = false;
  return 0;
}

int AppendFile::finish(Disk& disk) {
  if (fd_ < 0) return 0;
  int error = 0;
  // An empty file gets no end: without a begin it could not be read.
  if (const auto state = disk.state(fd_); state && state->size > 0 && !format_.end.empty()) {
    error = write_whole(disk, *state, format_.end);
  }
  close(disk);
  return error;
}

void AppendFile::close(Disk& disk) {
  if (fd_ >= 0) disk.close(std::exchange(fd_, -1));
}

}  // namespace swarm::files
