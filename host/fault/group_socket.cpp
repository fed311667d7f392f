#include "host/fault/group_socket.h"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

namespace armada {
namespace {

// What others send while this one sends for a while.
constexpr int kQueueBytes = 1024 * 1024;

const sockaddr* Generic(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

template <class Value>
bool SetOption(const UniqueFd& socket, int level, int option, const Value& value) {
  return setsockopt(socket.get(), level, option, &value, sizeof(value)) == 0;
}

bool ConfigureSender(const UniqueFd& socket, int ttl) {
  const sockaddr_in any_port{.sin_family = AF_INET, .sin_port = 0, .sin_addr = {}, .sin_zero = {}};
  return SetOption(socket, IPPROTO_IP, IP_MULTICAST_TTL, ttl) &&
         bind(socket.get(), Generic(any_port), sizeof(any_port)) == 0;
}

bool ConfigureReceiver(const UniqueFd& socket, const sockaddr_in& group) {
  const ip_mreq membership{group.sin_addr, {htonl(INADDR_ANY)}};
  return SetOption(socket, SOL_SOCKET, SO_REUSEADDR, 1) &&
         SetOption(socket, SOL_SOCKET, SO_RCVBUF, kQueueBytes) &&
         bind(socket.get(), Generic(group), sizeof(group)) == 0 &&
         SetOption(socket, IPPROTO_IP, IP_ADD_MEMBERSHIP, membership);
}

in_port_t PortOf(const UniqueFd& socket) {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size);
  return address.sin_port;
}

}  // namespace

std::optional<GroupSocket> GroupSocket::Open(const LcmUrl& url, std::string* error) {
  GroupSocket made;
  made.group_.sin_family = AF_INET;
  made.group_.sin_port = htons(url.port);
  inet_pton(AF_INET, url.group.c_str(), &made.group_.sin_addr);
  made.sender_ = UniqueFd(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  made.receiver_ = UniqueFd(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!ConfigureSender(made.sender_, url.ttl) || !ConfigureReceiver(made.receiver_, made.group_)) {
    *error = ToString(url) + ": " + std::strerror(errno);
    return std::nullopt;
  }
  made.own_port_ = PortOf(made.sender_);
  return made;
}

bool GroupSocket::Send(std::span<const uint8_t> datagram) const {
  const ssize_t sent =
      sendto(sender_.get(), datagram.data(), datagram.size(), MSG_NOSIGNAL, Generic(group_), sizeof(group_));
  return sent == static_cast<ssize_t>(datagram.size());
}

std::optional<std::span<const uint8_t>> GroupSocket::Receive() {
  for (;;) {
    sockaddr_in from{};
    socklen_t size = sizeof(from);
    const ssize_t got = recvfrom(receiver_.get(), buffer_.data(), buffer_.size(), 0,
                                 reinterpret_cast<sockaddr*>(&from), &size);
    if (got < 0) return std::nullopt;
    if (from.sin_port != own_port_) return std::span(buffer_).first(static_cast<size_t>(got));
  }
}

}  // namespace armada
