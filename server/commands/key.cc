#include "server/commands/key.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/contract/names.h"
#include "schema/engine/store_error.h"
#include "schema/key_store.h"
#include "server/access/key.h"
#include "server/access/role.h"
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
};

class Refused : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

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
  if (!KeyStore(command.data).add(row)) {
    throw Refused("there is a key named \"" + command.name + "\" already: choose another name, or revoke it first");
  }
  std::cout << key << std::endl;
  std::cerr << "This is the key \"" << command.name << "\", role " << command.role << ", maps " << command.maps
            << ". It is shown this once and stored nowhere; give it to mapweld as MAPWELD_KEY." << std::endl;
}

void list(const KeyCommand& command) {
  std::vector<std::array<std::string, 5>> table = {{"NAME", "ROLE", "MAPS", "CREATED", "REVOKED"}};
  for (const KeyRow& key : KeyStore(command.data).list()) {
    table.push_back(
        {key.name, key.role, key.maps, to_rfc3339(key.created_at), key.revoked_at ? to_rfc3339(*key.revoked_at) : "-"});
  }
  std::array<std::size_t, 5> widths{};
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
  add("list", "Lists keys, those that were revoked too", list);
  add("revoke", "Ends a key, at once", revoke)->add_option("NAME", command->name)->required();
}

}  // namespace mapweld::server
