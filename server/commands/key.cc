#include "server/commands/key.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/contract/names.h"
#include "schema/engine/store_error.h"
#include "schema/key_store.h"
#include "server/access/key.h"
#include "server/access/role.h"
#include "server/http/wire/text.h"
#include "server/services/hashing.h"
#include "server/services/times.h"

namespace mapweld::server {
namespace {

constexpr int kRefused = 1;
constexpr int kUnreadable = 2;

struct KeyCommand {
  std::string data;
  std::string name;
  std::string role;
  std::string maps = "*";
  std::string max_images;  // as typed; empty: not given
  std::string max_bytes;
  std::string max_queued_merges;
};

class Refused : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

constexpr const char* kNoBound = "none";

// What was typed of a bound, in the place of what there was.
std::optional<std::int64_t> bound(const std::string& typed, std::optional<std::int64_t> before = {}) {
  if (typed.empty()) return before;
  if (typed == kNoBound) return std::nullopt;
  std::uint64_t number = 0;
  if (!parse_whole(typed, number, 10) || number > INT64_MAX) {
    throw Refused("a bound is a whole number, or \"none\"; \"" + typed + "\" is not");
  }
  return static_cast<std::int64_t>(number);
}

std::string shown(const std::optional<std::int64_t>& bound) { return bound ? std::to_string(*bound) : "-"; }

void create(const KeyCommand& command) {
  if (!contract::is_slug(command.name)) {
    throw Refused("a key is named by 1 to 64 letters, digits, dots, dashes and underscores; \"" + command.name +
                  "\" is not");
  }
  if (command.role == to_string(Role::kAdmin) && command.maps != "*") {
    throw Refused("admin is for the whole server, --maps for some of its maps: give another role, or no --maps");
  }
  const std::string key = make_key();
  KeyRow row;
  row.name = command.name;
  row.role = command.role;
  row.maps = command.maps;
  row.sha256 = sha256({reinterpret_cast<const std::uint8_t*>(key.data()), key.size()});
  row.created_at = now();
  row.quota = {bound(command.max_images), bound(command.max_bytes), bound(command.max_queued_merges)};
  if (!KeyStore(command.data).add(row)) {
    throw Refused("there is a key named \"" + command.name + "\" already: choose another name, or revoke it first");
  }
  std::cout << key << std::endl;
  std::cerr << "This is the key \"" << command.name << "\", role " << command.role << ", maps " << command.maps
            << ". It is shown this once and stored nowhere; give it to mapweld as MAPWELD_KEY." << std::endl;
}

void list(const KeyCommand& command) {
  std::vector<std::array<std::string, 8>> table = {
      {"NAME", "ROLE", "MAPS", "CREATED", "REVOKED", "MAX-IMAGES", "MAX-BYTES", "MAX-QUEUED-MERGES"}};
  for (const KeyRow& key : KeyStore(command.data).list()) {
    table.push_back({key.name, key.role, key.maps, to_rfc3339(key.created_at),
                     key.revoked_at ? to_rfc3339(*key.revoked_at) : "-", shown(key.quota.images),
                     shown(key.quota.bytes), shown(key.quota.queued_merges)});
  }
  std::array<std::size_t, 8> widths{};
  for (const auto& row : table) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const auto& row : table) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += i + 1 < row.size() ? row[i] + std::string(widths[i] - row[i].size() + 2, ' ') : row[i];
    }
    std::cout << line << "\n";
  }
}

void change(const KeyCommand& command) {
  KeyStore keys(command.data);
  const std::vector<KeyRow> rows = keys.list();
  const auto key =
      std::ranges::find_if(rows, [&](const KeyRow& row) { return row.name == command.name && !row.revoked_at; });
  if (key == rows.end()) throw Refused("no key named \"" + command.name + "\" is in force");
  const KeyQuota quota{bound(command.max_images, key->quota.images), bound(command.max_bytes, key->quota.bytes),
                       bound(command.max_queued_merges, key->quota.queued_merges)};
  if (quota == key->quota) throw Refused("say what is to change: --max-images, --max-bytes or --max-queued-merges");
  keys.set_quota(command.name, quota);
  std::cerr << "The key \"" << command.name << "\" may have, on a running server too: images " << shown(quota.images)
            << ", bytes of them " << shown(quota.bytes) << ", merges that wait or run " << shown(quota.queued_merges)
            << "." << std::endl;
}

void revoke(const KeyCommand& command) {
  if (!KeyStore(command.data).revoke(command.name, now())) {
    throw Refused("no key named \"" + command.name + "\" is in force");
  }
  std::cerr << "The key \"" << command.name << "\" opens nothing any more, on a running server too." << std::endl;
}

std::function<void()> guarded(const std::shared_ptr<KeyCommand>& command, void (*run)(const KeyCommand&)) {
  return [command, run] {
    try {
      run(*command);
    } catch (const Refused& error) {
      std::cerr << "mapweld-server: " << error.what() << std::endl;
      throw CLI::RuntimeError(kRefused);
    } catch (const std::exception& error) {
      std::cerr << "mapweld-server: " << error.what() << std::endl;
      throw CLI::RuntimeError(kUnreadable);
    }
  };
}

}  // namespace

void add_key_command(CLI::App& app) {
  const auto command = std::make_shared<KeyCommand>();
  CLI::App* key = app.add_subcommand("key", "Makes, lists and revokes the keys of a server; also while it runs");
  key->require_subcommand(1);
  const auto add = [&](const char* name, const char* what, void (*run)(const KeyCommand&)) {
    CLI::App* sub = key->add_subcommand(name, what);
    sub->add_option("--data", command->data, "Data folder; create makes it when missing")
        ->envname("MAPWELD_DATA")
        ->required();
    sub->callback(guarded(command, run));
    return sub;
  };
  CLI::App* made = add("create", "Makes a key and prints it, once", create);
  made->add_option("NAME", command->name, "What the key is called in lists and logs")->required();
  std::vector<std::string> roles;
  for (std::size_t i = 1; i < kRoleWords.size(); ++i) roles.emplace_back(kRoleWords[i]);
  made->add_option("--role", command->role, "What it may do; each role with all before it")
      ->required()
      ->check(CLI::IsMember(roles));
  made->add_option("--maps", command->maps, "Pattern of the maps that it may use, like 'lab-*'")->capture_default_str();
  CLI::App* changed = add("change", "Gives a key another quota; what it has stays", change);
  changed->add_option("NAME", command->name)->required();
  for (CLI::App* sub : {made, changed}) {
    sub->add_option("--max-images", command->max_images, "Most images that it may have in maps; \"none\": no bound");
    sub->add_option("--max-bytes", command->max_bytes, "Most bytes that are kept of them");
    sub->add_option("--max-queued-merges", command->max_queued_merges,
                    "Most of its merges that may wait or run at once");
  }
  add("list", "Lists keys, those that were revoked too", list);
  add("revoke", "Ends a key, at once", revoke)->add_option("NAME", command->name)->required();
}

}  // namespace mapweld::server
