#include "hil/hil_server.h"

#include <algorithm>
#include <cmath>

#include "firmware/can/frame_time.h"

namespace armada {
namespace {

constexpr int64_t kTick_ns = 1'000'000;
static_assert(TrackingRecord::kSamplePeriod_s * 1e9 == kTick_ns);

// Frames of one bus handled before the others get their turn: more than come in 50 ms of the busiest arm.
constexpr int kMostFramesInTurn = 256;

// The last tick of the fleet's clock that is not after `t_ns`.
int64_t TickBefore(int64_t t_ns, int64_t epoch_ns) {
  const int64_t since_ns = t_ns - epoch_ns;
  const int64_t rest_ns = (since_ns % kTick_ns + kTick_ns) % kTick_ns;
  return t_ns - rest_ns;
}

}  // namespace

HilServer::HilServer(const ScenarioConfig& scenario, uint64_t seed, int64_t epoch_ns,
                     const std::vector<std::unique_ptr<CanBus>>& buses, const std::vector<CanLog*>& logs,
                     HilClock* clock)
    : epoch_ns_(epoch_ns), clock_(clock), latest_ns_(epoch_ns) {
  if (scenario.leader.kind != LeaderKind::kNone) leader_.emplace(scenario.leader);
  const LeaderPath* leader = leader_ ? &*leader_ : nullptr;
  const int64_t start_ns = TickBefore(clock->Now(), epoch_ns);
  next_tick_ns_ = start_ns + kTick_ns;
  arms_.reserve(buses.size());
  for (size_t i = 0; i < buses.size(); ++i) {
    const ArmEntry& entry = scenario.fleet.arms[i];
    const ArmStart start = DrawStart(scenario, i, seed, leader);
    arms_.push_back({.id = entry.id,
                     .bus_name = entry.bus,
                     .bus = buses[i].get(),
                     .log = logs.empty() ? nullptr : logs[i],
                     .bench = EmulatedArm(scenario, i, seed, start, leader, FleetTime(start_ns)),
                     .record = TrackingRecord(scenario),
                     .can = entry.can,
                     .time_ns = start_ns,
                     .next_tick_ns = next_tick_ns_,
                     .released_s = std::nullopt});
  }
}

HilEnd HilServer::Run(double seconds) {
  const int64_t end_ns = epoch_ns_ + std::llround(seconds * 1e9);
  while (clock_->WaitUntil(std::min(next_tick_ns_, end_ns))) {
    const int64_t now_ns = clock_->Now();
    const int64_t until_ns = std::min(now_ns, end_ns);
    if (next_tick_ns_ <= until_ns) TakeLiveFaults(now_ns);
    Pace(now_ns, until_ns);
    for (Arm& arm : arms_) {
      TakeFrames(arm, end_ns);
      AdvanceTo(arm, until_ns);
      if (arm.bus_down) return HilEnd::kBusDown;
    }
    if (now_ns >= end_ns) return HilEnd::kDone;
  }
  return HilEnd::kStopped;
}

void HilServer::Pace(int64_t now_ns, int64_t until_ns) {
  for (; next_tick_ns_ <= until_ns; next_tick_ns_ += kTick_ns) {
    const int64_t late_ns = now_ns - next_tick_ns_;
    if (1e-3 * static_cast<double>(late_ns) > pacing_.max_us()) latest_ns_ = next_tick_ns_;
    pacing_.Add(late_ns);
  }
}

void HilServer::TakeLiveFaults(int64_t now_ns) {
  if (live_ == nullptr) return;
  while (const auto fault = live_->Take(FleetTime(now_ns))) {
    faults_taken_.push_back(*fault);
    for (Arm& arm : arms_) {
      if (arm.id == fault->arm) arm.bench.Add(*fault);
    }
  }
}

void HilServer::TakeFrames(Arm& arm, int64_t end_ns) {
  CanFrame frame;
  for (int i = 0; i < kMostFramesInTurn; ++i) {
    const BusStatus status = arm.bus->Receive(0, &frame);
    if (status == BusStatus::kDown) arm.bus_down = true;
    if (status == BusStatus::kTimeout || status == BusStatus::kDown) return;
    if (status != BusStatus::kOk || frame.error) continue;  // counted; drives do not act on it
    const int64_t t_ns = std::max(arm.time_ns, std::min(frame.stamp_ns, end_ns));
    AdvanceTo(arm, t_ns);
    Note(arm, t_ns, frame);
    arm.bench.OnFrame(FleetTime(t_ns), frame, &out_);
    MoveBench(arm, t_ns);
  }
}

// A frame may have been taken that came after the loop looked at the clock: then time is ahead, and stays.
void HilServer::AdvanceTo(Arm& arm, int64_t t_ns) {
  for (; arm.next_tick_ns <= t_ns; arm.next_tick_ns += kTick_ns) {
    MoveBench(arm, arm.next_tick_ns);
    Sample(arm);
  }
  if (t_ns > arm.time_ns) MoveBench(arm, t_ns);
}

// Frames go out as soon as there are any. The log has the bench's time for them, so that it stays in order:
// how much later they went out is pacing's to tell.
void HilServer::MoveBench(Arm& arm, int64_t t_ns) {
  arm.time_ns = t_ns;
  arm.bench.AdvanceTo(FleetTime(t_ns), &out_);
  if (!arm.released_s && arm.bench.released()) arm.released_s = FleetTime(t_ns);
  for (const CanFrame& frame : out_) {
    const BusStatus status = arm.bus->Send(frame);
    if (status == BusStatus::kDown) arm.bus_down = true;
    if (status == BusStatus::kOk) Note(arm, t_ns, frame);
  }
  out_.Clear();
}

void HilServer::Note(Arm& arm, int64_t t_ns, const CanFrame& frame) const {
  if (arm.log != nullptr) arm.log->Record(t_ns, frame);
  if (t_ns > epoch_ns_) arm.on_wire_s += WorstFrameTime_s(frame, arm.can);
}

void HilServer::Sample(Arm& arm) {
  if (!leader_ || arm.time_ns <= epoch_ns_) return;
  const double t_s = FleetTime(arm.time_ns);
  const TaskVector target_m = leader_->At(t_s).x_m;
  const PlanarPlant::Tip tip = arm.bench.plant().EndEffector();
  arm.record.Update(t_s, std::hypot(tip.x_m[0] - target_m[0], tip.x_m[1] - target_m[1]));
}

double HilServer::time_s() const {
  int64_t first_ns = arms_.front().time_ns;
  for (const Arm& arm : arms_) first_ns = std::min(first_ns, arm.time_ns);
  return FleetTime(first_ns);
}

std::vector<HilArmResult> HilServer::Results() const {
  std::vector<HilArmResult> results;
  for (const Arm& arm : arms_) {
    results.push_back({.id = arm.id,
                       .bus = arm.bus_name,
                       .bus_down = arm.bus_down,
                       .diverged = arm.bench.diverged(),
                       .released_s = arm.released_s,
                       .drives = arm.bench.power(),
                       .record = leader_ ? std::optional(arm.record) : std::nullopt,
                       .counters = arm.bus->counters(),
                       .bus_load = arm.time_ns > epoch_ns_ ? arm.on_wire_s / FleetTime(arm.time_ns) : 0.0});
  }
  return results;
}

}  // namespace armada
