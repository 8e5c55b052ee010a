/// ROS 2 topics over Cyclone DDS: a participant with typed readers and writers.
///
/// ROS 2 adds the prefix "rt" to topic names. Sensor readers request best effort and volatile,
/// which is compatible with every writer. Own topics are reliable and transient local with depth
/// one: latched topics in ROS terms.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "clients/ros2/messages.h"

namespace skycap::ros2 {

/// DDS handle that deletes all its child entities on destruction.
class DdsEntity {
 public:
  /// Throws Error{bad_usage} with `what` and the DDS error text if the handle is an error code.
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
  /// Joins a domain (ROS_DOMAIN_ID) with the settings of the environment variable CYCLONEDDS_URI.
  explicit Participant(std::uint32_t domain);
};

enum class ReaderQos {
  sensor,   ///< Best effort, volatile.
  command,  ///< Reliable, volatile.
  latched,  ///< Reliable, transient local.
};

enum class Writing {
  sensor,   ///< Best effort, volatile.
  command,  ///< Reliable, volatile.
  latched,  ///< Reliable, transient local, last message only.
};

/// Untyped topic reader. Queues up to `depth` messages; older ones are lost.
class AnyReader : public DdsEntity {
 public:
  AnyReader(const Participant& participant, const dds_topic_descriptor_t& type,
            const std::string& topic, ReaderQos qos_kind, int depth);

 protected:
  /// Passes the oldest queued message to `receive`. Returns false if the queue is empty.
  bool take_one(const std::function<void(const void*)>& receive) const;
};

template <typename Message>
class Reader : public AnyReader {
 public:
  Reader(const Participant& participant, const std::string& topic, ReaderQos qos_kind, int depth)
      : AnyReader(participant, descriptor<Message>(), topic, qos_kind, depth) {}

  /// Passes all queued messages to `receive`, in order of arrival.
  template <typename Receive>
  void take(const Receive& receive) const {
    while (take_one([&](const void* message) { receive(*static_cast<const Message*>(message)); })) {
    }
  }
};

/// Untyped topic writer.
class AnyWriter : public DdsEntity {
 public:
  AnyWriter(const Participant& participant, const dds_topic_descriptor_t& type,
            const std::string& topic, Writing writing);

  /// Returns the current number of readers.
  int readers() const;
  /// Waits until all readers have received the messages, at most 0.5 s.
  void flush() const;

 protected:
  void write_one(const void* message) const;
};

template <typename Message>
class Writer : public AnyWriter {
 public:
  Writer(const Participant& participant, const std::string& topic, Writing writing)
      : AnyWriter(participant, descriptor<Message>(), topic, writing) {}

  /// Throws Error{bad_usage} if DDS rejects the message.
  void write(const Message& message) const { write_one(&message); }
};

/// DDS wait set on a group of readers.
class WaitSet : public DdsEntity {
 public:
  explicit WaitSet(const Participant& participant);
  void add(const AnyReader& reader) const;
  /// Waits until a reader has a message, at most `seconds` [s].
  void wait(double seconds) const;
};

}  // namespace skycap::ros2
