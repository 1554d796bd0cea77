// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

#include "swarmflow/robot/control_method.hpp"

namespace swarm::agent {

/// Owns one control method of any class, like a std::unique_ptr. A method of at most kInline_bytes
/// that can be moved without exceptions is stored inside the slot, so that a simulation reads a
/// robot from contiguous memory; another one is on the heap. Can be moved, not copied; moving a
/// slot moves a method stored inside, so its address changes.
class ControlSlot {
 public:
  /// Size of the largest method that is stored inside [bytes].
  static constexpr std::size_t kInline_bytes = 576;

  /// An empty slot.
  ControlSlot() = default;

  /// A slot with a new method: `ControlSlot::of<Spiral>(options)`.
  /// \tparam Method a class derived from ControlMethod
  /// \param args arguments of its constructor
  template <class Method, class... Args>
  static ControlSlot of(Args&&... args) {
    ControlSlot slot;
    if constexpr (fits<Method>()) {
      slot.method_ = ::new (slot.room_) Method(std::forward<Args>(args)...);
      slot.move_to_ = [](ControlMethod* from, std::byte* room) -> ControlMethod* {
        auto* method = static_cast<Method*>(from);
        auto* moved = ::new (room) Method(std::move(*method));
        method->~Method();
        return moved;
      };
    } else {
      slot.method_ = new Method(std::forward<Args>(args)...);
    }
    return slot;
  }

  /// A slot that takes over a method from the heap.
  static ControlSlot of(std::unique_ptr<ControlMethod> method) {
    ControlSlot slot;
    slot.method_ = method.release();
    return slot;
  }

  /// Takes over the method of another slot, which is empty afterwards.
  ControlSlot(ControlSlot&& other) noexcept { take(other); }
  /// Destroys the own method and takes over that of another slot, which is empty afterwards.
  ControlSlot& operator=(ControlSlot&& other) noexcept {
    if (this == &other) return *this;
    clear();
    take(other);
    return *this;
  }
  ControlSlot(const ControlSlot&) = delete;
  ControlSlot& operator=(const ControlSlot&) = delete;
  /// Destroys the method.
  ~ControlSlot() { clear(); }

  /// The method. \pre the slot is not empty; not checked
  ControlMethod& operator*() const { return *method_; }
  /// The method; null for an empty slot.
  ControlMethod* operator->() const { return method_; }
  /// Whether the slot has a method.
  explicit operator bool() const { return method_ != nullptr; }

 private:
  template <class Method>
  static constexpr bool fits() {
    return sizeof(Method) <= kInline_bytes && alignof(Method) <= alignof(std::max_align_t) &&
           std::is_nothrow_move_constructible_v<Method>;
  }

  void take(ControlSlot& other) noexcept {
    move_to_ = std::exchange(other.move_to_, nullptr);
    method_ = std::exchange(other.method_, nullptr);
    if (move_to_ != nullptr) method_ = move_to_(method_, room_);
  }

  void clear() {
    if (method_ == nullptr) return;
    if (move_to_ != nullptr) {
      method_->~ControlMethod();
    } else {
      delete method_;
    }
    method_ = nullptr;
    move_to_ = nullptr;
  }

  ControlMethod* method_ = nullptr;
  ControlMethod* (*move_to_)(ControlMethod*, std::byte*) = nullptr;  // null: on the heap
  alignas(std::max_align_t) std::byte room_[kInline_bytes];
};

}  // namespace swarm::agent
