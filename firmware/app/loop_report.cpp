#include "firmware/app/loop_report.h"

#include <unistd.h>

#include <fstream>
#include <ostream>

#include "firmware/app/heap_counter.h"

namespace armada {
namespace {

void Put(std::ostream& out, const char* name, const DurationHistogram& histogram) {
  out << "    \"" << name << "_us\": {\"p50\": " << histogram.PercentileUs(0.5)
      << ", \"p99\": " << histogram.PercentileUs(0.99) << ", \"p99.9\": " << histogram.PercentileUs(0.999)
      << ", \"max\": " << histogram.max_us() << "},\n";
}

void PutHeard(std::ostream& out, const std::vector<HeardSender>& senders) {
  const char* separator = "";
  out << "    \"lcm_heard\": [";
  for (const HeardSender& sender : senders) {
    out << separator << "{\"from\": " << sender.arm_id << ", \"accepted\": " << sender.accepted
        << ", \"missed\": " << sender.missed << "}";
    separator = ", ";
  }
  out << "]\n";
}

int64_t ResidentBytes() {
  std::ifstream statm("/proc/self/statm");
  int64_t total_pages = 0;
  int64_t resident_pages = 0;
  statm >> total_pages >> resident_pages;
  return resident_pages * sysconf(_SC_PAGESIZE);
}

}  // namespace

void WriteLoopReport(const ArmLoop& loop, const ArmNode& node, const CanBus& bus, const LcmEndpoint& link,
                     const RealtimeGrant& grant, std::ostream& out) {
  const LoopReport& report = loop.report();
  out << "{\n  \"id\": " << node.id() << ",\n  \"state\": \"" << NameOf(loop.final_state())
      << "\",\n  \"faults\": [";
  if (HasStopped(loop.final_state()) && node.cause() != Cause::kNone)
    out << '"' << NameOf(node.cause()) << '"';
  out << "],\n  \"timing\": {\n";
  Put(out, "wakeup_lateness", report.wakeup_lateness);
  Put(out, "compute", report.compute);
  Put(out, "sample_to_torque", report.sample_to_torque);
  out << "    \"ticks\": " << report.ticks << ",\n    \"missed_ticks\": " << report.missed_ticks
      << ",\n    \"incomplete_samples\": " << report.incomplete_samples
      << ",\n    \"unsent_ticks\": " << report.unsent_ticks
      << ",\n    \"realtime_priority\": " << (grant.fifo ? "true" : "false") << "\n  },\n";
  out << "  \"memory\": {\n    \"heap_allocations\": ";
  if (HeapCounter::available()) {
    out << report.heap_allocations;
  } else {
    out << "null";  // a build with sanitizers cannot count
  }
  out << ",\n    \"page_faults\": " << report.page_faults << ",\n    \"resident_bytes\": " << ResidentBytes()
      << ",\n    \"locked\": " << (grant.memory_locked ? "true" : "false") << "\n  },\n";
  const BusCounters& can = bus.counters();
  const LcmCounters& lcm = link.counters();
  const RejectedMessages& rejected = node.rejected_messages();
  out << "  \"bus\": {\n    \"can_sent\": " << can.sent << ",\n    \"can_received\": " << can.received
      << ",\n    \"can_dropped\": " << can.dropped_queue_full << ",\n    \"can_malformed\": " << can.malformed
      << ",\n    \"can_nonsense\": " << node.malformed_frames()
      << ",\n    \"can_dropped_late\": " << can.dropped_late << ",\n    \"can_replaced\": " << can.replaced
      << ",\n    \"can_receive_overflowed\": " << can.receive_overflowed
      << ",\n    \"can_error_passive\": " << can.error_passive << ",\n    \"can_bus_off\": " << can.bus_off
      << ",\n    \"can_restarts\": " << can.restarts << ",\n    \"can_errors\": " << can.errors
      << ",\n    \"lcm_sent\": " << lcm.sent << ",\n    \"lcm_received\": " << lcm.received
      << ",\n    \"lcm_rejected\": " << node.rejected_count() << ",\n    \"lcm_forged\": " << rejected.forged
      << ",\n    \"lcm_replayed\": " << rejected.replayed << ",\n    \"lcm_late\": " << rejected.late
      << ",\n    \"lcm_implausible\": " << rejected.implausible
      << ",\n    \"lcm_malformed\": " << lcm.malformed << ",\n    \"lcm_overflowed\": " << lcm.overflowed
      << ",\n";
  PutHeard(out, node.heard_senders());
  out << "  }\n}\n";
}

}  // namespace armada
