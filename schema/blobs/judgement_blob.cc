#include "schema/blobs/judgement_blob.h"

namespace mapweld::blobs {
namespace {
constexpr char kFormat = 'J';
constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kLeastItemBytes = 10;  // an empty name, a value, no log-odds
}  // namespace

Bytes encode_judgement(std::span<const EvidenceItem> items) {
  ByteWriter writer(kFormat, kVersion);
  writer.varint(items.size());
  for (const EvidenceItem& item : items) {
    writer.varint(item.name.size());
    writer.raw({reinterpret_cast<const std::uint8_t*>(item.name.data()), item.name.size()});
    writer.f64(item.value);
    writer.u8(item.log_odds ? 1 : 0);
    if (item.log_odds) writer.f64(*item.log_odds);
  }
  return std::move(writer).finish();
}

std::vector<EvidenceItem> decode_judgement(std::span<const std::uint8_t> blob) {
  ByteReader reader(blob, kFormat, kVersion);
  std::vector<EvidenceItem> items(reader.varint32(reader.left() / kLeastItemBytes));
  for (EvidenceItem& item : items) {
    const auto name = reader.raw(reader.varint32(reader.left()));
    item.name.assign(name.begin(), name.end());
    item.value = reader.f64();
    const std::uint8_t is_weighed = reader.u8();
    if (is_weighed > 1) reader.corrupt("an item is neither weighed nor not");
    if (is_weighed == 1) item.log_odds = reader.f64();
  }
  reader.finish();
  return items;
}

}  // namespace mapweld::blobs
