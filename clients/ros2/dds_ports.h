/// Topics of ROS 2 over Cyclone DDS: a participant, and typed ends of topics in it.
///
/// ROS 2 puts "rt" before a topic's name. What sensors send is asked for as best effort and
/// volatile, which goes with whatever they offer; what we say is reliable and transient local, with
/// a depth of one: ROS's latched topics.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "clients/ros2/messages.h"

namespace skycap::ros2 {

/// A handle of DDS, which goes with all that was made in it.
class DdsEntity {
 public:
  /// Throws Error{bad_usage} with `what` and DDS's own words if the handle is an error.
  DdsEntity(std::int32_t handle, const std::string& what);
  DdsEntity(const DdsEntity&) = delete;
  DdsEntity& operator=(const DdsEntity&) = delete;
  ~DdsEntity();

  std::int32_t handle() const { return handle_; }

 private:
  std::int32_t handle_;
};

class Participant : public DdsEntity {
 public:
  /// In a domain, as ROS_DOMAIN_ID has them, and as the environment's CYCLONEDDS_URI says.
  explicit Participant(std::uint32_t domain);
};

enum class Reading {
  sensor,   ///< best effort, volatile
  command,  ///< reliable, volatile
  latched,  ///< reliable, transient local
};

enum class Writing {
  sensor,   ///< best effort, volatile
  command,  ///< reliable, volatile
  latched,  ///< reliable, transient local, the last message only
};

/// The end of a topic that messages come out of; `depth` of them wait, older ones are lost.
class AnyReader : public DdsEntity {
 public:
  AnyReader(const Participant& participant, const dds_topic_descriptor_t& type,
            const std::string& topic, Reading reading, int depth);

 protected:
  /// Hands over the oldest message that waits; false if none does.
  bool take_one(const std::function<void(const void*)>& receive) const;
};

template <typename Message>
class Reader : public AnyReader {
 public:
  Reader(const Participant& participant, const std::string& topic, Reading reading, int depth)
      : AnyReader(participant, descriptor<Message>(), topic, reading, depth) {}

  /// Hands over all messages that wait, in the order in which they came.
  template <typename Receive>
  void take(const Receive& receive) const {
    while (take_one([&](const void* message) { receive(*static_cast<const Message*>(message)); })) {
    }
  }
};

/// The end of a topic that messages go into.
class AnyWriter : public DdsEntity {
 public:
  AnyWriter(const Participant& participant, const dds_topic_descriptor_t& type,
            const std::string& topic, Writing writing);

  /// Readers at present.
  int readers() const;
  /// Until all readers have what was written, half a second at most.
  void flush() const;

 protected:
  void write_one(const void* message) const;
};

template <typename Message>
class Writer : public AnyWriter {
 public:
  Writer(const Participant& participant, const std::string& topic, Writing writing)
      : AnyWriter(participant, descriptor<Message>(), topic, writing) {}

  /// Throws Error{bad_usage} if DDS does not take it.
  void write(const Message& message) const { write_one(&message); }
};

/// Waits for messages at readers.
class WaitSet : public DdsEntity {
 public:
  explicit WaitSet(const Participant& participant);
  void add(const AnyReader& reader) const;
  /// Until a message waits at one of the readers, or so long [s].
  void wait(double seconds) const;
};

}  // namespace skycap::ros2
