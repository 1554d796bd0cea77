// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

namespace swarm {

/// An immutable value with many owners: copies share one object in memory, so that data that is the
/// same for a thousand robots of a process stays in the cache.
template <class T>
class Shared {
 public:
  /// The default value of T, of which there is one for the whole process.
  Shared() : value_(initial()) {}
  /// Implicit, so that a value can be passed where a shared one is expected.
  /*implicit*/ Shared(T value) : value_(std::make_shared<const T>(std::move(value))) {}

  /// Access to the value, which cannot be changed.
  const T& operator*() const { return *value_; }
  const T* operator->() const { return value_.get(); }

  /// A member of the value as a shared value, which keeps the whole object alive.
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
