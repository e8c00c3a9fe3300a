#include "server/services/graph_export.h"

#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "client/contract/text.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/vertex_store.h"
#include "server/services/describe.h"
#include "server/services/map_lookup.h"

namespace mapweld::server {
namespace {

constexpr std::size_t kRowsAtOnce = 300;  // some 64 kB

using contract::Json;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", value);
  return text;
}

std::string escape_xml(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string escape_dot(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

// A document as an attribute of GraphML; nothing where there is none.
template <class Document>
std::string json_data(const char* key, const std::optional<Document>& document) {
  if (!document) return "";
  return std::string("<data key=\"") + key + "\">" + escape_xml(contract::dump(Json(*document))) + "</data>";
}

// Writes one format: `begin`, a call a vertex, a call an edge, `end`.
class Format {
 public:
  virtual ~Format() = default;
  virtual std::string begin(const std::string& map) = 0;
  virtual std::string vertex(const contract::Vertex& vertex, bool first) = 0;
  virtual std::string between() { return ""; }  // vertices and edges
  virtual std::string edge(const contract::Edge& edge, bool first) = 0;
  virtual std::string end() = 0;
  virtual bool wants_vertices() const { return true; }
};

class JsonFormat final : public Format {
  std::string begin(const std::string&) override { return "{\"vertices\":["; }
  std::string vertex(const contract::Vertex& vertex, bool first) override {
    return (first ? "" : ",\n") + contract::to_text(vertex);
  }
  std::string between() override { return "],\n\"edges\":["; }
  std::string edge(const contract::Edge& edge, bool first) override {
    return (first ? "" : ",\n") + contract::to_text(edge);
  }
  std::string end() override { return "]}\n"; }
};

class GraphmlFormat final : public Format {
  std::string begin(const std::string& map) override {
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
           "<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n"
           "<key id=\"name\" for=\"node\" attr.name=\"name\" attr.type=\"string\"/>\n"
           "<key id=\"map\" for=\"node\" attr.name=\"map\" attr.type=\"string\"/>\n"
           "<key id=\"features\" for=\"node\" attr.name=\"features\" attr.type=\"int\"/>\n"
           "<key id=\"camera\" for=\"node\" attr.name=\"camera\" attr.type=\"string\"/>\n"
           "<key id=\"pose\" for=\"node\" attr.name=\"pose\" attr.type=\"string\"/>\n"
           "<key id=\"kind\" for=\"edge\" attr.name=\"kind\" attr.type=\"string\"/>\n"
           "<key id=\"votes\" for=\"edge\" attr.name=\"votes\" attr.type=\"int\"/>\n"
           "<key id=\"weight\" for=\"edge\" attr.name=\"weight\" attr.type=\"int\"/>\n"
           "<key id=\"log10_false_alarms\" for=\"edge\" attr.name=\"log10_false_alarms\" attr.type=\"double\"/>\n"
           "<key id=\"confirmed\" for=\"edge\" attr.name=\"confirmed\" attr.type=\"boolean\"/>\n"
           "<key id=\"confidence\" for=\"edge\" attr.name=\"confidence\" attr.type=\"double\"/>\n"
           "<graph id=\"" +
           escape_xml(map) + "\" edgedefault=\"undirected\">\n";
  }
  std::string vertex(const contract::Vertex& vertex, bool) override {
    return "<node id=\"v" + std::to_string(vertex.vertex) + "\"><data key=\"name\">" + escape_xml(vertex.name) +
           "</data><data key=\"map\">" + escape_xml(vertex.map) + "</data><data key=\"features\">" +
           std::to_string(vertex.features) + "</data>" + json_data("camera", vertex.camera) +
           json_data("pose", vertex.pose) + "</node>\n";
  }
  std::string edge(const contract::Edge& edge, bool) override {
    return "<edge source=\"v" + std::to_string(edge.u) + "\" target=\"v" + std::to_string(edge.v) +
           "\"><data key=\"kind\">" + edge.kind + "</data><data key=\"votes\">" + std::to_string(edge.votes) +
           "</data><data key=\"weight\">" + std::to_string(edge.inliers) + "</data><data key=\"log10_false_alarms\">" +
           number(edge.log10_false_alarms) + "</data><data key=\"confirmed\">" + (edge.confirmed ? "true" : "false") +
           "</data>" + (edge.confidence ? "<data key=\"confidence\">" + number(*edge.confidence) + "</data>" : "") +
           "</edge>\n";
  }
  std::string end() override { return "</graph>\n</graphml>\n"; }
};

class DotFormat final : public Format {
  std::string begin(const std::string& map) override { return "graph \"" + escape_dot(map) + "\" {\n"; }
  std::string vertex(const contract::Vertex& vertex, bool) override {
    return "  " + std::to_string(vertex.vertex) + " [label=\"" + escape_dot(vertex.name) + "\", map=\"" +
           escape_dot(vertex.map) + "\"];\n";
  }
  std::string edge(const contract::Edge& edge, bool) override {
    return "  " + std::to_string(edge.u) + " -- " + std::to_string(edge.v) +
           " [weight=" + std::to_string(edge.inliers) + (edge.kind == "inter" ? ", color=red" : "") +
           (edge.confirmed ? "" : ", style=dashed") +
           (edge.confidence ? ", confidence=" + number(*edge.confidence) : "") + "];\n";
  }
  std::string end() override { return "}\n"; }
};

class CsvFormat final : public Format {
  std::string begin(const std::string&) override {
    return "u,v,kind,votes,inliers,log10_false_alarms,confirmed,merge,confidence\r\n";
  }
  std::string vertex(const contract::Vertex&, bool) override { return ""; }
  std::string edge(const contract::Edge& edge, bool) override {
    return std::to_string(edge.u) + "," + std::to_string(edge.v) + "," + edge.kind + "," + std::to_string(edge.votes) +
           "," + std::to_string(edge.inliers) + "," + number(edge.log10_false_alarms) + "," +
           (edge.confirmed ? "true" : "false") + "," + (edge.merge ? std::to_string(*edge.merge) : "") + "," +
           (edge.confidence ? number(*edge.confidence) : "") + "\r\n";
  }
  std::string end() override { return ""; }
  bool wants_vertices() const override { return false; }
};

std::unique_ptr<Format> make_format(GraphFormat format) {
  switch (format) {
    case GraphFormat::kJson:
      return std::make_unique<JsonFormat>();
    case GraphFormat::kGraphml:
      return std::make_unique<GraphmlFormat>();
    case GraphFormat::kDot:
      return std::make_unique<DotFormat>();
    case GraphFormat::kCsv:
      break;
  }
  return std::make_unique<CsvFormat>();
}

// All that an export reads, of one moment.
struct Source {
  ReadTransaction db;
  MapRow map;
  MapLayout layout;

  Source(Store& store, const std::string& name)
      : db(store.read()), map(require_map(db, name)), layout(load_layout(db, map.id)) {}
};

// Writes the graph a page of rows at a time.
class Export {
 public:
  Export(Store& store, const std::string& map, GraphFormat format)
      : source_(store, map), names_(source_.db), format_(make_format(format)) {}

  bool next(std::string& piece) {
    switch (stage_) {
      case Stage::kBegin:
        piece += format_->begin(source_.map.name);
        stage_ = format_->wants_vertices() ? Stage::kVertices : Stage::kBetween;
        return true;
      case Stage::kVertices:
        if (!add_vertices(piece)) stage_ = Stage::kBetween;
        return true;
      case Stage::kBetween:
        piece += format_->between();
        stage_ = Stage::kEdges;
        return true;
      case Stage::kEdges:
        if (add_edges(piece)) return true;
        piece += format_->end();
    }
    return false;
  }

 private:
  enum class Stage : std::uint8_t { kBegin, kVertices, kBetween, kEdges };

  // False: there are no more; likewise of edges.
  bool add_vertices(std::string& piece) {
    const std::vector<VertexRow> rows = list_vertices(source_.db, source_.layout, kRowsAtOnce, last_vertex_);
    if (rows.empty()) return false;
    const std::uint32_t first = to_index(rows.front().vertex);
    const std::vector<std::int64_t> degrees =
        count_confirmed_edges_at(source_.db, source_.layout, VertexId{first}, to_index(rows.back().vertex) - first + 1);
    for (const VertexRow& row : rows) {
      const auto vertex = describe_vertex(row, names_(row.image.map), degrees[to_index(row.vertex) - first]);
      piece += format_->vertex(vertex, !last_vertex_);
      last_vertex_ = row.vertex;
    }
    return rows.size() == kRowsAtOnce;
  }

  bool add_edges(std::string& piece) {
    const EdgePage page = list_edges(source_.db, source_.layout, {}, kRowsAtOnce, next_edge_);
    for (const EdgeRow& row : page.edges) {
      piece += format_->edge(describe_edge(row), first_edge_);
      first_edge_ = false;
    }
    if (page.next) next_edge_ = *page.next;
    return page.next.has_value();
  }

  const Source source_;
  MapNames names_;
  const std::unique_ptr<Format> format_;
  Stage stage_ = Stage::kBegin;
  std::optional<VertexId> last_vertex_;
  EdgeCursor next_edge_;
  bool first_edge_ = true;
};

}  // namespace

std::optional<GraphFormat> parse_graph_format(std::string_view word) {
  if (word == "json") return GraphFormat::kJson;
  if (word == "graphml") return GraphFormat::kGraphml;
  if (word == "dot") return GraphFormat::kDot;
  if (word == "csv") return GraphFormat::kCsv;
  return std::nullopt;
}

std::string_view media_type(GraphFormat format) {
  switch (format) {
    case GraphFormat::kJson:
      return "application/json";
    case GraphFormat::kGraphml:
      return "application/graphml+xml";
    case GraphFormat::kDot:
      return "text/vnd.graphviz";
    case GraphFormat::kCsv:
      break;
  }
  return "text/csv";
}

std::function<bool(std::string& piece)> export_graph(Store& store, const std::string& map, GraphFormat format) {
  const auto whole = std::make_shared<Export>(store, map, format);
  return [whole](std::string& piece) { return whole->next(piece); };
}

}  // namespace mapweld::server
