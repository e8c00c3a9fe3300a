#include "server/services/vocabulary_service.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

#include "client/contract/names.h"
#include "client/contract/problem.h"
#include "core/errors.h"
#include "core/vocabulary/foreign_vocabulary.h"
#include "server/services/hashing.h"
#include "server/services/paging.h"
#include "server/services/times.h"

namespace mapweld::server {

using contract::ContractError;

contract::Vocabulary describe(const VocabularyRow& row) {
  return {.name = row.name,
          .words = row.words,
          .dimension = row.dimension,
          .descriptor = row.descriptor,
          .sha256 = to_hex(row.sha256),
          .index = row.engine,
          .created_at = to_rfc3339(row.created_at)};
}

contract::Page<contract::Vocabulary> VocabularyService::list(std::size_t limit,
                                                             const std::optional<std::string>& cursor) const {
  const auto rows = list_vocabularies(store_.read(), limit + 1, after<VocabularyId>(cursor));
  return make_page<contract::Page<contract::Vocabulary>>(
      rows, limit, [](const VocabularyRow& row) { return describe(row); },
      [](const VocabularyRow& row) { return to_index(row.id); });
}

contract::Vocabulary VocabularyService::get(const std::string& name) const {
  return describe(resolve(store_.read(), name));
}

contract::Vocabulary VocabularyService::add(const std::string& name, std::span<const std::uint8_t> file,
                                            const Keep<contract::Vocabulary>& keep) {
  contract::check_slug(name, "The vocabulary's name");
  std::shared_ptr<const Vocabulary> vocabulary;
  try {
    vocabulary = deserialize_foreign(file);
  } catch (const FormatError& error) {
    throw ContractError("invalid_vocabulary", error.what());
  }
  const VocabularyRow row = insert(name, file, *vocabulary, keep);
  const std::lock_guard lock(mutex_);
  loaded_.emplace(row.id, std::move(vocabulary));
  if (!default_name_) default_name_ = name;
  return describe(row);
}

VocabularyRow VocabularyService::insert(const std::string& name, std::span<const std::uint8_t> file,
                                        const Vocabulary& vocabulary, const Keep<contract::Vocabulary>& keep) {
  VocabularyRow row;
  row.name = name;
  row.words = vocabulary.words();
  row.descriptor = "sift";
  row.engine = vocabulary.index().engine();
  row.sha256 = sha256(file);
  row.created_at = now();
  row.file_bytes = file.size();
  WriteTransaction db = store_.write();
  if (find_vocabulary(db, name)) {
    throw ContractError("name_taken", "There is a vocabulary named \"" + name + "\" already.");
  }
  row.id = insert_vocabulary(db, row, file);
  if (keep) keep(db, describe(row));
  db.commit();
  return row;
}

void VocabularyService::remove(const std::string& name) {
  {
    WriteTransaction db = store_.write(Store::Purpose::kDelete);
    const VocabularyRow row = resolve(db, name);
    if (!delete_vocabulary(db, row.id)) {
      throw ContractError("vocabulary_in_use", "There are maps made with \"" + name + "\"; delete them first.");
    }
    db.commit();
    const std::lock_guard lock(mutex_);
    loaded_.erase(row.id);
    if (default_name_ != name) return;
    default_name_.reset();
  }
  set_default_from_store();
}

void VocabularyService::set_default(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<std::uint8_t> file((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (!in.is_open() || in.bad()) throw std::runtime_error("cannot read the vocabulary " + path.string());
  const Sha256 hash = sha256(file);
  const std::vector<VocabularyRow> rows = list_vocabularies(store_.read(), 1000);
  const auto known = std::ranges::find(rows, hash, &VocabularyRow::sha256);
  std::string name = path.stem().string();
  if (known != rows.end()) {
    name = known->name;
  } else {
    try {
      add(name, file);
    } catch (const ContractError& error) {
      throw std::runtime_error("cannot take in the vocabulary " + path.string() + ": " + error.detail());
    }
  }
  const std::lock_guard lock(mutex_);
  default_name_ = name;
}

bool VocabularyService::set_default_from_store() {
  const std::vector<VocabularyRow> rows = list_vocabularies(store_.read(), 1);
  if (rows.empty()) return false;
  const std::lock_guard lock(mutex_);
  default_name_ = rows.front().name;
  return true;
}

VocabularyRow VocabularyService::resolve(const Reader& db, const std::optional<std::string>& name) const {
  std::optional<std::string> wanted = name;
  if (!wanted) {
    const std::lock_guard lock(mutex_);
    wanted = default_name_;
  }
  if (!wanted) throw ContractError("no_such_vocabulary", "The server has no vocabulary; upload one first.");
  const std::optional<VocabularyRow> row = find_vocabulary(db, *wanted);
  if (!row) throw ContractError("no_such_vocabulary", "There is no vocabulary named \"" + *wanted + "\".");
  return *row;
}

std::shared_ptr<const Vocabulary> VocabularyService::load(VocabularyId id) {
  const auto find = [&]() -> std::shared_ptr<const Vocabulary> {
    const std::lock_guard lock(mutex_);
    const auto found = loaded_.find(id);
    return found == loaded_.end() ? nullptr : found->second;
  };
  if (auto vocabulary = find()) return vocabulary;
  const std::lock_guard loading(loading_);
  if (auto vocabulary = find()) return vocabulary;
  auto vocabulary = Vocabulary::deserialize(load_vocabulary_file(store_.read(), id));
  const std::lock_guard lock(mutex_);
  return loaded_.emplace(id, std::move(vocabulary)).first->second;
}

}  // namespace mapweld::server
