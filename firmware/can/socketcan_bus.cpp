#include "firmware/can/socketcan_bus.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "firmware/can/can_link.h"
#include "firmware/clock/monotonic.h"

namespace armada {
namespace {

/// Echoes and malformed frames that one Receive passes over before it minds its deadline again.
constexpr int kMaxPassedOver = 64;

template <class Value>
bool SetOption(const UniqueFd& socket, int level, int option, const Value& value) {
  return setsockopt(socket.get(), level, option, &value, sizeof value) == 0;
}

bool SetFilters(const UniqueFd& socket, const std::vector<CanFilter>& filters) {
  if (filters.empty()) return true;  // the kernel's default lets all frames pass
  std::vector<can_filter> list;
  for (const CanFilter& filter : filters) {
    const canid_t id = filter.id | (filter.extended ? CAN_EFF_FLAG : 0u);
    list.push_back({id, filter.mask | CAN_EFF_FLAG});  // data and remote frames of that identifier length
  }
  return setsockopt(socket.get(), SOL_CAN_RAW, CAN_RAW_FILTER, list.data(),
                    static_cast<socklen_t>(list.size() * sizeof(can_filter))) == 0;
}

canid_t KernelId(const CanFrame& frame) {
  return frame.id | (frame.extended ? CAN_EFF_FLAG : 0u) | (frame.remote ? CAN_RTR_FLAG : 0u) |
         (frame.error ? CAN_ERR_FLAG : 0u);
}

bool IsGone(int code) {
  return code == ENETDOWN || code == ENODEV || code == ENXIO || code == EBADF;
}

}  // namespace

std::unique_ptr<SocketCanBus> SocketCanBus::Open(const std::string& interface_name, const BusOptions& options,
                                                 std::string* error) {
  const auto failed = [&](const char* step) {
    *error = "bus socketcan:" + interface_name + ": cannot " + step + ": " + std::strerror(errno);
    return nullptr;
  };
  UniqueFd socket(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (!socket.valid()) {
    if (errno != EAFNOSUPPORT && errno != EPROTONOSUPPORT) return failed("open a socket");
    *error =
        "bus socketcan:" + interface_name +
        ": this kernel has no CAN, or its module is not loaded: sudo modprobe can-raw; where there is none, "
        "`armada run --bus vm` brings a kernel of its own, and --bus udp needs none";
    return nullptr;
  }
  const auto link = ReadCanLink(interface_name, error);
  if (!link) return nullptr;
  if (const std::string problem = CheckCanLink(*link, options); !problem.empty()) {
    *error = problem;
    return nullptr;
  }
  if (!SetFilters(socket, options.filters)) return failed("set the receive filters");
  const can_err_mask_t all_errors = CAN_ERR_MASK;
  if (!SetOption(socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, all_errors)) return failed("ask for error frames");
  if (!SetOption(socket, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, 1)) return failed("ask for echoes");
  if (options.fd && !SetOption(socket, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, 1)) return failed("speak CAN FD");
  if (!SetOption(socket, SOL_SOCKET, SO_TIMESTAMPNS, 1)) return failed("get receive timestamps");
  if (!SetOption(socket, SOL_SOCKET, SO_RXQ_OVFL, 1)) return failed("count what overflows");

  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(interface_name.c_str()));
  if (bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return failed("bind");
  return std::unique_ptr<SocketCanBus>(new SocketCanBus(std::move(socket), options));
}

SocketCanBus::SocketCanBus(UniqueFd socket, const BusOptions& options)
    : socket_(std::move(socket)),
      fd_(options.fd),
      queue_(static_cast<size_t>(options.config.transmit_window)) {}

BusStatus SocketCanBus::Send(const CanFrame& frame) {
  if (!IsValid(frame) || frame.error || (frame.fd && !fd_)) {
    ++counters_.malformed;
    return BusStatus::kQueueFull;
  }
  if (down_) return BusStatus::kDown;
  switch (queue_.Push(frame)) {
    case TransmitQueue::Taken::kQueued:
      break;
    case TransmitQueue::Taken::kReplaced:
      ++counters_.replaced;
      break;
    case TransmitQueue::Taken::kFull:
      ++counters_.dropped_queue_full;
      return BusStatus::kQueueFull;
  }
  return Pump();
}

BusStatus SocketCanBus::Pump() {
  BusStatus status = BusStatus::kOk;
  while (const CanFrame* frame = queue_.Next()) {
    canfd_frame wire{};  // a can_frame is laid out alike, and shorter
    wire.can_id = KernelId(*frame);
    wire.len = frame->length;
    if (frame->fd) {
      wire.flags = static_cast<uint8_t>((frame->bitrate_switch ? CANFD_BRS : 0) |
                                        (frame->error_state_indicator ? CANFD_ESI : 0));
    }
    if (!frame->remote) std::copy_n(frame->data.begin(), frame->length, wire.data);
    const size_t size = frame->fd ? CANFD_MTU : CAN_MTU;
    if (send(socket_.get(), &wire, size, MSG_DONTWAIT) == static_cast<ssize_t>(size)) {
      queue_.HandedOver();
      continue;
    }
    if (errno == EINTR) continue;
    if (IsGone(errno)) {
      down_ = true;
      queue_.DropWaiting();
      return BusStatus::kDown;
    }
    queue_.Refused();
    ++counters_.dropped_queue_full;
    refused_ = true;
    status = BusStatus::kQueueFull;
  }
  return status;
}

BusStatus SocketCanBus::Flush(int64_t deadline_ns) {
  while (!down_ && queue_.waiting() + queue_.in_flight() > 0 && !inbox_.full()) {
    CanFrame frame;
    switch (Take(&frame)) {
      case Taken::kFrame:
        inbox_.Push(frame);  // for Receive: an echo comes behind the frames that were there before it
        continue;
      case Taken::kEcho:
        (void)Pump();  // a refusal is remembered, a socket that is gone ends the loop
        continue;
      case Taken::kMalformed:
        continue;
      case Taken::kNothing:
        break;
    }
    if (!Wait(deadline_ns)) break;
  }
  if (down_) return BusStatus::kDown;
  const size_t late = queue_.DropWaiting();
  counters_.dropped_late += late;
  const bool refused = std::exchange(refused_, false);
  if (late > 0 || queue_.in_flight() > 0) return BusStatus::kTimeout;
  return refused ? BusStatus::kQueueFull : BusStatus::kOk;
}

BusStatus SocketCanBus::Receive(int64_t deadline_ns, CanFrame* frame) {
  CanFrame taken;
  for (int passed_over = 0;;) {
    if (!inbox_.empty()) {
      taken = inbox_.Pop();
    } else if (down_) {
      return BusStatus::kDown;
    } else {
      switch (Take(&taken)) {
        case Taken::kFrame:
          break;
        case Taken::kEcho:
          (void)Pump();
          [[fallthrough]];
        case Taken::kMalformed:
          if (++passed_over < kMaxPassedOver || Now_ns(CLOCK_MONOTONIC) < deadline_ns) continue;
          return BusStatus::kTimeout;
        case Taken::kNothing:
          if (down_) continue;
          if (!Wait(deadline_ns)) return BusStatus::kTimeout;
          continue;
      }
    }
    if (taken.error) {
      const BusStatus event = OnError(taken);
      if (event != BusStatus::kOk) return event;
    } else {
      ++counters_.received;
    }
    *frame = taken;
    return BusStatus::kOk;
  }
}

bool SocketCanBus::Wait(int64_t deadline_ns) {
  const int64_t left_ns = deadline_ns - Now_ns(CLOCK_MONOTONIC);
  if (left_ns <= 0) return false;
  const timespec left{left_ns / kNsPerS, left_ns % kNsPerS};
  pollfd input{socket_.get(), POLLIN, 0};
  if (ppoll(&input, 1, &left, nullptr) < 0 && errno != EINTR) down_ = true;
  return true;
}

SocketCanBus::Taken SocketCanBus::Take(CanFrame* frame) {
  canfd_frame wire{};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(uint32_t))> control;
  iovec part{&wire, sizeof wire};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = recvmsg(socket_.get(), &message, MSG_DONTWAIT);
  if (size < 0) {
    if (errno != EAGAIN && errno != EINTR) down_ = true;
    return Taken::kNothing;
  }
  if (size != static_cast<ssize_t>(CAN_MTU) && size != static_cast<ssize_t>(CANFD_MTU)) {
    ++counters_.malformed;
    return Taken::kMalformed;
  }
  *frame = {};
  frame->fd = size == static_cast<ssize_t>(CANFD_MTU);
  frame->error = (wire.can_id & CAN_ERR_FLAG) != 0;
  frame->extended = !frame->error && (wire.can_id & CAN_EFF_FLAG) != 0;
  frame->remote = !frame->error && (wire.can_id & CAN_RTR_FLAG) != 0;
  frame->id = wire.can_id & (frame->error || frame->extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame->bitrate_switch = frame->fd && (wire.flags & CANFD_BRS) != 0;
  frame->error_state_indicator = frame->fd && (wire.flags & CANFD_ESI) != 0;
  frame->length = std::min(wire.len, static_cast<uint8_t>(frame->fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN));
  if (!frame->remote) std::copy_n(wire.data, frame->length, frame->data.begin());
  ReadControl(message, frame);
  if ((message.msg_flags & MSG_CONFIRM) == 0) return Taken::kFrame;
  if (queue_.Confirm(*frame)) ++counters_.sent;
  return Taken::kEcho;
}

void SocketCanBus::ReadControl(const msghdr& message, CanFrame* frame) {
  frame->stamp_ns = 0;
  for (const cmsghdr* header = CMSG_FIRSTHDR(&message); header != nullptr;
       header = CMSG_NXTHDR(const_cast<msghdr*>(&message), const_cast<cmsghdr*>(header))) {
    if (header->cmsg_level != SOL_SOCKET) continue;
    if (header->cmsg_type == SCM_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(header), sizeof stamp);
      frame->stamp_ns = MonotonicOfWall(Nanoseconds(stamp), Now_ns(CLOCK_REALTIME), Now_ns(CLOCK_MONOTONIC));
    } else if (header->cmsg_type == SO_RXQ_OVFL) {
      uint32_t overflowed = 0;
      std::memcpy(&overflowed, CMSG_DATA(header), sizeof overflowed);
      counters_.receive_overflowed = overflowed;
    }
  }
  if (frame->stamp_ns == 0) frame->stamp_ns = Now_ns(CLOCK_MONOTONIC);
}

BusStatus SocketCanBus::OnError(const CanFrame& frame) {
  ++counters_.errors;
  if ((frame.id & CAN_ERR_BUSOFF) != 0) {
    ++counters_.bus_off;
    queue_.DropWaiting();
    queue_.ForgetInFlight();
    return BusStatus::kBusOff;
  }
  if ((frame.id & CAN_ERR_RESTARTED) != 0) {
    ++counters_.restarts;
    queue_.DropWaiting();
    queue_.ForgetInFlight();
    return BusStatus::kRestarted;
  }
  constexpr uint8_t kPassive = CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE;
  if ((frame.id & CAN_ERR_CRTL) != 0) {
    if ((frame.data[1] & kPassive) != 0) {
      ++counters_.error_passive;
      return BusStatus::kErrorPassive;
    }
    constexpr uint8_t kBetter = CAN_ERR_CRTL_ACTIVE | CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING;
    if ((frame.data[1] & kBetter) != 0) return BusStatus::kErrorActive;
  }
  return BusStatus::kOk;
}

}  // namespace armada
