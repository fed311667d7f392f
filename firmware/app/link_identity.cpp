#include "firmware/app/link_identity.h"

#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "firmware/app/whole_file.h"

namespace armada {
namespace {

namespace fs = std::filesystem;

// The epoch in a file, 0 where there is none. Nothing, with *error set, when the file says no number.
std::optional<uint64_t> ReadEpoch(const std::string& path, std::string* error) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return 0;
  std::ifstream file(path);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  uint64_t epoch = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), epoch);
  if (file && code == std::errc() && std::string_view(end) == "\n" && epoch < UINT64_MAX) return epoch;
  *error = path +
           ": cannot be read as the number of starts of this sender. Write a number there that is not below "
           "the last one, or give the fleet a new key";
  return std::nullopt;
}

}  // namespace

std::string DefaultStateFolder() {
  if (const char* folder = std::getenv("STATE_DIRECTORY")) return folder;
  if (const char* folder = std::getenv("XDG_STATE_HOME")) return std::string(folder) + "/armada";
  if (const char* home = std::getenv("HOME")) return std::string(home) + "/.local/state/armada";
  return "/var/lib/armada";
}

bool TakeIdentity(const LcmLinkConfig& link, int sender, const std::string& state_folder,
                  std::optional<LinkIdentity>* identity, std::string* error) {
  identity->reset();
  if (!link.has_key()) return true;
  const auto key = LoadFleetKey(link.key_file, error);
  if (!key) return false;
  const std::string path = state_folder + "/epoch_" + std::to_string(sender);
  const auto last = ReadEpoch(path, error);
  if (!last) return false;
  const uint64_t epoch = *last + 1;
  if (!WriteWhole(
          path, [&](std::ostream& out) { out << epoch << '\n'; }, error))
    return false;
  *identity = {*key, epoch};
  return true;
}

std::string WarningOf(const LcmLinkConfig& link) {
  if (link.has_key()) return "";
  return "WARNING: the fleet has no key (link.key_file): whoever can send on " + link.lcm_url +
         " can move the arms";
}

std::string WhyNotReal(const std::optional<LinkIdentity>& identity, const LcmLinkConfig& link) {
  if (!identity || !IsSeeded(identity->key)) return "";
  return "key " + link.key_file +
         ": is of a run in stepped time, made of its seed, and no secret; `armada key new` makes one";
}

}  // namespace armada
