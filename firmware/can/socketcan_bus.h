#pragma once

#include <array>
#include <memory>
#include <string>

#include "firmware/can/bus.h"
#include "firmware/can/can_bus_config.h"
#include "firmware/can/transmit_queue.h"
#include "firmware/unique_fd.h"

struct msghdr;

namespace armada {

/// A CAN interface of the Linux kernel, classic and FD. The socket hears its own frames: an echo proves that
/// a frame was on the wire, where the driver can tell, and opens the transmit window for the next. Frames are
/// stamped by the kernel as they come in. Once the interface went down the object stays kDown: whatever runs
/// on it has to be started anew.
class SocketCanBus final : public CanBus {
 public:
  /// Opens the interface if it is as `options` wants it. Null on failure, and then `error` says what does not
  /// fit and which command mends it.
  static std::unique_ptr<SocketCanBus> Open(const std::string& interface_name, const BusOptions& options,
                                            std::string* error);

  BusStatus Send(const CanFrame& frame) override;
  BusStatus Flush(int64_t deadline_ns) override;
  void DropWaiting() override { queue_.DropWaiting(); }
  BusStatus Receive(int64_t deadline_ns, CanFrame* frame) override;
  int descriptor() const override { return socket_.get(); }

 private:
  enum class Taken { kFrame, kEcho, kNothing, kMalformed };

  /// Frames of others that came while Flush waited for an echo.
  class Inbox {
   public:
    bool empty() const { return count_ == 0; }
    bool full() const { return count_ == frames_.size(); }
    void Push(const CanFrame& frame) { frames_[(first_ + count_++) % frames_.size()] = frame; }
    CanFrame Pop() {
      const CanFrame& frame = frames_[first_];
      first_ = (first_ + 1) % frames_.size();
      --count_;
      return frame;
    }

   private:
    std::array<CanFrame, 128> frames_{};
    size_t first_ = 0;
    size_t count_ = 0;
  };

  SocketCanBus(UniqueFd socket, const BusOptions& options);

  /// Hands frames to the kernel while the window is open.
  BusStatus Pump();
  /// Takes one frame from the socket without waiting, and what an echo confirms. Sets down_ on failure.
  Taken Take(CanFrame* frame);
  void ReadControl(const msghdr& message, CanFrame* frame);
  /// What an error frame tells of the controller; kOk when it is of something else.
  BusStatus OnError(const CanFrame& frame);
  /// Waits for input; false when the deadline has passed.
  bool Wait(int64_t deadline_ns);

  UniqueFd socket_;
  bool fd_;
  bool down_ = false;
  bool refused_ = false;  ///< the kernel refused a frame since the last Flush
  TransmitQueue queue_;
  Inbox inbox_;
};

}  // namespace armada
