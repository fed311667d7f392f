#include "host/sweep/result_table.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <system_error>
#include <utility>

namespace armada {
namespace {

std::optional<double> OrNone(double value) {
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

}  // namespace

ResultTable::ResultTable(size_t rows, std::vector<int> arm_ids) : rows_(rows), arm_ids_(std::move(arm_ids)) {
  if (rows_ == 0) return;
  const auto fail = [] {
    throw std::system_error(errno, std::generic_category(), "no temporary file for the results");
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), std::fclose);
  if (!file) fail();
  // Allocated, not only sized: a full disk is an error now, not a SIGBUS in an hour.
  if (const int code = posix_fallocate(fileno(file.get()), 0, static_cast<off_t>(bytes())); code != 0) {
    errno = code;
    fail();
  }
  void* const memory = mmap(nullptr, bytes(), PROT_READ | PROT_WRITE, MAP_SHARED, fileno(file.get()), 0);
  if (memory == MAP_FAILED) fail();
  values_ = static_cast<double*>(memory);
}

ResultTable::ResultTable(ResultTable&& other) noexcept
    : rows_(other.rows_),
      arm_ids_(std::move(other.arm_ids_)),
      values_(std::exchange(other.values_, nullptr)) {}

ResultTable& ResultTable::operator=(ResultTable&& other) noexcept {
  std::swap(rows_, other.rows_);
  std::swap(arm_ids_, other.arm_ids_);
  std::swap(values_, other.values_);
  return *this;
}

ResultTable::~ResultTable() {
  if (values_ != nullptr) munmap(values_, bytes());
}

void ResultTable::Set(size_t row, const SeedResult& result) {
  double* value = values_ + row;
  const auto put = [&](double figure) {
    *value = figure;
    value += rows_;
  };
  put(std::bit_cast<double>(result.seed));
  put(result.ok ? 1.0 : 0.0);
  put(result.fleet_rms_mm);
  put(result.floor_rms_mm.value_or(kNoFigure));
  for (const SeedResult::Arm& arm : result.arms) {
    put(arm.diverged ? 1.0 : 0.0);
    put(arm.settled_s.value_or(kNoFigure));
    put(arm.rms_mm);
    put(arm.max_mm);
    put(arm.estimator_x_m);
    put(arm.floor_rms_mm.value_or(kNoFigure));
  }
}

uint64_t ResultTable::seed(size_t row) const {
  return std::bit_cast<uint64_t>(Column(kSeed)[row]);
}

bool ResultTable::has_floors() const {
  return rows_ > 0 && !std::isnan(fleet_floor_rms_mm()[0]);
}

SeedResult ResultTable::At(size_t row) const {
  SeedResult result{seed(row), ok(row), fleet_rms_mm()[row], OrNone(fleet_floor_rms_mm()[row]), {}};
  for (size_t i = 0; i < arm_ids_.size(); ++i) {
    result.arms.push_back({arm_ids_[i], diverged(i)[row] != 0.0, OrNone(settled_s(i)[row]), rms_mm(i)[row],
                           max_mm(i)[row], estimator_x_m(i)[row], OrNone(floor_rms_mm(i)[row])});
  }
  return result;
}

}  // namespace armada
