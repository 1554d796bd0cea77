// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

/// The fields of a message, listed once beside its members. The bytes on the wire, the bounds and
/// the JSON of a message are derived from this list; no other code names its fields.
namespace swarm::link {

/// A sequence or text with its bound in the IDL.
template <class M, class T>
struct BoundedMember {
  T M::*member;       ///< to the field
  std::size_t bound;  ///< most elements, or characters of a text
};
/// An entry of a field list with its bound: up_to(5, &M::b).
template <class M, class T>
consteval BoundedMember<M, T> up_to(std::size_t bound, T M::*member) {
  return {member, bound};
}

/// `static constexpr FieldList<&M::a, up_to(5, &M::b)> kFields{}` of message M, in the order of the
/// IDL. Beside it stands `kIdlName`, the struct's name in idl/swarm.idl, and in a message that has
/// its first field as key `kKeyed`.
template <auto... Entries>
struct FieldList {};

/// "x_m" of &M::x_m, as the compiler spells it: a name that is written once cannot be wrong.
template <auto Member>
constexpr std::string_view member_name() {
  std::string_view text = __PRETTY_FUNCTION__;
  text.remove_prefix(text.find("Member = ") + 9);
  text = text.substr(0, text.find_first_of(";]"));
  return text.substr(text.rfind(':') + 1);
}

/// Type, member pointer, bound (0: none) and name of one entry of a field list.
template <auto Entry>
struct Field;
template <class M, class T, T M::*Member>
struct Field<Member> {
  using Type = T;
  static constexpr T M::*kMember = Member;
  static constexpr std::size_t kBound = 0;
  static constexpr std::string_view kName = member_name<Member>();
};
template <class M, class T, BoundedMember<M, T> Bounded>
struct Field<Bounded> {
  using Type = T;
  static constexpr T M::*kMember = Bounded.member;
  static constexpr std::size_t kBound = Bounded.bound;
  static constexpr std::string_view kName = member_name<Bounded.member>();
};

/// A struct with a list of fields.
template <class T>
concept Message = requires {
  T::kFields;
};
/// Whether T is a sequence of the IDL.
template <class T>
constexpr bool kIsSequence = false;
template <class T>
constexpr bool kIsSequence<std::vector<T>> = true;
/// Whether T is an array of the IDL, whose length is part of its type.
template <class T>
constexpr bool kIsArray = false;
template <class T, std::size_t N>
constexpr bool kIsArray<std::array<T, N>> = true;
/// Whether T is a string of the IDL.
template <class T>
constexpr bool kIsText = std::is_same_v<T, std::string>;

/// Calls visit(Field<...>()) for each field of M, in order, as long as it returns true.
template <Message M, class Visit>
constexpr bool all_fields(Visit visit) {
  return [&]<auto... Entries>(FieldList<Entries...>) { return (visit(Field<Entries>()) && ...); }
  (M::kFields);
}
/// Calls visit(Field<...>()) for each field of M, in order.
template <Message M, class Visit>
constexpr void for_each_field(Visit visit) {
  [&]<auto... Entries>(FieldList<Entries...>) { (visit(Field<Entries>()), ...); }
  (M::kFields);
}

/// Whether a T contains a sequence, at any depth: then its size depends on its values, texts apart,
/// which are as long as their bound at most.
template <class T>
constexpr bool contains_sequence() {
  if constexpr (kIsSequence<T>) {
    return true;
  } else if constexpr (Message<T>) {
    bool contains = false;
    for_each_field<T>([&](auto field) {
      contains = contains || contains_sequence<typename decltype(field)::Type>();
    });
    return contains;
  } else {
    return false;
  }
}

/// Whether the first field is the key of the topic: then each value of it is an instance of its
/// own.
template <Message M>
constexpr bool keyed() {
  if constexpr (requires { M::kKeyed; }) {
    return M::kKeyed;
  } else {
    return false;
  }
}

}  // namespace swarm::link
