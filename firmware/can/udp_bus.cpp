#include "firmware/can/udp_bus.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "firmware/can/udp_frame_codec.h"
#include "firmware/clock/monotonic.h"

namespace armada {
namespace {

/// Larger than any frame's datagram with room for keys that are not ours; what is longer is cut and so
/// malformed.
constexpr size_t kMaxDatagramBytes = 1024;
/// Own and malformed datagrams that one Receive drops before it minds its deadline again: a poll must get
/// past them to a frame, a flood of them must not hold the loop.
constexpr int kMaxDropped = 64;

/// Time of reception: the kernel's, which may be long before the datagram is taken.
int64_t ReceptionTime_ns(int socket, const msghdr& message, Clock* clock) {
  const int64_t now_ns = clock->Now();
  const int64_t wall_ns = clock->WallNow();
  timespec stamp = Timespec(wall_ns);
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  if (header != nullptr && header->cmsg_level == SOL_SOCKET && header->cmsg_type == SCM_TIMESTAMPNS)
    std::memcpy(&stamp, CMSG_DATA(header), sizeof stamp);
  return MonotonicOfWall(clock->ArrivalOf(socket, stamp), wall_ns, now_ns);
}

bool SetOption(const UniqueFd& socket, int level, int option, int value) {
  return setsockopt(socket.get(), level, option, &value, sizeof value) == 0;
}

UniqueFd OpenSocket() {
  return UniqueFd(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

std::string Explain(const std::string& group, uint16_t port, const char* step, int code) {
  std::string text =
      "bus udp:" + group + ":" + std::to_string(port) + ": cannot " + step + ": " + std::strerror(code);
  if (code == ENETUNREACH || code == ENODEV || code == EADDRNOTAVAIL) {
    text +=
        ". There is no route for multicast: add one (as root: ip link set lo up multicast on; "
        "ip route add 224.0.0.0/4 dev lo), or run in a private network (unshare -Urn) that has one";
  } else if (code == EADDRINUSE) {
    text += ". Another program holds the port for itself: stop it, or choose another port";
  }
  return text;
}

}  // namespace

std::unique_ptr<UdpCanBus> UdpCanBus::Open(const std::string& group, uint16_t port, uint8_t ttl, Clock* clock,
                                           std::string* error) {
  const auto failed = [&](const char* step) {
    *error = Explain(group, port, step, errno);
    return nullptr;
  };
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  errno = EINVAL;
  if (inet_pton(AF_INET, group.c_str(), &address.sin_addr) != 1) return failed("read the group");
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);

  UniqueFd receiver = OpenSocket();
  if (!receiver.valid()) return failed("open a socket");
  if (!SetOption(receiver, SOL_SOCKET, SO_REUSEADDR, 1)) return failed("share the port");
  if (!SetOption(receiver, SOL_SOCKET, SO_TIMESTAMPNS, 1)) return failed("get receive timestamps");
  // Bound to the group, not to any address: Linux would hand over the other groups of the same port too.
  if (bind(receiver.get(), generic, sizeof address) != 0) return failed("bind");
  const ip_mreq membership{address.sin_addr, {INADDR_ANY}};
  if (setsockopt(receiver.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0) {
    return failed("join the group");
  }

  UniqueFd sender = OpenSocket();
  if (!sender.valid()) return failed("open a socket");
  if (!SetOption(sender, IPPROTO_IP, IP_MULTICAST_TTL, ttl)) return failed("set the ttl");
  if (!SetOption(sender, IPPROTO_IP, IP_MULTICAST_LOOP, 1)) return failed("reach this host");
  if (connect(sender.get(), generic, sizeof address) != 0) return failed("reach the group");
  sockaddr_in own_address{};
  socklen_t size = sizeof own_address;
  if (getsockname(sender.get(), reinterpret_cast<sockaddr*>(&own_address), &size) != 0) {
    return failed("read the own address");
  }
  clock->Joined(receiver.get(), address);
  return std::unique_ptr<UdpCanBus>(
      new UdpCanBus(std::move(sender), std::move(receiver), own_address, address, clock));
}

BusStatus UdpCanBus::Send(const CanFrame& frame) {
  UdpFrameBuffer buffer;
  const size_t size = EncodeUdpFrame(frame, 1e-9 * static_cast<double>(clock_->WallNow()), &buffer);
  if (size == 0) {
    ++counters_.malformed;
    return BusStatus::kQueueFull;
  }
  if (send(sender_.get(), buffer.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0) {
    ++counters_.sent;
    clock_->Sent(group_);
    return BusStatus::kOk;
  }
  if (errno != EAGAIN && errno != ENOBUFS) return BusStatus::kDown;
  ++counters_.dropped_queue_full;
  return BusStatus::kQueueFull;
}

BusStatus UdpCanBus::Receive(int64_t deadline_ns, CanFrame* frame) {
  for (int dropped = 0;;) {
    switch (TakeDatagram(frame)) {
      case Taken::kFrame:
        ++counters_.received;
        if (frame->error) ++counters_.errors;
        return BusStatus::kOk;
      case Taken::kDown:
        return BusStatus::kDown;
      case Taken::kDropped:
        if (++dropped < kMaxDropped) continue;
        if (clock_->Now() >= deadline_ns) return BusStatus::kTimeout;
        continue;
      case Taken::kNothing:
        break;
    }
    if (clock_->Now() >= deadline_ns) return BusStatus::kTimeout;
    pollfd input{receiver_.get(), POLLIN, 0};
    clock_->Wait({&input, 1}, deadline_ns);
  }
}

UdpCanBus::Taken UdpCanBus::TakeDatagram(CanFrame* frame) {
  std::array<uint8_t, kMaxDatagramBytes> buffer;
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec))> control;
  sockaddr_in from{};
  iovec part{buffer.data(), buffer.size()};
  msghdr message{};
  message.msg_name = &from;
  message.msg_namelen = sizeof from;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  ssize_t size = 0;
  do {
    size = recvmsg(receiver_.get(), &message, MSG_DONTWAIT);
  } while (size < 0 && errno == EAGAIN && clock_->MoreToCome(receiver_.get()));
  if (size < 0) return errno == EAGAIN || errno == EINTR ? Taken::kNothing : Taken::kDown;
  const int64_t stamp_ns = ReceptionTime_ns(receiver_.get(), message, clock_);
  if (from.sin_port == own_address_.sin_port && from.sin_addr.s_addr == own_address_.sin_addr.s_addr) {
    return Taken::kDropped;
  }
  const bool whole = (message.msg_flags & MSG_TRUNC) == 0;
  if (!whole || !DecodeUdpFrame({buffer.data(), static_cast<size_t>(size)}, frame)) {
    ++counters_.malformed;
    return Taken::kDropped;
  }
  frame->stamp_ns = stamp_ns;
  return Taken::kFrame;
}

}  // namespace armada
