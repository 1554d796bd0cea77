// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

namespace swarm {

/// A value that many have in common and nobody changes: its copies are one in memory, so that what
/// a thousand robots have alike is in the cache.
template <class T>
class Shared {
 public:
  Shared() : value_(initial()) {}
  /*implicit*/ Shared(T value) : value_(std::make_shared<const T>(std::move(value))) {}

  const T& operator*() const { return *value_; }
  const T* operator->() const { return value_.get(); }

  /// A member of it, which keeps the whole alive.
  template <class Part>
  Shared<Part> part(Part T::*member) const {
    Shared<Part> part;
    part.value_ = std::shared_ptr<const Part>(value_, &((*value_).*member));
    return part;
  }

 private:
  static const std::shared_ptr<const T>& initial() {
    static const std::shared_ptr<const T> value = std::make_shared<const T>();
    return value;
  }

  template <class>
  friend class Shared;
  std::shared_ptr<const T> value_;
};

}  // namespace swarm
