#include "firmware/app/whole_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "firmware/unique_fd.h"

namespace armada {
namespace {

namespace fs = std::filesystem;

std::string Temporary(const std::string& path) {
  return path + ".part";
}

bool WriteTemporary(const std::string& path, const std::function<void(std::ostream&)>& write,
                    std::string* error) {
  const fs::path target(path);
  std::error_code ignored;  // opening the file says what is wrong
  if (target.has_parent_path()) fs::create_directories(target.parent_path(), ignored);
  errno = 0;
  std::ofstream file(Temporary(path));
  write(file);
  file.close();
  if (file) return true;
  *error = "cannot write " + path + ": " + std::strerror(errno);
  fs::remove(Temporary(path), ignored);
  return false;
}

// On the disk: a file before it takes the place of the old one, a folder before its new entry is relied on.
// Some file systems tell only now that there is no room; some cannot do it to a folder.
bool Sync(const std::string& path) {
  const UniqueFd file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  return !file.valid() || fsync(file.get()) == 0 || errno == EINVAL;
}

}  // namespace

bool WriteWhole(const std::string& path, const std::function<void(std::ostream&)>& write,
                std::string* error) {
  if (!WriteTemporary(path, write, error)) return false;
  std::error_code code;
  if (!Sync(Temporary(path))) {
    *error = "cannot write " + path + ": " + std::strerror(errno);
    fs::remove(Temporary(path), code);
    return false;
  }
  fs::rename(Temporary(path), path, code);
  if (code) {
    *error = "cannot write " + path + ": " + code.message();
    return false;
  }
  const fs::path folder = fs::path(path).parent_path();
  Sync(folder.empty() ? "." : folder.string());
  return true;
}

bool CanWriteWhole(const std::string& path, std::string* error) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    *error = "cannot write " + path + ": " + std::strerror(EISDIR);
    return false;
  }
  if (!WriteTemporary(
          path, [](std::ostream&) {}, error))
    return false;
  fs::remove(Temporary(path), ignored);
  return true;
}

}  // namespace armada
