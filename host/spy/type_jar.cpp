#include "host/spy/type_jar.h"

#include <stdlib.h>

#include <fstream>

#include "firmware/app/digest.h"
#include "host/process_group.h"
#include "host/spy/java_packages.h"

namespace armada {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::minutes kPatience{2};

/// A folder of this process alone, gone with the object.
class ScratchFolder {
 public:
  explicit ScratchFolder(const fs::path& parent) {
    std::string name = parent / "making-XXXXXX";
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  /// Empty if it could not be made.
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

bool RunTool(const fs::path& folder, std::vector<std::string> argv, std::string* error) {
  const std::string tool = argv.front();
  ProcessGroup group;
  if (!group.Start({tool, std::move(argv), {}, folder / "tool.log"}, error)) return false;
  const auto ended = group.Poll(kPatience);
  if (!ended) {
    *error = ProcessGroup::StopRequested() ? "interrupted" : tool + " does not come to an end";
    return false;
  }
  if (!ended->Succeeded()) *error = ended->Describe();
  return ended->Succeeded();
}

std::vector<std::string> JavaSources(const fs::path& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".java") files.push_back(entry.path());
  }
  return files;
}

// types -> *.lcm -> *.java -> *.class -> types.jar, all in `folder`.
bool Compile(const std::vector<MessageType>& types, const fs::path& folder, std::string* error) {
  std::vector<std::string> generate = {kLcmGen, "--java", "--jpath", folder};
  for (const MessageType& type : types) {
    generate.push_back(folder / type.file);
    std::ofstream file(generate.back());
    if (!(file << type.text).flush()) {
      *error = "cannot write " + generate.back();
      return false;
    }
  }
  if (!RunTool(folder, std::move(generate), error)) return false;

  const std::string classes = folder / "classes";
  std::vector<std::string> compile = {kJavac, "-encoding", "UTF-8", "-classpath", kLcmJar, "-d", classes};
  const auto sources = JavaSources(folder);
  compile.insert(compile.end(), sources.begin(), sources.end());
  return RunTool(folder, std::move(compile), error) &&
         RunTool(folder, {kJar, "--create", "--file", folder / "types.jar", "-C", classes, "."}, error);
}

}  // namespace

std::optional<fs::path> CacheDirectory(std::string* error) {
  const char* cache = getenv("XDG_CACHE_HOME");
  if (cache != nullptr && fs::path(cache).is_absolute()) return fs::path(cache) / "armada";
  const char* home = getenv("HOME");
  if (home != nullptr && fs::path(home).is_absolute()) return fs::path(home) / ".cache" / "armada";
  *error = "neither XDG_CACHE_HOME nor HOME names a folder, so there is none for the jar of message types";
  return std::nullopt;
}

fs::path TypeJarPath(const std::vector<MessageType>& types, const fs::path& cache) {
  std::string text;
  for (const MessageType& type : types) text += type.file + '\0' + type.text + '\0';
  return cache / ("lcmtypes-" + Digest(text) + ".jar");
}

bool MakeTypeJar(const std::vector<MessageType>& types, const fs::path& cache, std::string* error) {
  std::error_code code;
  fs::create_directories(cache, code);
  const ScratchFolder scratch(cache);
  if (scratch.path().empty()) {
    *error = "cannot write into " + cache.string();
    return false;
  }
  if (!Compile(types, scratch.path(), error)) return false;
  // The name appears with the whole content. Who comes second replaces the same by the same.
  fs::rename(scratch.path() / "types.jar", TypeJarPath(types, cache), code);
  if (code) *error = "cannot write " + TypeJarPath(types, cache).string() + ": " + code.message();
  return !code;
}

}  // namespace armada
