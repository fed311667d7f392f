#include "hil/live_faults.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "firmware/app/config/parameter_reader.h"
#include "firmware/app/config/toml_parser.h"

namespace armada {
namespace {

std::string PathOf(const std::string& directory, const char* name) {
  return directory + "/" + name;
}

std::string Complaint(const std::string& path) {
  return path + ": " + std::strerror(errno);
}

std::optional<FaultConfig> ReadFault(const std::string& line) {
  std::vector<ConfigError> errors;
  const auto tree = ParseToml("fault = " + line, "", &errors);
  const ConfigNode* const node = tree ? tree->Find("fault") : nullptr;
  if (node == nullptr) return std::nullopt;
  FaultConfig fault;
  ReadConfig(*node, &fault, &errors);
  return errors.empty() ? std::optional(fault) : std::nullopt;
}

}  // namespace

std::unique_ptr<LiveFaults> LiveFaults::Create(const std::string& directory, const char* name,
                                               std::string* error) {
  const std::string path = PathOf(directory, name);
  unlink(path.c_str());
  // Opened for both ways it is never at an end, whoever comes and goes.
  UniqueFd pipe(mkfifo(path.c_str(), 0600) == 0 ? open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC) : -1);
  if (!pipe.valid()) {
    *error = Complaint(path);
    return nullptr;
  }
  return std::unique_ptr<LiveFaults>(new LiveFaults(path, std::move(pipe)));
}

LiveFaults::~LiveFaults() {
  unlink(path_.c_str());
}

std::optional<FaultConfig> LiveFaults::Take(double now_s) {
  std::array<char, 512> bytes;
  const ssize_t size = read(pipe_.get(), bytes.data(), bytes.size());
  if (size > 0) text_.append(bytes.data(), static_cast<size_t>(size));
  const size_t end = text_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  auto fault = ReadFault(text_.substr(0, end));
  text_.erase(0, end + 1);
  if (!fault) return std::nullopt;
  fault->at_s += now_s;
  if (fault->until_s < FaultConfig::kForGood_s) fault->until_s += now_s;
  return fault;
}

bool SendLiveFault(const std::string& table, const std::string& directory, const char* name,
                   std::string* error) {
  const std::string path = PathOf(directory, name);
  const UniqueFd pipe(open(path.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC));
  const std::string line = table + "\n";
  const bool sent =
      pipe.valid() && write(pipe.get(), line.data(), line.size()) == static_cast<ssize_t>(line.size());
  if (sent) return true;
  *error = errno == ENOENT || errno == ENXIO ? "no run goes on in " + directory : Complaint(path);
  return false;
}

}  // namespace armada
