#pragma once

#include <netinet/in.h>

#include <memory>
#include <string>

#include "firmware/can/bus.h"
#include "firmware/clock/clock.h"
#include "firmware/unique_fd.h"

namespace armada {

/// The user-space CAN bus: every frame is a datagram to a multicast group, in the format of python-can's
/// `udp_multicast` interface, so that its viewer, logger and player work on the bus as they are. Every other
/// object on the group receives what one sends, in this process, on this host, and with ttl > 0 on others. No
/// kernel module, no privilege; unlike CAN there is no arbitration, and the order of frames of two senders is
/// not kept.
class UdpCanBus final : public CanBus {
 public:
  /// `group`: IPv4 multicast, dotted. `clock` outlives the object. Null on failure, and then `error` says
  /// what failed and what to do.
  static std::unique_ptr<UdpCanBus> Open(const std::string& group, uint16_t port, uint8_t ttl, Clock* clock,
                                         std::string* error);

  BusStatus Send(const CanFrame& frame) override;
  BusStatus Flush(int64_t /*deadline_ns*/) override { return BusStatus::kOk; }  // Send has handed it over
  void DropWaiting() override {}
  BusStatus Receive(int64_t deadline_ns, CanFrame* frame) override;
  int descriptor() const override { return receiver_.get(); }

 private:
  enum class Taken { kFrame, kNothing, kDropped, kDown };

  UdpCanBus(UniqueFd sender, UniqueFd receiver, const sockaddr_in& own_address, const sockaddr_in& group,
            Clock* clock)
      : sender_(std::move(sender)),
        receiver_(std::move(receiver)),
        own_address_(own_address),
        group_(group),
        clock_(clock) {}

  /// Takes one datagram from the socket, without waiting.
  Taken TakeDatagram(CanFrame* frame);

  UniqueFd sender_;  ///< a port of its own: frames that come from it are ours, and only those
  UniqueFd receiver_;
  sockaddr_in own_address_;
  sockaddr_in group_;
  Clock* clock_;
};

}  // namespace armada
