#include "clients/ros2/dds_ports.h"

#include <memory>

#include <dds/dds.h>

#include "geometry/error.h"

namespace skycap::ros2 {
namespace {

[[noreturn]] void fail(const std::string& what, dds_return_t code) {
  throw Error(ErrorKind::bad_usage, what + ": " + dds_strretcode(-code));
}

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

Qos qos(bool is_reliable, bool is_latched, int depth) {
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_reliability(
      qos.get(), is_reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, DDS_SECS(1));
  dds_qset_durability(qos.get(),
                      is_latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  return qos;
}

/// Creates a topic. Topics need no owner, because the participant deletes them.
dds_entity_t topic(const Participant& participant, const dds_topic_descriptor_t& type,
                   const std::string& name) {
  if (name.size() < 2 || name.front() != '/') {
    throw Error(ErrorKind::bad_usage,
                "the topic '" + name + "' must begin with '/', for example '/odom'");
  }
  const dds_entity_t handle =
      dds_create_topic(participant.handle(), &type, ("rt" + name).c_str(), nullptr, nullptr);
  if (handle < 0) fail("topic " + name, handle);
  return handle;
}

}  // namespace

DdsEntity::DdsEntity(std::int32_t handle, const std::string& what) : handle_(handle) {
  if (handle < 0) fail(what, handle);
}

DdsEntity::~DdsEntity() { dds_delete(handle_); }

Participant::Participant(std::uint32_t domain)
    : DdsEntity(dds_create_participant(domain, nullptr, nullptr),
                "DDS domain " + std::to_string(domain)) {}

AnyReader::AnyReader(const Participant& participant, const dds_topic_descriptor_t& type,
                     const std::string& name, ReaderQos qos_kind, int depth)
    : DdsEntity(dds_create_reader(
                    participant.handle(), topic(participant, type, name),
                    qos(qos_kind != ReaderQos::sensor, qos_kind == ReaderQos::latched, depth).get(),
                    nullptr),
                "topic " + name) {}

bool AnyReader::take_one(const std::function<void(const void*)>& receive) const {
  void* sample = nullptr;
  dds_sample_info_t info;
  const dds_return_t count = dds_take(handle(), &sample, &info, 1, 1);
  if (count <= 0) return false;
  struct LoanGuard {
    dds_entity_t reader;
    void** sample;
    ~LoanGuard() { dds_return_loan(reader, sample, 1); }
  } const guard{handle(), &sample};
  if (info.valid_data) receive(sample);
  return true;
}

AnyWriter::AnyWriter(const Participant& participant, const dds_topic_descriptor_t& type,
                     const std::string& name, Writing writing)
    : DdsEntity(dds_create_writer(participant.handle(), topic(participant, type, name),
                                  qos(writing != Writing::sensor, writing == Writing::latched,
                                      writing == Writing::latched ? 1 : 1000)
                                      .get(),
                                  nullptr),
                "topic " + name) {}

int AnyWriter::readers() const {
  dds_publication_matched_status_t status;
  if (dds_get_publication_matched_status(handle(), &status) < 0) return 0;
  return static_cast<int>(status.current_count);
}

void AnyWriter::flush() const { dds_wait_for_acks(handle(), DDS_MSECS(500)); }

void AnyWriter::write_one(const void* message) const {
  if (const dds_return_t code = dds_write(handle(), message); code < 0) fail("a message", code);
}

WaitSet::WaitSet(const Participant& participant)
    : DdsEntity(dds_create_waitset(participant.handle()), "waiting") {}

void WaitSet::add(const AnyReader& reader) const {
  const dds_entity_t any = dds_create_readcondition(reader.handle(), DDS_ANY_STATE);
  if (any < 0) fail("waiting", any);
  if (const dds_return_t code = dds_waitset_attach(handle(), any, 0); code < 0) {
    fail("waiting", code);
  }
}

void WaitSet::wait(double seconds) const {
  dds_waitset_wait(handle(), nullptr, 0, static_cast<dds_duration_t>(seconds * 1e9));
}

}  // namespace skycap::ros2
