// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarm_link/port.hpp"

namespace swarm::link {

/// A Participant made of two templates of the class that derives from it, writer(topic) and
/// reader(topic): virtual functions cannot be templates. For backs; users see Participant.
template <class Derived>
class TypedParticipant : public Participant {
 public:
  Result<WriterPtr<PlanMessage>> make_writer(const Topic<PlanMessage>& t) override {
    return self().writer(t);
  }
  Result<WriterPtr<SceneMessage>> make_writer(const Topic<SceneMessage>& t) override {
    return self().writer(t);
  }
  Result<WriterPtr<HeartbeatMessage>> make_writer(const Topic<HeartbeatMessage>& t) override {
    return self().writer(t);
  }
  Result<WriterPtr<CellStatesMessage>> make_writer(const Topic<CellStatesMessage>& t) override {
    return self().writer(t);
  }
  Result<WriterPtr<CommandMessage>> make_writer(const Topic<CommandMessage>& t) override {
    return self().writer(t);
  }
  Result<WriterPtr<StatusMessage>> make_writer(const Topic<StatusMessage>& t) override {
    return self().writer(t);
  }
  Result<WriterPtr<EventMessage>> make_writer(const Topic<EventMessage>& t) override {
    return self().writer(t);
  }
  Result<ReaderPtr<PlanMessage>> make_reader(const Topic<PlanMessage>& t) override {
    return self().reader(t);
  }
  Result<ReaderPtr<SceneMessage>> make_reader(const Topic<SceneMessage>& t) override {
    return self().reader(t);
  }
  Result<ReaderPtr<HeartbeatMessage>> make_reader(const Topic<HeartbeatMessage>& t) override {
    return self().reader(t);
  }
  Result<ReaderPtr<CellStatesMessage>> make_reader(const Topic<CellStatesMessage>& t) override {
    return self().reader(t);
  }
  Result<ReaderPtr<CommandMessage>> make_reader(const Topic<CommandMessage>& t) override {
    return self().reader(t);
  }
  Result<ReaderPtr<StatusMessage>> make_reader(const Topic<StatusMessage>& t) override {
    return self().reader(t);
  }
  Result<ReaderPtr<EventMessage>> make_reader(const Topic<EventMessage>& t) override {
    return self().reader(t);
  }

 private:
  Derived& self() { return static_cast<Derived&>(*this); }
};

}  // namespace swarm::link
