#include "schema/segments/segment_postings.h"

#include <algorithm>
#include <string>
#include <utility>

#include "schema/blobs/appearance_blob.h"
#include "schema/blobs/posting_blob.h"

namespace mapweld {
namespace {

// A block with its row fits one page of 4 KiB.
constexpr std::size_t kBlockBytes = 3'800;

}  // namespace

std::optional<SegmentPostings> invert_appearances(const Reader& db, MapId map, VocabularyId vocabulary, VertexId first,
                                                  std::uint32_t count) {
  // Every image's words ascend, and images come in order: counting how often each word is posted tells where its list
  // begins, and a second pass over the images fills the lists.
  blobs::IndexedFeatures all;         // of all images, one after another
  std::vector<std::size_t> ends;      // of each image, in `all`
  std::vector<std::uint32_t> posted;  // by word
  blobs::IndexedFeatures image;
  sqlite::Statement row = db.prepare(
      "SELECT vertex, bytes FROM appearances WHERE map = ? AND vertex >= ? AND vertex < ? AND vocabulary = ? "
      "ORDER BY vertex");
  const std::uint64_t begin = to_index(first);
  row.bind_all(map, begin, begin + count, vocabulary);
  const VertexSet purged = purged_vertices(db, map);
  const auto pass_over_purged = [&] {
    while (ends.size() < count && purged.contains(VertexId{static_cast<std::uint32_t>(begin + ends.size())})) {
      ends.push_back(all.words.size());
    }
  };
  while (row.step()) {
    pass_over_purged();
    if (static_cast<std::uint64_t>(row.integer(0)) != begin + ends.size()) return std::nullopt;
    blobs::decode_indexed(row.blob(1), image);
    if (!image.words.empty() && to_index(image.words.back()) >= posted.size()) {
      posted.resize(std::size_t{to_index(image.words.back())} + 1);
    }
    for (const WordId word : image.words) ++posted[to_index(word)];
    all.words.insert(all.words.end(), image.words.begin(), image.words.end());
    all.signatures.insert(all.signatures.end(), image.signatures.begin(), image.signatures.end());
    ends.push_back(all.words.size());
  }
  pass_over_purged();
  if (ends.size() != count) return std::nullopt;

  SegmentPostings segment{first, count, {}, {}, {}};
  std::uint32_t postings = 0;
  for (std::size_t word = 0; word < posted.size(); ++word) {
    if (posted[word] == 0) continue;
    segment.words.push_back(WordId{static_cast<std::uint32_t>(word)});
    segment.offsets.push_back(postings);
    postings += std::exchange(posted[word], postings);  // from here on: where its next posting goes
  }
  segment.offsets.push_back(postings);
  segment.postings.resize(postings);
  std::size_t i = 0;
  for (std::uint32_t vertex = 0; vertex < count; ++vertex) {
    for (; i < ends[vertex]; ++i) {
      const std::uint32_t at = posted[to_index(all.words[i])]++;
      segment.postings.vertices[at] = VertexId{to_index(first) + vertex};
      segment.postings.signatures[at] = all.signatures[i];
    }
  }
  return segment;
}

SegmentPostings read_segment(const Reader& db, const SegmentRow& row) {
  SegmentPostings segment{row.first, row.count, {}, {}, {}};
  sqlite::Statement block_row =
      db.prepare("SELECT first_word, bytes FROM posting_blocks WHERE segment = ? ORDER BY first_word");
  block_row.bind(1, row.id);
  while (block_row.step()) {
    const blobs::PostingBlock block(block_row.blob(1), row.first, row.count);
    for (std::size_t i = 0; i < block.words(); ++i) {
      if (!segment.words.empty() && block.word(i) <= segment.words.back()) {
        throw StoreError(StoreErrorKind::kCorrupt, "the blocks of a segment overlap");
      }
      segment.words.push_back(block.word(i));
      segment.offsets.push_back(static_cast<std::uint32_t>(segment.postings.size()));
      block.postings(i, segment.postings);
    }
  }
  segment.offsets.push_back(static_cast<std::uint32_t>(segment.postings.size()));
  if (segment.postings.size() != row.postings) {
    throw StoreError(StoreErrorKind::kCorrupt, "segment " + std::to_string(to_index(row.id)) + " has " +
                                                   std::to_string(segment.postings.size()) + " postings, not " +
                                                   std::to_string(row.postings));
  }
  return segment;
}

SegmentPostings concatenate(std::span<const SegmentPostings> neighbours) {
  SegmentPostings all{neighbours.front().first, 0, {}, {}, {}};
  for (const SegmentPostings& segment : neighbours) {
    all.count += segment.count;
    all.words.insert(all.words.end(), segment.words.begin(), segment.words.end());
  }
  std::ranges::sort(all.words);
  all.words.erase(std::unique(all.words.begin(), all.words.end()), all.words.end());
  std::vector<std::size_t> at(neighbours.size(), 0);
  for (const WordId word : all.words) {
    all.offsets.push_back(static_cast<std::uint32_t>(all.postings.size()));
    for (std::size_t s = 0; s < neighbours.size(); ++s) {
      if (at[s] == neighbours[s].words.size() || neighbours[s].words[at[s]] != word) continue;
      all.postings.append(neighbours[s].of(at[s]++));
    }
  }
  all.offsets.push_back(static_cast<std::uint32_t>(all.postings.size()));
  return all;
}

SegmentPostings cut(const SegmentPostings& segment, VertexId first, std::uint32_t count, VertexId renumbered_first) {
  SegmentPostings part{renumbered_first, count, {}, {}, {}};
  for (std::size_t i = 0; i < segment.words.size(); ++i) {
    const std::size_t before = part.postings.size();
    const PostingSpan list = segment.of(i);
    for (std::size_t k = 0; k < list.size(); ++k) {
      // Wraps round for a vertex before the first, and is then beyond the count.
      const std::uint32_t offset = to_index(list.vertices[k]) - to_index(first);
      if (offset < count) part.postings.add(VertexId{to_index(renumbered_first) + offset}, list.signatures[k]);
    }
    if (part.postings.size() == before) continue;
    part.words.push_back(segment.words[i]);
    part.offsets.push_back(static_cast<std::uint32_t>(before));
  }
  part.offsets.push_back(static_cast<std::uint32_t>(part.postings.size()));
  return part;
}

SegmentPostings without(SegmentPostings segment, const VertexSet& vertices) {
  if (vertices.empty()) return segment;
  SegmentPostings left{segment.first, segment.count, {}, {}, {}};
  PostingList of_word;
  for (std::size_t i = 0; i < segment.words.size(); ++i) {
    of_word.clear();
    of_word.append(segment.of(i));
    remove_postings(of_word, vertices);
    if (of_word.size() == 0) continue;
    left.words.push_back(segment.words[i]);
    left.offsets.push_back(static_cast<std::uint32_t>(left.postings.size()));
    left.postings.append(of_word);
  }
  left.offsets.push_back(static_cast<std::uint32_t>(left.postings.size()));
  return left;
}

void remove_postings(PostingList& postings, const VertexSet& vertices) {
  if (vertices.empty()) return;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < postings.size(); ++k) {
    if (vertices.contains(postings.vertices[k])) continue;
    postings.vertices[kept] = postings.vertices[k];
    postings.signatures[kept] = postings.signatures[k];
    ++kept;
  }
  postings.resize(kept);
}

SegmentId insert_segment(WriteTransaction& db, MapId map, VocabularyId vocabulary, const SegmentPostings& segment) {
  db.prepare("INSERT INTO segments (map, vocabulary, first_vertex, count, postings) VALUES (?, ?, ?, ?, ?)")
      .bind_all(map, vocabulary, segment.first, segment.count, segment.postings.size())
      .run();
  const SegmentId id{db.connection().last_insert_rowid()};
  const bool with_signatures =
      std::ranges::any_of(segment.postings.signatures, [](VoteSignature signature) { return signature != 0; });
  blobs::PostingBlockWriter writer(segment.first, kBlockBytes, with_signatures);
  for (std::size_t i = 0; i < segment.words.size(); ++i) writer.add(segment.words[i], segment.of(i));
  sqlite::Statement insert = db.prepare("INSERT INTO posting_blocks (segment, first_word, bytes) VALUES (?, ?, ?)");
  for (const auto& block : std::move(writer).finish()) {
    insert.bind_all(id, block.first_word, std::span<const std::uint8_t>(block.bytes)).run();
  }
  return id;
}

}  // namespace mapweld
