// Vocabularies: which there are, taking in new ones, and having the one that a map quantises with at hand.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>

#include "client/contract/page.h"
#include "client/contract/vocabulary.h"
#include "core/vocabulary/vocabulary.h"
#include "schema/maps/vocabulary_store.h"
#include "schema/store.h"
#include "server/services/keep.h"

namespace mapweld::server {

// Thread-safe. Throws ContractError for requests that cannot be met, StoreError.
class VocabularyService {
 public:
  // `store` must outlive this.
  explicit VocabularyService(Store& store) : store_(store) {}

  contract::Page<contract::Vocabulary> list(std::size_t limit, const std::optional<std::string>& cursor) const;
  contract::Vocabulary get(const std::string& name) const;  // no_such_vocabulary

  // Stores a vocabulary file under a name. invalid_name, name_taken, invalid_vocabulary.
  contract::Vocabulary add(const std::string& name, std::span<const std::uint8_t> file,
                           const Keep<contract::Vocabulary>& keep = {});

  // no_such_vocabulary; vocabulary_in_use while a map is made with it. When it was the default, the store's first one
  // is from now on.
  void remove(const std::string& name);

  // The vocabulary of maps that name none. Takes in the file when the store does not have it yet (by its content);
  // its name is then the file's, without extension. Throws std::runtime_error when the file cannot be read or is none.
  void set_default(const std::filesystem::path& file);
  // Without a file: the store's first one. False when it has none.
  bool set_default_from_store();

  // The row that a request names, or the default. no_such_vocabulary.
  VocabularyRow resolve(const Reader& db, const std::optional<std::string>& name) const;

  // Ready to quantise; read from the store at first use. Throws std::out_of_range when there is none of this id.
  std::shared_ptr<const Vocabulary> load(VocabularyId id);

 private:
  VocabularyRow insert(const std::string& name, std::span<const std::uint8_t> file, const Vocabulary& vocabulary,
                       const Keep<contract::Vocabulary>& keep);

  Store& store_;
  mutable std::mutex mutex_;
  std::optional<std::string> default_name_;
  std::map<VocabularyId, std::shared_ptr<const Vocabulary>> loaded_;
  std::mutex loading_;  // one vocabulary is read at a time
};

contract::Vocabulary describe(const VocabularyRow& row);

}  // namespace mapweld::server
