#include "firmware/can/can_link.h"

#include <linux/can.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "firmware/unique_fd.h"

namespace armada {
namespace {

/// Attributes of one level, walked in order.
class Attributes {
 public:
  Attributes(const void* begin, size_t size)
      : at_(static_cast<const rtattr*>(begin)), left_(static_cast<int>(size)) {}
  /// Those nested in another.
  explicit Attributes(const rtattr* parent) : Attributes(RTA_DATA(parent), RTA_PAYLOAD(parent)) {}

  const rtattr* Take() {
    if (!RTA_OK(at_, left_)) return nullptr;
    const rtattr* taken = at_;
    at_ = RTA_NEXT(at_, left_);
    return taken;
  }

 private:
  const rtattr* at_;
  int left_;
};

template <class Value>
Value ValueOf(const rtattr* attribute) {
  Value value{};
  std::memcpy(&value, RTA_DATA(attribute), std::min(sizeof value, size_t{RTA_PAYLOAD(attribute)}));
  return value;
}

void ReadController(const rtattr* data, CanLink* link) {
  Attributes attributes(data);
  while (const rtattr* attribute = attributes.Take()) {
    switch (attribute->rta_type) {
      case IFLA_CAN_BITTIMING:
        link->bitrate_bit_s = ValueOf<can_bittiming>(attribute).bitrate;
        break;
      case IFLA_CAN_DATA_BITTIMING:
        link->data_bitrate_bit_s = ValueOf<can_bittiming>(attribute).bitrate;
        break;
      case IFLA_CAN_RESTART_MS:
        link->restart_ms = ValueOf<uint32_t>(attribute);
        break;
      case IFLA_CAN_CTRLMODE:
        link->listen_only = (ValueOf<can_ctrlmode>(attribute).flags & CAN_CTRLMODE_LISTENONLY) != 0;
        break;
      default:
        break;
    }
  }
}

void ReadInfo(const rtattr* info, CanLink* link) {
  const rtattr* data = nullptr;
  Attributes attributes(info);
  while (const rtattr* attribute = attributes.Take()) {
    if (attribute->rta_type == IFLA_INFO_KIND) link->kind = static_cast<const char*>(RTA_DATA(attribute));
    if (attribute->rta_type == IFLA_INFO_DATA) data = attribute;
  }
  if (link->kind == "can" && data != nullptr) ReadController(data, link);
}

CanLink ReadMessage(const std::string& name, const nlmsghdr* header) {
  CanLink link;
  link.name = name;
  const auto* info = static_cast<const ifinfomsg*>(NLMSG_DATA(header));
  link.up = (info->ifi_flags & IFF_UP) != 0;
  link.is_can = info->ifi_type == ARPHRD_CAN;
  Attributes attributes(IFLA_RTA(info), IFLA_PAYLOAD(header));
  while (const rtattr* attribute = attributes.Take()) {
    switch (attribute->rta_type) {
      case IFLA_MTU:
        link.mtu = ValueOf<uint32_t>(attribute);
        break;
      case IFLA_TXQLEN:
        link.tx_queue_length = ValueOf<uint32_t>(attribute);
        break;
      case IFLA_LINKINFO:
        ReadInfo(attribute, &link);
        break;
      default:
        break;
    }
  }
  return link;
}

std::string Command(const CanLink& link, const std::string& rest) {
  return "sudo ip link set " + link.name + " " + rest;
}

/// A controller takes other settings only while it is down.
std::string Reconfigure(const CanLink& link, const std::string& settings) {
  return Command(link, "down && ") + Command(link, "type can " + settings + " && ") + Command(link, "up");
}

std::string BitTiming(const BusOptions& options) {
  std::string text = "bitrate " + std::to_string(std::lround(options.config.bitrate_bit_s));
  if (options.fd) {
    text += " dbitrate " + std::to_string(std::lround(options.config.data_bitrate_bit_s)) + " fd on";
  }
  return text + " restart-ms 0";
}

std::string CheckController(const CanLink& link, const BusOptions& options) {
  const auto wanted = static_cast<uint32_t>(std::lround(options.config.bitrate_bit_s));
  const auto wanted_data = static_cast<uint32_t>(std::lround(options.config.data_bitrate_bit_s));
  const std::string mend = Reconfigure(link, BitTiming(options));
  if (link.bitrate_bit_s != wanted) {
    return "its bit rate is " + std::to_string(link.bitrate_bit_s.value_or(0)) + " bit/s, the fleet says " +
           std::to_string(wanted) + ": " + mend;
  }
  if (options.fd && link.data_bitrate_bit_s != wanted_data) {
    return "its data bit rate is " + std::to_string(link.data_bitrate_bit_s.value_or(0)) +
           " bit/s, the fleet says " + std::to_string(wanted_data) + ": " + mend;
  }
  if (link.restart_ms != 0) {
    return "it restarts by itself after bus-off (restart-ms " + std::to_string(link.restart_ms) +
           "), and would then send what was queued before: " + Reconfigure(link, "restart-ms 0");
  }
  if (link.listen_only) return "it only listens: " + Reconfigure(link, "listen-only off");
  const auto longest = static_cast<uint32_t>(options.config.tx_queue_length_max);
  const auto window = static_cast<uint32_t>(options.config.transmit_window);
  if (link.tx_queue_length < window || link.tx_queue_length > longest) {
    return "its transmit queue holds " + std::to_string(link.tx_queue_length) + " frames, allowed are " +
           std::to_string(window) + " to " + std::to_string(longest) + ": " +
           Command(link, "txqueuelen " + std::to_string(longest));
  }
  return "";
}

}  // namespace

std::optional<CanLink> ReadCanLink(const std::string& name, std::string* error) {
  const auto failed = [&](const char* step) {
    *error = "bus socketcan:" + name + ": cannot " + step + ": " + std::strerror(errno);
    return std::nullopt;
  };
  const unsigned index = if_nametoindex(name.c_str());
  if (index == 0) {
    *error = "bus socketcan:" + name +
             ": there is no such interface; `ip -brief link` lists them. A controller's "
             "driver makes one, a virtual one is made by: sudo ip link add " +
             name + " type vcan && sudo ip link set " + name + " mtu 72 up";
    return std::nullopt;
  }
  const UniqueFd netlink(socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  if (!netlink.valid()) return failed("open netlink");

  struct {
    nlmsghdr header;
    ifinfomsg info;
  } request{};
  request.header.nlmsg_len = sizeof request;
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.info.ifi_family = AF_UNSPEC;
  request.info.ifi_index = static_cast<int>(index);
  if (send(netlink.get(), &request, sizeof request, 0) < 0) return failed("ask netlink");

  alignas(nlmsghdr) std::array<char, 16384> buffer;
  const ssize_t size = recv(netlink.get(), buffer.data(), buffer.size(), 0);
  if (size < 0) return failed("hear netlink");
  const auto* header = reinterpret_cast<const nlmsghdr*>(buffer.data());
  if (!NLMSG_OK(header, static_cast<unsigned>(size)) || header->nlmsg_type != RTM_NEWLINK) {
    errno = ENODEV;
    return failed("read its state");
  }
  return ReadMessage(name, header);
}

std::string CheckCanLink(const CanLink& link, const BusOptions& options) {
  std::string problem;
  if (!link.is_can) return "bus socketcan:" + link.name + ": it is no CAN interface";
  if (link.kind == "can") problem = CheckController(link, options);
  if (problem.empty() && options.fd && link.mtu < CANFD_MTU) {
    problem = "it carries classic frames only (mtu " + std::to_string(link.mtu) +
              "), the drives speak CAN FD: " +
              (link.kind == "can" ? Reconfigure(link, BitTiming(options)) : Command(link, "mtu 72"));
  }
  if (problem.empty() && !link.up) problem = "it is down: " + Command(link, "up");
  return problem.empty() ? "" : "bus socketcan:" + link.name + ": " + problem;
}

}  // namespace armada
