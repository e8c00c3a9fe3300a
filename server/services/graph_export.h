// The whole graph of a map as a stream of text, in the formats that graph tools read.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "schema/store.h"

namespace mapweld::server {

enum class GraphFormat : std::uint8_t {
  kJson,     // {"vertices":[...],"edges":[...]}, as the lists give them
  kGraphml,  // <http://graphml.graphdrawing.org>
  kDot,      // Graphviz
  kCsv,      // the edges, one a line, under a line of names (RFC 4180)
};
std::optional<GraphFormat> parse_graph_format(std::string_view word);  // "json", "graphml", "dot", "csv"
std::string_view media_type(GraphFormat format);

// Prepares the export of a map as it is now. Each call of what it returns appends the next piece, some tens of kB;
// false: it was the last. Any thread, one call at a time. Throws ContractError no_such_map.
std::function<bool(std::string& piece)> export_graph(Store& store, const std::string& map, GraphFormat format);

}  // namespace mapweld::server
