#include "host/can/dbc.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>
#include <utility>

namespace armada {
namespace {

constexpr uint32_t kExtended = 0x8000'0000;
// Values of the attribute VFrameFormat that tools give these meanings.
constexpr const char* kFormats =
    R"("StandardCAN","ExtendedCAN","reserved","J1939PG","reserved","reserved","reserved","reserved",)"
    R"("reserved","reserved","reserved","reserved","reserved","reserved","StandardCAN_FD","ExtendedCAN_FD")";
constexpr int kStandardFd = 14;
constexpr int kExtendedFd = 15;

using Group = std::vector<const BusMessage*>;

std::string FullName(const BusMessage& message) {
  return (message.owner.empty() ? "" : message.owner + "_") + message.message.name;
}

const CanSignal* MultiplexorOf(const CanMessage& message) {
  return message.multiplexor < 0 ? nullptr : &message.signals[static_cast<size_t>(message.multiplexor)];
}

bool AreToldApartAlike(const CanMessage& a, const CanMessage& b) {
  const CanSignal* const x = MultiplexorOf(a);
  const CanSignal* const y = MultiplexorOf(b);
  if (x == nullptr || y == nullptr) return x == y;
  return x->start_bit == y->start_bit && x->bits == y->bits && x->byte_order == y->byte_order;
}

/// What shares an identifier, in the order in which identifiers first come.
std::vector<Group> GroupsOf(std::span<const BusMessage> messages) {
  std::vector<Group> groups;
  std::map<std::pair<bool, uint32_t>, size_t> index;
  for (const BusMessage& message : messages) {
    const auto [at, is_new] =
        index.try_emplace({message.message.extended, message.message.id}, groups.size());
    if (is_new) groups.emplace_back();
    groups[at->second].push_back(&message);
  }
  return groups;
}

/// Leaves what one multiplexor can tell apart, and without one, a single message.
Group TakeDropped(Group* group) {
  const CanMessage& general = group->back()->message;
  const auto keep = [&](const BusMessage* message) {
    return message == group->back() ||
           (general.multiplexor >= 0 && AreToldApartAlike(message->message, general));
  };
  Group dropped;
  std::remove_copy_if(group->begin(), group->end(), std::back_inserter(dropped), keep);
  std::erase_if(*group, [&](const BusMessage* message) {
    return std::find(dropped.begin(), dropped.end(), message) != dropped.end();
  });
  return dropped;
}

/// "J1_State", "J1_Stop_Torque", "State" where several joints share it.
std::string NameOf(const Group& group) {
  std::string name = group.front()->owner;
  std::set<std::string> seen;
  for (const BusMessage* message : group) {
    if (message->owner != group.front()->owner) name.clear();
  }
  for (const BusMessage* message : group) {
    if (seen.insert(message->message.name).second)
      name += (name.empty() ? "" : "_") + std::string(message->message.name);
  }
  return name;
}

class Writer {
 public:
  Dbc Write(const std::string& name, std::span<const BusMessage> messages) {
    std::set<std::string> nodes = {"Master"};
    for (const BusMessage& message : messages) {
      if (!message.owner.empty()) nodes.insert(message.owner);
    }
    dbc_.text = "VERSION \"\"\n\nNS_ :\n\nBS_:\n\nBU_:";
    for (const std::string& node : nodes) dbc_.text += ' ' + node;
    dbc_.text += "\n\n";
    for (Group& group : GroupsOf(messages)) AddGroup(std::move(group));
    dbc_.text += "CM_ \"" + name + ": values as on the wire, motor side.\";\n" + comments_;
    dbc_.text += std::string("BA_DEF_ BO_ \"VFrameFormat\" ENUM ") + kFormats +
                 ";\nBA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\n" + attributes_ + types_;
    return std::move(dbc_);
  }

 private:
  void AddGroup(Group group) {
    const Group dropped = TakeDropped(&group);
    const CanMessage& first = group.front()->message;
    const std::string id = std::to_string(first.extended ? first.id | kExtended : first.id);
    uint8_t length = 0;
    for (const BusMessage* message : group) length = std::max(length, message->message.length);
    const bool shared = group.size() > 1;
    const bool one_owner = std::all_of(group.begin(), group.end(), [&](const BusMessage* message) {
      return message->owner == group.front()->owner;
    });
    const std::string drive = one_owner ? group.front()->owner : "";
    const std::string sender = !first.from_drive ? "Master" : drive.empty() ? "Vector__XXX" : drive;
    dbc_.text += "BO_ " + id + ' ' + NameOf(group) + ": " + std::to_string(length) + ' ' + sender + '\n';
    if (shared) AddSignal(id, *MultiplexorOf(first), MultiplexorOf(first)->name, " M");
    std::string comment;
    std::set<std::string> meanings;
    for (const BusMessage* message : group) {
      const CanMessage& content = message->message;
      const std::string prefix = shared ? FullName(*message) + '_' : "";
      const std::string mark = shared ? " m" + std::to_string(content.multiplexor_raw) : "";
      for (const CanSignal& signal : content.signals) {
        if (shared && &signal == MultiplexorOf(content)) continue;
        AddSignal(id, signal, prefix + signal.name, mark);
      }
      if (meanings.insert(content.meaning).second) {
        comment += (comment.empty() ? "" : "; ") + std::string(content.meaning);
      }
    }
    dbc_.text += '\n';
    AddComment(id, comment, dropped);
    if (first.fd) {
      attributes_ += "BA_ \"VFrameFormat\" BO_ " + id + ' ' +
                     std::to_string(first.extended ? kExtendedFd : kStandardFd) + ";\n";
    } else if (first.extended) {
      attributes_ += "BA_ \"VFrameFormat\" BO_ " + id + " 1;\n";
    }
  }

  void AddSignal(const std::string& id, const CanSignal& signal, const std::string& name,
                 const std::string& mark) {
    const bool is_float = signal.kind == CanSignal::Kind::kFloat32;
    char text[256];
    std::snprintf(text, sizeof text, " SG_ %s%s : %d|%d@%d%c (%.17g,%.17g) [0|0] \"%s\" Vector__XXX\n",
                  name.c_str(), mark.c_str(), signal.start_bit, signal.bits,
                  signal.byte_order == CanSignal::ByteOrder::kLittle ? 1 : 0,
                  signal.kind == CanSignal::Kind::kUnsigned ? '+' : '-', is_float ? 1.0 : signal.scale,
                  is_float ? 0.0 : signal.offset, signal.unit);
    dbc_.text += text;
    if (is_float) types_ += "SIG_VALTYPE_ " + id + ' ' + name + " : 1;\n";
  }

  void AddComment(const std::string& id, std::string comment, const Group& dropped) {
    if (!dropped.empty()) {
      comment += comment.empty() ? "" : ". ";
      comment += "Not told apart here:";
      for (const BusMessage* message : dropped) {
        dbc_.dropped.push_back(FullName(*message));
        comment += ' ' + dbc_.dropped.back();
      }
    }
    if (!comment.empty()) comments_ += "CM_ BO_ " + id + " \"" + comment + "\";\n";
  }

  Dbc dbc_;
  std::string comments_;
  std::string attributes_;
  std::string types_;
};

}  // namespace

Dbc MakeDbc(const std::string& name, std::span<const BusMessage> messages) {
  return Writer().Write(name, messages);
}

}  // namespace armada
