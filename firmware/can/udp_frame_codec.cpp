#include "firmware/can/udp_frame_codec.h"

#include <algorithm>
#include <bit>
#include <string_view>

#include "firmware/can/msgpack.h"

namespace armada {
namespace {

enum Key : uint32_t {
  kTimestamp,
  kId,
  kExtended,
  kRemote,
  kError,
  kChannel,
  kLength,
  kData,
  kFd,
  kBitrateSwitch,
  kErrorState,
  kKeys,
};

constexpr std::array<std::string_view, kKeys> kNames = {
    "timestamp", "arbitration_id", "is_extended_id", "is_remote_frame", "is_error_frame",        "channel",
    "dlc",       "data",           "is_fd",          "bitrate_switch",  "error_state_indicator",
};
constexpr uint32_t kAll = (1u << kKeys) - 1;
constexpr uint32_t kOptional = 1u << kTimestamp | 1u << kChannel;

template <class Unsigned>
bool ReadUpTo(MsgpackReader* in, uint64_t limit, Unsigned* value) {
  uint64_t wide = 0;
  if (!in->ReadUnsigned(&wide) || wide > limit) return false;
  *value = static_cast<Unsigned>(wide);
  return true;
}

/// Reads the value of `key` into `frame`; the payload's size goes to `data_size`.
bool ReadValue(Key key, MsgpackReader* in, CanFrame* frame, size_t* data_size) {
  switch (key) {
    case kTimestamp:
      return in->SkipNumber();
    case kId:
      return ReadUpTo(in, UINT32_MAX, &frame->id);
    case kExtended:
      return in->ReadBool(&frame->extended);
    case kRemote:
      return in->ReadBool(&frame->remote);
    case kError:
      return in->ReadBool(&frame->error);
    case kLength:
      return ReadUpTo(in, frame->data.size(), &frame->length);
    case kData: {
      std::span<const uint8_t> data;
      if (!in->ReadBytes(&data) || data.size() > frame->data.size()) return false;
      std::copy(data.begin(), data.end(), frame->data.begin());
      *data_size = data.size();
      return true;
    }
    case kFd:
      return in->ReadBool(&frame->fd);
    case kBitrateSwitch:
      return in->ReadBool(&frame->bitrate_switch);
    case kErrorState:
      return in->ReadBool(&frame->error_state_indicator);
    case kChannel:
    case kKeys:
      return in->Skip();
  }
  return false;
}

}  // namespace

size_t EncodeUdpFrame(const CanFrame& frame, double timestamp_s, UdpFrameBuffer* buffer) {
  if (!IsValid(frame)) return 0;
  MsgpackWriter out(*buffer);
  out.MapHeader(kKeys);
  out.String(kNames[kTimestamp]);
  out.Float64(timestamp_s);
  out.String(kNames[kId]);
  out.Unsigned(frame.id);
  out.String(kNames[kExtended]);
  out.Bool(frame.extended);
  out.String(kNames[kRemote]);
  out.Bool(frame.remote);
  out.String(kNames[kError]);
  out.Bool(frame.error);
  out.String(kNames[kChannel]);
  out.Nil();
  out.String(kNames[kLength]);
  out.Unsigned(frame.length);
  out.String(kNames[kData]);
  out.Bytes({frame.data.data(), frame.remote ? size_t{0} : frame.length});
  out.String(kNames[kFd]);
  out.Bool(frame.fd);
  out.String(kNames[kBitrateSwitch]);
  out.Bool(frame.bitrate_switch);
  out.String(kNames[kErrorState]);
  out.Bool(frame.error_state_indicator);
  return out.size();
}

bool DecodeUdpFrame(std::span<const uint8_t> datagram, CanFrame* frame) {
  MsgpackReader in(datagram);
  CanFrame read;
  size_t data_size = 0;
  uint32_t seen = 0;
  uint32_t pairs = 0;
  if (!in.ReadMapHeader(&pairs)) return false;
  for (; pairs > 0; --pairs) {
    std::string_view name;
    if (!in.ReadString(&name)) return false;
    const auto key = static_cast<Key>(std::find(kNames.begin(), kNames.end(), name) - kNames.begin());
    if (!ReadValue(key, &in, &read, &data_size)) return false;
    if (key == kKeys) continue;
    if (seen & 1u << key) return false;
    seen |= 1u << key;
  }
  if ((seen | kOptional) != kAll || !in.at_end()) return false;
  if (data_size != (read.remote ? 0u : read.length) || !IsValid(read)) return false;
  *frame = read;
  return true;
}

}  // namespace armada
