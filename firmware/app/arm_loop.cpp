#include "firmware/app/arm_loop.h"

#include <algorithm>
#include <cmath>

#include "firmware/app/heap_counter.h"
#include "firmware/app/realtime.h"

namespace armada {
namespace {

int64_t Nanoseconds(double seconds) {
  return std::llround(seconds * 1e9);
}

int32_t Microseconds(int64_t duration_ns) {
  return static_cast<int32_t>(duration_ns / 1000);
}

}  // namespace

ArmLoop::ArmLoop(ArmNode* node, CanBus* bus, LcmEndpoint* link, Clock* clock, const TimingConfig& timing,
                 int64_t epoch_ns)
    : node_(node),
      bus_(bus),
      link_(link),
      clock_(clock),
      period_ns_(Nanoseconds(timing.period_s)),
      feedback_timeout_ns_(Nanoseconds(timing.feedback_timeout_s)),
      transmit_timeout_ns_(Nanoseconds(timing.transmit_timeout_s)),
      listens_(timing.listens),
      epoch_ns_(epoch_ns) {}

bool ArmLoop::BringUp(const volatile std::sig_atomic_t* stop) {
  bool ready = false;
  const int64_t periods_ahead = std::max<int64_t>(0, (epoch_ns_ - clock_->Now()) / period_ns_);
  for (int64_t tick_ns = epoch_ns_ - periods_ahead * period_ns_; tick_ns < epoch_ns_; tick_ns += period_ns_) {
    ListenUntil(tick_ns);
    if (*stop != 0) return false;
    TakeWaitingFrames();
    out_.Clear();
    ready = node_->BringUp(tick_ns, &out_);
    Send();
    ConfirmSent(tick_ns + period_ns_ / 2);
  }
  return ready;
}

bool ArmLoop::Run(int64_t end_ns, const volatile std::sig_atomic_t* stop) {
  int64_t tick_ns = epoch_ns_;
  clock_->SleepUntil(tick_ns);
  heap_at_start_ = static_cast<int64_t>(HeapCounter::Allocations());
  faults_at_start_ = PageFaults();
  while (tick_ns < end_ns) {
    ListenUntil(tick_ns);
    if (*stop != 0) break;
    const int64_t now_ns = clock_->Now();
    if (const int64_t late_periods = (now_ns - tick_ns) / period_ns_; late_periods > 0) {
      report_.missed_ticks += late_periods;  // gone; the newest one is done, not all of them
      missed_before_tick_ = late_periods;
      tick_ns += late_periods * period_ns_;
    }
    Tick(tick_ns, now_ns);
    tick_ns += period_ns_;
  }
  final_state_ = node_->state();
  out_.Clear();
  node_->Disable(&out_);
  bus_->DropWaiting();
  Send();
  ConfirmSent(clock_->Now() + period_ns_);
  return tick_ns >= end_ns;
}

void ArmLoop::ListenUntil(int64_t time_ns) {
  for (int part = listens_ - 1; part > 0; --part) {
    clock_->SleepUntil(time_ns - part * period_ns_ / listens_);
    TakeWaitingMessages();
  }
  clock_->SleepUntil(time_ns);
}

void ArmLoop::Tick(int64_t tick_ns, int64_t woken_ns) {
  link_->Publish(node_->estimate_channel(), node_->EncodeEstimate(tick_ns, &buffer_));
  TakeWaitingFrames();
  out_.Clear();
  const int64_t request_ns = clock_->Now();
  node_->RequestSamples(request_ns, &out_);
  Send();
  const int64_t feedback_ns = AwaitSamples(tick_ns + feedback_timeout_ns_);
  if (!node_->SamplesComplete()) ++report_.incomplete_samples;
  TakeWaitingMessages();

  out_.Clear();
  node_->Step(tick_ns, &out_);
  if (node_->state() == ControllerState::kFault) bus_->DropWaiting();  // nothing old before the drives' rest
  Send();
  ConfirmSent(clock_->Now() + transmit_timeout_ns_);
  const int64_t sent_ns = clock_->Now();
  node_->bus_watch().OnTick(tick_ns, 1e-9 * static_cast<double>(sent_ns - tick_ns), missed_before_tick_);
  missed_before_tick_ = 0;
  AnswerOperator(tick_ns);

  ++report_.ticks;
  report_.wakeup_lateness.Add(woken_ns - tick_ns);
  report_.compute.Add(sent_ns - feedback_ns);
  report_.sample_to_torque.Add(sent_ns - request_ns);
  report_.heap_allocations = static_cast<int64_t>(HeapCounter::Allocations()) - heap_at_start_;
  report_.page_faults = PageFaults() - faults_at_start_;
  telemetry_.wakeup_lateness_us = Microseconds(woken_ns - tick_ns);
  telemetry_.compute_us = Microseconds(sent_ns - feedback_ns);
  telemetry_.sample_to_torque_us = Microseconds(sent_ns - request_ns);
  PublishTelemetry();
}

void ArmLoop::Send() {
  // A frame that the bus does not take is dropped and counted there: an old torque is never sent late.
  for (const CanFrame& frame : out_) node_->bus_watch().OnBus(bus_->Send(frame));
}

void ArmLoop::ConfirmSent(int64_t deadline_ns) {
  const BusStatus status = bus_->Flush(deadline_ns);
  node_->bus_watch().OnBus(status);
  node_->bus_watch().OnSent(status == BusStatus::kOk);
  if (status != BusStatus::kOk) ++report_.unsent_ticks;
}

int64_t ArmLoop::AwaitSamples(int64_t deadline_ns) {
  CanFrame frame;
  while (!node_->SamplesComplete()) {
    const BusStatus status = bus_->Receive(deadline_ns, &frame);
    node_->bus_watch().OnBus(status);
    if (status == BusStatus::kErrorPassive || status == BusStatus::kErrorActive) continue;
    if (status != BusStatus::kOk) break;
    node_->OnFrame(frame);
  }
  return clock_->Now();
}

void ArmLoop::TakeWaitingFrames() {
  constexpr int kMostPerTick = 256;  // bounds the work a babbling bus can cause
  CanFrame frame;
  for (int i = 0; i < kMostPerTick; ++i) {
    const BusStatus status = bus_->Receive(0, &frame);
    node_->bus_watch().OnBus(status);
    if (status == BusStatus::kTimeout || status == BusStatus::kDown) return;
    if (status == BusStatus::kOk) node_->OnFrame(frame);
  }
}

void ArmLoop::TakeWaitingMessages() {
  link_->Drain([&](const LcmMessage& message) { node_->OnMessage(message); });
}

void ArmLoop::AnswerOperator(int64_t tick_ns) {
  const std::span<const uint8_t> reply = node_->EncodeReply(tick_ns, &buffer_);
  if (!reply.empty()) link_->Publish(node_->reply_channel(), reply);
}

void ArmLoop::PublishTelemetry() {
  node_->FillTelemetry(&telemetry_);
  telemetry_.missed_ticks = static_cast<int32_t>(report_.missed_ticks);
  telemetry_.heap_allocations = report_.heap_allocations;
  telemetry_.page_faults = clock_->IsStepped() ? 0 : report_.page_faults;
  const BusCounters& can = bus_->counters();
  telemetry_.can_sent = static_cast<int64_t>(can.sent);
  telemetry_.can_received = static_cast<int64_t>(can.received);
  telemetry_.can_dropped = static_cast<int64_t>(can.dropped_queue_full + can.dropped_late);
  const LcmCounters& lcm = link_->counters();
  telemetry_.lcm_received = static_cast<int64_t>(lcm.received);
  telemetry_.lcm_rejected += static_cast<int64_t>(lcm.malformed);
  link_->Publish(node_->telemetry_channel(), node_->EncodeTelemetry(telemetry_, &buffer_));
}

}  // namespace armada
