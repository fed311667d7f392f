#include <algorithm>
#include <iterator>
#include <vector>

#include "firmware/link/seal.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/input_key.h"
#include "tests/fuzz/require.h"

namespace armada {
namespace {

constexpr int kSender = 3;
constexpr const char* kChannels[] = {"EST_3", "TEL_3", "ACK_3", "EST_30", "EST_", "CMD"};

/// A message as it was on the wire.
struct Sent {
  std::string_view channel;
  std::vector<uint8_t> bytes;
  bool operator==(const Sent&) const = default;
};

/// One sender's seals, and a receiver that gets them, and what others make of them, in any order.
class Envelopes {
 public:
  explicit Envelopes(const FleetKey& key) : key_(key) {}

  /// What an input tells to do: a byte, then the bytes that the action reads.
  void Do(ByteSource* choices) {
    switch (choices->Byte() % 7) {
      case 0:
        return Seal(choices);
      case 1:  // the newest, as it is
        if (!sent_.empty()) Hand(sent_.back());
        return;
      case 2:  // any one, as it is
        if (!sent_.empty()) Hand(sent_[choices->Byte() % sent_.size()]);
        return;
      case 3: {  // with a byte changed
        Sent changed = Newest();
        if (!changed.bytes.empty())
          changed.bytes[choices->Unsigned(2) % changed.bytes.size()] ^= choices->Byte();
        return Hand(changed);
      }
      case 4: {  // with bytes more or less
        Sent changed = Newest();
        const int more = choices->Signed16() % 64;
        changed.bytes.resize(static_cast<size_t>(std::max(0, static_cast<int>(changed.bytes.size()) + more)));
        return Hand(changed);
      }
      case 5: {  // on another channel
        Sent changed = Newest();
        changed.channel = kChannels[choices->Byte() % std::size(kChannels)];
        return Hand(changed);
      }
      case 6: {  // any bytes
        Sent any{kChannels[choices->Byte() % std::size(kChannels)], std::vector<uint8_t>(choices->Byte())};
        choices->Take(any.bytes);
        return Hand(any);
      }
    }
  }

 private:
  Sent Newest() const { return sent_.empty() ? Sent{kChannels[0], {}} : sent_.back(); }

  void Seal(ByteSource* choices) {
    if (choices->Byte() % 8 == 0) sealer_ = Sealer({key_, ++epoch_}, kSender);
    const char* const channel = kChannels[choices->Byte() % std::size(kChannels)];
    MessageBuffer buffer;
    const size_t size = choices->Byte();
    choices->Take(std::span(buffer).first(size));
    const auto sealed = sealer_.Seal(channel, std::span(buffer).first(size), &buffer);
    sent_.push_back({channel, {sealed.begin(), sealed.end()}});
  }

  /// Genuine is exactly what was sealed so and comes after all that were taken.
  void Hand(const Sent& given) {
    const auto sealed = std::find(sent_.begin(), sent_.end(), given);
    const auto expected = sealed == sent_.end()            ? SealVerdict::kForged
                          : sealed - sent_.begin() < next_ ? SealVerdict::kReplayed
                                                           : SealVerdict::kGenuine;
    std::span<const uint8_t> message = given.bytes;
    Require(check_.Open(given.channel, &message) == expected, "a seal tells what was sent and is new");
    const size_t seal_size = expected == SealVerdict::kGenuine ? kSealSize : 0;
    Require(message.size() + seal_size == given.bytes.size(), "and is taken off only then");
    if (expected == SealVerdict::kGenuine) next_ = sealed - sent_.begin() + 1;
  }

  FleetKey key_;
  uint64_t epoch_ = 1;
  Sealer sealer_{{key_, 1}, kSender};
  SealCheck check_{key_, kSender};
  std::vector<Sent> sent_;
  std::ptrdiff_t next_ = 0;  ///< the first of them that is newer than all that were taken
};

}  // namespace
}  // namespace armada

/// Sealed messages, changed in any way.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace armada;
  ByteSource choices({data, size});
  Envelopes envelopes(KeyOf({data, size}));
  while (!choices.empty()) envelopes.Do(&choices);
  return 0;
}
