#include <algorithm>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/vocabulary/appearance_vector.h"
#include "schema/blobs/appearance_blob.h"
#include "schema/blobs/byte_stream.h"
#include "schema/blobs/evidence_blob.h"
#include "schema/blobs/judgement_blob.h"
#include "schema/blobs/posting_blob.h"
#include "tests/support/temp_store.h"

namespace mapweld::blobs {
namespace {

using test::Random;

// Every single changed bit, and every shorter piece, of a blob must be told.
template <typename Decode>
void expect_damage_is_told(const Bytes& blob, Decode&& decode) {
  for (std::size_t bit = 0; bit<blob.size() * 8; bit += blob.size()> 400 ? 7 : 1) {
    Bytes damaged = blob;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    EXPECT_THROW(decode(damaged), StoreError) << "bit " << bit;
  }
  for (std::size_t length = 0; length < blob.size(); ++length) {
    EXPECT_THROW(decode(Bytes(blob.begin(), blob.begin() + static_cast<std::ptrdiff_t>(length))), StoreError) << length;
  }
  Bytes longer = blob;
  longer.push_back(0);
  EXPECT_THROW(decode(longer), StoreError);
}

// Bytes under a correct checksum that mean nothing must be told too, and never crash.
template <typename Decode>
void expect_nonsense_is_survived(char format, Decode&& decode, std::uint8_t version = 1) {
  Random random(99);
  for (int i = 0; i < 20'000; ++i) {
    ByteWriter writer(format, version);
    const std::size_t count = random.below(40);
    for (std::size_t k = 0; k < count; ++k) {
      writer.u8(static_cast<std::uint8_t>(random.chance(0.5) ? random.below(4) : random.below(256)));
    }
    const Bytes blob = std::move(writer).finish();
    try {
      decode(blob);
    } catch (const StoreError& error) {
      EXPECT_EQ(error.kind(), StoreErrorKind::kCorrupt);
    }
  }
}

TEST(ByteStream, NumbersComeBack) {
  const std::vector<std::uint64_t> numbers = {0, 1, 127, 128, 16'383, 16'384, UINT32_MAX, UINT64_MAX};
  const std::vector<std::int64_t> signed_numbers = {0, -1, 1, -64, 64, INT64_MAX, INT64_MIN};
  ByteWriter writer('T', 3);
  for (const auto n : numbers) writer.varint(n);
  for (const auto n : signed_numbers) writer.zigzag(n);
  writer.u16(0xBEEF);
  writer.f64(-0.1);
  const Bytes blob = std::move(writer).finish();
  ByteReader reader(blob, 'T', 3);
  EXPECT_EQ(reader.version(), 3);
  for (const auto n : numbers) EXPECT_EQ(reader.varint(), n);
  for (const auto n : signed_numbers) EXPECT_EQ(reader.zigzag(), n);
  EXPECT_EQ(reader.u16(), 0xBEEF);
  EXPECT_EQ(reader.f64(), -0.1);
  reader.finish();
  EXPECT_THROW(reader.u8(), StoreError);
}

// Byte by byte as docs/storage.md and the headers have it: what is stored must be read for ever.
TEST(Varint, IsLeb128) {
  const std::vector<std::pair<std::uint64_t, Bytes>> pinned = {
      {0, {0}},
      {127, {0x7F}},
      {128, {0x80, 0x01}},
      {300, {0xAC, 0x02}},
      {UINT64_MAX, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x01}}};
  for (const auto& [value, expected] : pinned) {
    Bytes bytes;
    append_varint(bytes, value);
    EXPECT_EQ(bytes, expected);
    bytes.push_back(0x55);
    const std::uint8_t* at = bytes.data();
    EXPECT_EQ(read_varint(at, bytes.data() + bytes.size()), value);
    EXPECT_EQ(at, bytes.data() + expected.size());
    for (std::size_t shorter = 0; shorter < expected.size(); ++shorter) {
      at = bytes.data();
      EXPECT_EQ(read_varint(at, bytes.data() + shorter), std::nullopt);
    }
  }
  const Bytes endless(11, 0x80);
  const std::uint8_t* at = endless.data();
  EXPECT_EQ(read_varint(at, endless.data() + endless.size()), std::nullopt);
  // The tenth byte has room for one bit.
  const std::vector<std::uint8_t> beyond{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x02};
  at = beyond.data();
  EXPECT_EQ(read_varint(at, beyond.data() + beyond.size()), std::nullopt);
}

TEST(PostingBlob, ItsBytesArePinned) {
  PostingList list;
  list.add(VertexId{1'000}, 0);
  for (int k = 0; k < 200; ++k) list.add(VertexId{1'002}, 0);
  PostingBlockWriter writer(VertexId{1'000}, 1'000, false);
  writer.add(WordId{300}, list);
  const auto blocks = std::move(writer).finish();
  ASSERT_EQ(blocks.size(), 1U);
  // One word, the 300th, of a list of four bytes: a vertex alone; one passed over, then 200 of the next.
  const Bytes payload(blocks[0].bytes.begin() + kFrameBytes, blocks[0].bytes.end());
  EXPECT_EQ(payload, (Bytes{1, 0xAC, 0x02, 4, 0, 3, 0xC6, 0x01}));
}

TEST(ByteStream, TheChecksumIsTheCommonCrc32) {
  const std::string check = "123456789";  // the check value of CRC-32/ISO-HDLC
  EXPECT_EQ(crc32({reinterpret_cast<const std::uint8_t*>(check.data()), check.size()}), 0xCBF43926U);
}

TEST(ByteStream, ANewerVersionIsToldApartFromDamage) {
  const Bytes blob = ByteWriter('T', 2).finish();
  try {
    ByteReader(blob, 'T', 1);
    FAIL();
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreErrorKind::kNewerVersion);
  }
}

TEST(AppearanceBlob, EveryImageComesBackBitForBit) {
  Random random(1);
  std::size_t bytes = 0;
  std::size_t appearances = 0;
  for (int i = 0; i < 300; ++i) {
    const AppearanceVector image = test::random_appearances(random, static_cast<int>(random.below(600)), 50'000);
    const Bytes blob = encode_appearances(image);
    EXPECT_EQ(decode_appearances(blob), image);
    IndexedFeatures features;
    decode_indexed(blob, features);
    EXPECT_TRUE(std::ranges::equal(features.words, image.appearances, {}, {}, &Appearance::word));
    EXPECT_EQ(features.signatures, std::vector<VoteSignature>(image.appearances.size(), 0));
    bytes += blob.size();
    appearances += image.appearances.size();
  }
  EXPECT_LT(static_cast<double>(bytes) / static_cast<double>(appearances), 10.0);
}

TEST(AppearanceBlob, SignaturesComeBackWhereThereAreAny) {
  Random random(2);
  AppearanceVector image = test::random_appearances(random, 300, 50'000);
  const Bytes without = encode_appearances(image);
  for (Appearance& a : image.appearances) {
    for (std::uint32_t& part : a.signature.bits)
      part = static_cast<std::uint32_t>(random.below(std::uint64_t{1} << 32));
  }
  const Bytes with = encode_appearances(image);
  EXPECT_EQ(decode_appearances(with), image);
  EXPECT_EQ(with.size(), without.size() + 300 * 16);
  EXPECT_EQ(without[1], 1) << "as versions before signatures wrote it";
  EXPECT_EQ(with[1], 2);
  IndexedFeatures features;
  decode_indexed(with, features);
  EXPECT_TRUE(std::ranges::equal(features.words, image.appearances, {}, {}, &Appearance::word));
  EXPECT_TRUE(std::ranges::equal(features.signatures, image.appearances, {}, {},
                                 [](const Appearance& a) { return vote_signature(a.signature); }));
}

TEST(AppearanceBlob, WhatIsStaticComesBackAndIsInNoIndex) {
  Random random(3);
  for (const bool with_signatures : {false, true}) {
    AppearanceVector image = test::random_appearances(random, 300, 50'000, with_signatures);
    const Bytes without = encode_appearances(image);
    image.static_appearances = test::random_appearances(random, 70, 50'000, with_signatures).appearances;
    const Bytes blob = encode_appearances(image);
    EXPECT_EQ(blob[1], 3);
    EXPECT_EQ(decode_appearances(blob), image);
    IndexedFeatures features, features_without;
    decode_indexed(blob, features);
    decode_indexed(without, features_without);
    EXPECT_EQ(features.words, features_without.words);
    EXPECT_EQ(features.signatures, features_without.signatures);
    image.appearances.clear();
    EXPECT_EQ(decode_appearances(encode_appearances(image)), image);
    expect_damage_is_told(encode_appearances(image), decode_appearances);
  }
}

TEST(AppearanceBlob, TheEndsOfTheGridComeBack) {
  AppearanceVector image{8192, 8192, {}};
  for (const WordId word : {WordId{0}, WordId{UINT32_MAX}}) {
    image.appearances.push_back({word, 0, 0, 0, 0});
    image.appearances.push_back({word, 65535 / 8.0f, 65535 / 8.0f, 65535 / 64.0f, 65535 / kAnglesPerDegree});
  }
  EXPECT_EQ(decode_appearances(encode_appearances(image)), image);
}

TEST(AppearanceBlob, WhatIsNotOnTheGridOrNotSortedIsRefused) {
  EXPECT_THROW(encode_appearances({320, 240, {{WordId{1}, 0.1f, 0, 0, 0}}}), FormatError);
  EXPECT_THROW(encode_appearances({320, 240, {{WordId{1}, -1, 0, 0, 0}}}), FormatError);
  EXPECT_THROW(encode_appearances({320, 240, {{WordId{2}, 0, 0, 0, 0}, {WordId{1}, 0, 0, 0, 0}}}), FormatError);
}

TEST(AppearanceBlob, DamageIsTold) {
  Random random(2);
  expect_damage_is_told(encode_appearances(test::random_appearances(random, 20, 1'000)), decode_appearances);
  expect_nonsense_is_survived('A', [](const Bytes& blob) { decode_appearances(blob); });
  expect_nonsense_is_survived(
      'A', [](const Bytes& blob) { decode_appearances(blob); }, 2);
  expect_nonsense_is_survived(
      'A', [](const Bytes& blob) { decode_appearances(blob); }, 3);
  expect_nonsense_is_survived('A', [](const Bytes& blob) {
    IndexedFeatures features;
    decode_indexed(blob, features);
  });
}

TEST(EvidenceBlob, EveryVerdictComesBackBitForBit) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    Verification verdict = test::random_verification(random, static_cast<int>(random.below(200)), 500, 65'536);
    Verification back = verdict;
    back.kind = GeometryKind::kNone;
    back.geometry = {};
    back.inlier_matches = {{1, 2}};
    decode_evidence(encode_evidence(verdict), back);
    EXPECT_EQ(back, verdict);
  }
}

TEST(EvidenceBlob, DamageIsTold) {
  Random random(4);
  const auto decode = [](const Bytes& blob) {
    Verification verdict;
    decode_evidence(blob, verdict);
  };
  expect_damage_is_told(encode_evidence(test::random_verification(random, 15, 500, 500)), decode);
  expect_nonsense_is_survived('E', decode);
}

std::vector<EvidenceItem> random_items(Random& random) {
  std::vector<EvidenceItem> items(random.below(9));
  for (EvidenceItem& item : items) {
    item.name.assign(random.below(40), 'x');
    for (char& c : item.name) c = static_cast<char>('a' + random.below(26));
    item.value = (random.unit() - 0.5) * 1e6;
    if (random.chance(0.5)) item.log_odds = (random.unit() - 0.5) * 20;
  }
  return items;
}

TEST(JudgementBlob, EveryItemComesBackBitForBit) {
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    const std::vector<EvidenceItem> items = random_items(random);
    EXPECT_EQ(decode_judgement(encode_judgement(items)), items);
  }
}

TEST(JudgementBlob, DamageIsTold) {
  const auto decode = [](const Bytes& blob) { decode_judgement(blob); };
  const std::vector<EvidenceItem> items = {{"rare_matches", 31, 2.5}, {"spread_diagonals", 0.25, std::nullopt}};
  expect_damage_is_told(encode_judgement(items), decode);
  expect_nonsense_is_survived('J', decode);
}

struct List {
  WordId word;
  PostingList postings;
};

std::vector<List> random_lists(Random& random, std::uint32_t first, std::uint32_t vertices, std::uint32_t words,
                               bool with_signatures) {
  std::vector<List> lists;
  for (std::uint32_t word = 0; word < words; ++word) {
    if (random.chance(0.5)) continue;
    List list{WordId{word * 7}, {}};
    const double density = random.unit() * random.unit();
    for (std::uint32_t v = first; v < first + vertices; ++v) {
      if (!random.chance(density)) continue;
      const auto count = random.chance(0.8) ? 1 : random.chance(0.9) ? 1 + random.below(5) : 1 + random.below(400);
      for (std::uint64_t k = 0; k < count; ++k) {
        list.postings.add(VertexId{v}, with_signatures ? random.below(UINT64_MAX) : 0);
      }
    }
    if (list.postings.size() > 0) lists.push_back(std::move(list));
  }
  return lists;
}

TEST(PostingBlob, EveryListComesBackWhateverTheBlocks) {
  Random random(5);
  for (const std::size_t target : {1UL, 100UL, 3'800UL, 1'000'000UL, 101UL, 3'801UL}) {
    const bool with_signatures = target % 2 == 0;
    const auto lists = random_lists(random, 1'000, 300, 200, with_signatures);
    PostingBlockWriter writer(VertexId{1'000}, target, with_signatures);
    for (const List& list : lists) writer.add(list.word, list.postings);
    std::size_t at = 0;
    for (const auto& block : std::move(writer).finish()) {
      const PostingBlock read(block.bytes, VertexId{1'000}, 300);
      ASSERT_GT(read.words(), 0U);
      EXPECT_EQ(read.word(0), block.first_word);
      for (std::size_t i = 0; i < read.words(); ++i, ++at) {
        ASSERT_LT(at, lists.size());
        EXPECT_EQ(read.word(i), lists[at].word);
        PostingList postings;
        read.postings(i, postings);
        EXPECT_EQ(postings, lists[at].postings);
        postings.clear();
        read.find(lists[at].word, postings);
        EXPECT_EQ(postings, lists[at].postings);
        postings.clear();
        read.find(WordId{to_index(lists[at].word) + 1}, postings);
        EXPECT_EQ(postings.size(), 0U);
      }
    }
    EXPECT_EQ(at, lists.size());
  }
}

TEST(PostingBlob, DamageIsTold) {
  Random random(6);
  const auto decode = [](const Bytes& blob) {
    const PostingBlock block(blob, VertexId{5}, 30);
    PostingList postings;
    for (std::size_t i = 0; i < block.words(); ++i) block.postings(i, postings);
  };
  for (const bool with_signatures : {false, true}) {
    PostingBlockWriter writer(VertexId{5}, 1'000'000, with_signatures);
    for (const List& list : random_lists(random, 5, 30, 10, with_signatures)) writer.add(list.word, list.postings);
    const auto blocks = std::move(writer).finish();
    expect_damage_is_told(blocks.at(0).bytes, decode);
  }
  expect_nonsense_is_survived('P', decode);
}

}  // namespace
}  // namespace mapweld::blobs
