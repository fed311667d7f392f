#include "hil/cia402_dictionary.h"

#include "firmware/can/canopen_messages.h"
#include "firmware/can/cia402_messages.h"

namespace armada {
namespace {

using canopen::SdoAbort;
using cia402::Access;
using cia402::Entry;
using cia402::Object;

constexpr uint32_t kPdoBits = 64;

size_t PlaceOf(const Object& object) {
  return static_cast<size_t>(&object - cia402::Objects().data());
}

uint32_t Fit(const Object& object, int64_t value) {
  const unsigned bits = 8u * cia402::BytesOf(object.type);
  return static_cast<uint32_t>(value) & static_cast<uint32_t>((uint64_t{1} << bits) - 1);
}

constexpr bool IsCommunication(uint16_t index) {
  return index == cia402::kRpdo1 || index == cia402::kTpdo1 || index == cia402::kTpdo2;
}
constexpr bool IsMapping(uint16_t index) {
  return IsCommunication(static_cast<uint16_t>(index - cia402::MappingOf(0)));
}

}  // namespace

Cia402Dictionary::Cia402Dictionary(const JointDriveConfig& joint)
    : joint_(joint), raw_(cia402::Objects().size()) {
  Reset(0, UINT16_MAX);
}

void Cia402Dictionary::Reset(uint16_t first, uint16_t last) {
  for (const Object& object : cia402::Objects()) {
    if (object.entry.index < first || object.entry.index > last) continue;
    raw_[PlaceOf(object)] = cia402::DefaultOf(object, joint_);
  }
}

uint32_t Cia402Dictionary::Raw(Entry entry) const {
  return raw_[PlaceOf(*cia402::Find(entry))];
}

int64_t Cia402Dictionary::Get(Entry entry) const {
  return cia402::ValueOf(cia402::Find(entry)->type, Raw(entry));
}

void Cia402Dictionary::Set(Entry entry, int64_t value) {
  const Object& object = *cia402::Find(entry);
  raw_[PlaceOf(object)] = Fit(object, value);
}

SdoAbort Cia402Dictionary::Read(Entry entry, uint8_t* bytes, uint32_t* raw) const {
  const Object* object = cia402::Find(entry);
  if (object == nullptr) {
    return cia402::Find({entry.index, 0}) == nullptr ? SdoAbort::kNoObject : SdoAbort::kNoSubIndex;
  }
  *bytes = cia402::BytesOf(object->type);
  *raw = raw_[PlaceOf(*object)];
  return SdoAbort::kNone;
}

SdoAbort Cia402Dictionary::Write(Entry entry, uint8_t bytes, uint32_t raw) {
  const Object* object = cia402::Find(entry);
  if (object == nullptr) {
    return cia402::Find({entry.index, 0}) == nullptr ? SdoAbort::kNoObject : SdoAbort::kNoSubIndex;
  }
  if (object->access != Access::kReadWrite) return SdoAbort::kReadOnly;
  if (bytes > cia402::BytesOf(object->type)) return SdoAbort::kTooLong;
  if (bytes != 0 && bytes < cia402::BytesOf(object->type)) return SdoAbort::kTooShort;
  raw = Fit(*object, raw);
  const SdoAbort abort = CheckValue(*object, raw);
  if (abort == SdoAbort::kNone) raw_[PlaceOf(*object)] = raw;
  return abort;
}

void Cia402Dictionary::WriteMapped(Entry entry, uint32_t raw) {
  const Object& object = *cia402::Find(entry);
  if (CheckValue(object, raw) == SdoAbort::kNone) raw_[PlaceOf(object)] = raw;
}

bool Cia402Dictionary::Exists(uint16_t pdo) const {
  return (Raw({pdo, 1}) & canopen::kPdoInvalid) == 0;
}

SdoAbort Cia402Dictionary::CheckValue(const Object& object, uint32_t raw) const {
  const int64_t value = cia402::ValueOf(object.type, raw);
  if (object.low != object.high && value < object.low) return SdoAbort::kValueTooLow;
  if (object.low != object.high && value > object.high) return SdoAbort::kValueTooHigh;
  if (object.entry == cia402::kMode && value != 0 &&
      (Raw(cia402::kSupportedModes) >> (value - 1) & 1u) == 0) {
    return SdoAbort::kValueRange;
  }
  if (IsCommunication(object.entry.index)) return CheckCommunication(object.entry, raw);
  if (IsMapping(object.entry.index)) return CheckMapping(object.entry, raw);
  return SdoAbort::kNone;
}

/// CiA 301 7.5.2.35 and 7.5.2.37.
SdoAbort Cia402Dictionary::CheckCommunication(Entry entry, uint32_t raw) const {
  const bool receive = entry.index == cia402::kRpdo1;
  if (entry.sub == 1) {
    constexpr uint32_t kReserved = ~(canopen::kPdoInvalid | canopen::kNoRemoteFrame | canopen::kCanIdMask);
    if ((raw & kReserved) != 0) return SdoAbort::kValueRange;
    // The identifier changes only while the PDO does not exist.
    const bool stays = Exists(entry.index) && (raw & canopen::kPdoInvalid) == 0;
    if (stays && ((raw ^ Raw(entry)) & canopen::kCanIdMask) != 0) return SdoAbort::kValueRange;
  } else if (entry.sub == 2) {
    const bool synchronous = raw <= canopen::kMaxSyncs && (receive || raw > 0);
    if (!synchronous && raw < canopen::kOnEvent - 1) return SdoAbort::kValueRange;
  }
  return SdoAbort::kNone;
}

/// CiA 301 7.5.2.36 and 7.5.2.38.
SdoAbort Cia402Dictionary::CheckMapping(Entry entry, uint32_t raw) const {
  const auto pdo = static_cast<uint16_t>(entry.index - cia402::MappingOf(0));
  if (Exists(pdo)) return SdoAbort::kUnsupportedAccess;
  if (entry.sub > 0) {
    if (Raw({entry.index, 0}) != 0) return SdoAbort::kUnsupportedAccess;
    const Object* mapped = cia402::Find({static_cast<uint16_t>(raw >> 16), static_cast<uint8_t>(raw >> 8)});
    if (mapped == nullptr) return SdoAbort::kNoObject;
    const bool receive = pdo == cia402::kRpdo1;
    const bool fits = mapped->mappable && (raw & 0xFF) == 8u * cia402::BytesOf(mapped->type) &&
                      (!receive || mapped->access == Access::kReadWrite);
    return fits ? SdoAbort::kNone : SdoAbort::kNotMappable;
  }
  const auto count = static_cast<uint8_t>(raw);
  uint32_t bits = 0;
  for (uint8_t sub = 1; sub <= count; ++sub) {
    const uint32_t mapping = Raw({entry.index, sub});
    if (mapping == 0) return SdoAbort::kNotMappable;
    bits += mapping & 0xFF;
  }
  return bits <= kPdoBits ? SdoAbort::kNone : SdoAbort::kPdoTooLong;
}

}  // namespace armada
