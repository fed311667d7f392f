#include "firmware/link/lcm_endpoint.h"

#include <arpa/inet.h>
#include <linux/filter.h>
#include <netinet/udp.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>

#include "firmware/clock/monotonic.h"
#include "firmware/link/lcm_packet.h"

namespace armada {
namespace {

// The kernel doubles this for its own bookkeeping and charges 768 bytes for the smallest datagram, 1280 for a
// state, 2304 for telemetry: 554 of the smallest, which one Drain can empty; and sixteen ticks of seven arms'
// traffic, which a stalled loop can sleep through. Kernels allow that much to everyone.
constexpr int kQueueBytes = 208 * 1024;

template <class Value>
bool SetOption(int socket, int level, int option, const Value& value) {
  return setsockopt(socket, level, option, &value, sizeof(value)) == 0;
}

bool Join(int socket, const sockaddr_in& group) {
  const ip_mreq membership{group.sin_addr, {htonl(INADDR_ANY)}};
  return SetOption(socket, IPPROTO_IP, IP_ADD_MEMBERSHIP, membership);
}

// Bound to the group rather than to any address, the socket gets neither unicast nor what other groups send
// to the port.
bool Bind(int socket, const sockaddr_in& group) {
  return SetOption(socket, SOL_SOCKET, SO_REUSEADDR, 1) &&
         bind(socket, reinterpret_cast<const sockaddr*>(&group), sizeof(group)) == 0;
}

// What is too long never gets into the queue, where it would take the room of many messages.
bool RefuseTooLong(int socket) {
  constexpr uint32_t kLongest = sizeof(udphdr) + LcmEndpoint::kMaxDatagram;  // filters see UDP's header, too
  std::array<sock_filter, 4> filter = {
      {BPF_STMT(BPF_LD | BPF_W | BPF_LEN, 0), BPF_JUMP(BPF_JMP | BPF_JGT | BPF_K, kLongest, 0, 1),
       BPF_STMT(BPF_RET | BPF_K, 0), BPF_STMT(BPF_RET | BPF_K, std::numeric_limits<uint32_t>::max())}};
  return SetOption(socket, SOL_SOCKET, SO_ATTACH_FILTER,
                   sock_fprog{static_cast<unsigned short>(filter.size()), filter.data()});
}

bool Configure(int socket, int ttl) {
  return SetOption(socket, IPPROTO_IP, IP_MULTICAST_TTL, ttl) &&
         SetOption(socket, IPPROTO_IP, IP_MULTICAST_LOOP, 1) &&
         SetOption(socket, SOL_SOCKET, SO_RCVBUF, kQueueBytes) && RefuseTooLong(socket) &&
         SetOption(socket, SOL_SOCKET, SO_TIMESTAMPNS, 1) && SetOption(socket, SOL_SOCKET, SO_RXQ_OVFL, 1);
}

}  // namespace

std::unique_ptr<LcmEndpoint> LcmEndpoint::Open(const LcmUrl& url, Clock* clock, std::string* error) {
  const auto fail = [&](const std::string& what) {
    *error = "LCM " + ToString(url) + ": " + what;
    return nullptr;
  };
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(url.port);
  if (inet_pton(AF_INET, url.group.c_str(), &group.sin_addr) != 1)
    return fail("the group is no IPv4 address");

  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket < 0) return fail(std::string("cannot open a socket: ") + std::strerror(errno));
  std::unique_ptr<LcmEndpoint> endpoint(new LcmEndpoint(socket, group, clock));

  if (!Bind(socket, group)) return fail(std::string("cannot bind: ") + std::strerror(errno));
  if (!Configure(socket, url.ttl))
    return fail(std::string("cannot set up the socket: ") + std::strerror(errno));
  if (!Join(socket, group)) {
    const bool no_route = errno == ENODEV || errno == ENETUNREACH;
    return fail(
        std::string("cannot join the group: ") + std::strerror(errno) +
        (no_route ? "; this host has no route for multicast. Make one with `ip link set lo up multicast on; "
                    "ip route add 224.0.0.0/4 dev lo` as root, or start with `armada run`, which makes a "
                    "private network"
                  : ""));
  }
  clock->Joined(socket, group);
  return endpoint;
}

LcmEndpoint::LcmEndpoint(int socket, const sockaddr_in& group, Clock* clock)
    : socket_(socket), group_(group), clock_(clock) {
  for (size_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    slot.part = {slot.datagram.data(), slot.datagram.size()};
    headers_[i].msg_hdr.msg_iov = &slot.part;
    headers_[i].msg_hdr.msg_iovlen = 1;
    headers_[i].msg_hdr.msg_control = slot.control.data();
  }
  CompareClocks();
}

LcmEndpoint::~LcmEndpoint() {
  close(socket_);
}

bool LcmEndpoint::Publish(std::string_view channel, std::span<const uint8_t> payload) {
  std::array<uint8_t, kMaxDatagram> datagram;
  const size_t size = WriteLcmPacket(sequence_, {channel, payload}, datagram);
  const bool sent = size > 0 && sendto(socket_, datagram.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL,
                                       reinterpret_cast<const sockaddr*>(&group_),
                                       sizeof(group_)) == static_cast<ssize_t>(size);
  if (!sent) {
    ++counters_.send_failures;
    return false;
  }
  ++sequence_;
  ++counters_.sent;
  clock_->Sent(group_);
  return true;
}

int LcmEndpoint::ReceiveBatch(int wanted) {
  for (mmsghdr& header : headers_) header.msg_hdr.msg_controllen = sizeof(Slot::control);
  const int got = recvmmsg(socket_, headers_.data(), static_cast<unsigned>(wanted), MSG_DONTWAIT, nullptr);
  CompareClocks();
  return std::max(got, 0);
}

void LcmEndpoint::CompareClocks() {
  const int64_t wall_ns = clock_->WallNow();
  arrival_.Update(wall_ns, clock_->Now());
}

std::optional<LcmMessage> LcmEndpoint::Read(int index) {
  const auto slot = static_cast<size_t>(index);
  msghdr& header = headers_[slot].msg_hdr;
  const int64_t arrival_ns = ReadControl(&header);
  const auto packet = ParseLcmPacket(std::span(slots_[slot].datagram).first(headers_[slot].msg_len));
  if (!packet) {
    ++counters_.malformed;
    return std::nullopt;
  }
  ++counters_.received;
  return LcmMessage{packet->channel, packet->payload, arrival_ns};
}

int64_t LcmEndpoint::ReadControl(msghdr* header) {
  std::optional<timespec> stamp;
  for (cmsghdr* item = CMSG_FIRSTHDR(header); item != nullptr; item = CMSG_NXTHDR(header, item)) {
    if (item->cmsg_level != SOL_SOCKET) continue;
    if (item->cmsg_type == SCM_TIMESTAMPNS) {
      std::memcpy(&stamp.emplace(), CMSG_DATA(item), sizeof(timespec));
    } else if (item->cmsg_type == SO_RXQ_OVFL) {
      uint32_t dropped = 0;
      std::memcpy(&dropped, CMSG_DATA(item), sizeof(dropped));
      counters_.overflowed = dropped;
    }
  }
  return arrival_.ToMonotonic(clock_->ArrivalOf(socket_, stamp ? *stamp : Timespec(clock_->WallNow())));
}

}  // namespace armada
