#include "host/report/draw.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "host/report/gnuplot.h"
#include "host/report/report_error.h"

namespace armada {
namespace {

std::string Reason(int error_number) {
  return error_number == 0 ? "" : std::string(": ") + std::strerror(error_number);
}

void WriteFile(const std::filesystem::path& path, const std::string& text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw ReportError("cannot write " + path.string() + Reason(errno));
}

// gnuplot does not say that a disk is full, but a picture then lacks its end.
void RequireWhole(const std::filesystem::path& picture) {
  constexpr std::uintmax_t kLittle = 65536;
  std::ifstream file(picture, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const char* const end = picture.extension() == ".png" ? "IEND" : "</svg>";
  if (text.find(end, text.size() - std::min<size_t>(text.size(), 16)) != std::string::npos) return;
  const bool full = std::filesystem::space(picture.parent_path()).available < kLittle;
  throw ReportError("gnuplot cannot write " + picture.string() + Reason(full ? ENOSPC : 0));
}

}  // namespace

void Draw(const Figure& figure, const std::string& script, const std::filesystem::path& folder) {
  const std::string script_name = figure.name + ".gp";
  WriteFile(folder / script_name, script);
  const std::filesystem::path pictures[] = {folder / (figure.name + ".svg"), folder / (figure.name + ".png")};
  for (const auto& picture : pictures) std::filesystem::remove(picture);
  try {
    RunGnuplot(folder, script_name);
    for (const auto& picture : pictures) RequireWhole(picture);
  } catch (const ReportError&) {
    for (const auto& picture : pictures) std::filesystem::remove(picture);
    throw;
  }
}

void WritePage(const std::string& html, const std::filesystem::path& folder,
               const std::filesystem::path& page) {
  const std::filesystem::path unfinished = folder / "report.html.part";
  try {
    WriteFile(unfinished, html);
  } catch (const ReportError&) {
    std::filesystem::remove(unfinished);
    throw;
  }
  std::filesystem::rename(unfinished, page);
}

}  // namespace armada
