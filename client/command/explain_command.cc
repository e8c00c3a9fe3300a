// mapweld explain WHERE U V
#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/output_file.h"
#include "client/command/terminal.h"
#include "client/drawing/pair_figure.h"

namespace mapweld::command {
namespace {

struct ExplainOptions {
  std::string where;
  bool is_map = false;  // `where` is a map's name, although it is a number
  std::int64_t u = 0;
  std::int64_t v = 0;
  std::string out;
};

// Everything that the server says of a pair.
struct Explained {
  std::string map;  // which numbers the two
  client::Answer<contract::Pair> pair;
  // Who compared the two: a merge, or the plain map that both are of.
  std::optional<contract::Merge> merge;
  std::optional<contract::Map> within;
  contract::Vertex u;
  contract::Vertex v;
};

std::optional<int> min_votes(const Explained& e) {
  return e.merge ? e.merge->parameters.min_votes : e.within->parameters.min_votes;
}
std::optional<int> min_inliers(const Explained& e) {
  return e.merge ? e.merge->parameters.min_inliers : e.within->parameters.min_inliers;
}

std::string minimum(const std::optional<int>& parameter, const std::string& makes) {
  return parameter ? " (" + std::to_string(*parameter) + " make " + makes + ")" : "";
}

std::string image_text(const contract::Vertex& vertex) {
  return printable(vertex.name) + ", vertex " + std::to_string(vertex.member_vertex) + " of " + vertex.map;
}

// The verifier accepted it, and the guard does not.
bool is_withheld(const contract::Pair& pair) { return pair.verdict == "accepted" && pair.confirmed == false; }

std::string verdict_text(const Explained& e) {
  const std::string& verdict = e.pair->verdict;
  if (verdict == "accepted") {
    if (is_withheld(*e.pair)) return "verified, not confirmed: no edge of the map, it counts for nothing";
    return e.pair->confidence ? "an edge of the map: verified and confirmed"
                              : "an edge of the map: verified, and nobody has judged it further";
  }
  if (verdict == "rejected") return "rejected: a candidate that was verified and refused";
  if (verdict == "not_candidate") {
    return std::string("not a candidate: ") + (e.merge ? "the merge" : "an upload") + " never verifies it";
  }
  if (verdict != "pending") return printable(verdict);
  if (!e.merge) {
    return "never verified: others had more votes when the later of the two was uploaded; they do agree";
  }
  return contract::is_at_rest(e.merge->state) ? "pending: a candidate that was not verified before the merge stopped"
                                              : "pending: a candidate that is not verified yet";
}

std::string reason_text(const std::string& reason) {
  if (reason == "too_few_features") return "one of the images has too few features for an edge";
  if (reason == "no_candidate") return "they have too few visual words in common";
  if (reason == "too_few_inliers") return "too few matches agree on one geometry";
  if (reason == "not_significant") return "chance, or one small thing that both show, could explain the agreement";
  if (reason == "inconsistent")
    return "the matches that agree do not keep their neighbours, or nothing around them matches";
  if (reason == "unsupported") {
    return "the two images agree, but so do images of different places that look alike; nothing shows that these two "
           "are one place";
  }
  if (reason == "ambiguous") {
    return "the two images agree, but so do others that put one of them somewhere else, and nothing decides between "
           "the two places";
  }
  return printable(reason);
}

std::string geometry_text(const contract::Pair& pair) {
  if (!pair.kind || *pair.kind == "none") return "none was found";
  std::string text = *pair.kind == "fundamental"  ? "a fundamental matrix"
                     : *pair.kind == "homography" ? "a homography (one plane, or a camera that only turned)"
                                                  : printable(*pair.kind);
  if (pair.log10_false_alarms && *pair.log10_false_alarms < 0) {
    text += "; by chance 1 in 10^" + std::to_string(std::lround(-*pair.log10_false_alarms));
  }
  return text;
}

std::string confidence_text(const Explained& e) {
  std::string text = number_text(*e.pair->confidence);
  const std::optional<double> minimum = e.pair->min_confidence ? e.pair->min_confidence
                                        : e.merge              ? e.merge->parameters.min_confidence
                                                               : std::nullopt;
  return minimum ? text + " (" + number_text(*minimum) + " makes an edge of the map)" : text;
}

// "31, speaks for it (+2.5): matches on things that ..."
std::string evidence_text(const contract::Evidence& evidence) {
  std::string text = number_text(evidence.value);
  if (evidence.weight && *evidence.weight != 0) {
    const bool is_for = *evidence.weight > 0;
    text += std::string(", speaks ") + (is_for ? "for" : "against") + " it (" + (is_for ? "+" : "") +
            number_text(*evidence.weight) + ")";
  }
  if (!evidence.says.empty()) text += ": " + printable(evidence.says);
  return text;
}

std::string in_words(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return printable(name);
}

// Matches and inliers are the verifier's of this moment where the merge has no verdict.
bool has_verdict(const contract::Pair& pair) { return pair.verdict == "accepted" || pair.verdict == "rejected"; }

std::string pair_text(const Explained& e) {
  const std::string text = std::to_string(e.pair->u) + " and " + std::to_string(e.pair->v) + " of " + e.map;
  if (e.merge) return text + ", merge " + std::to_string(e.merge->id);
  return text + (e.pair->map == e.map ? ", both within one map" : ", both of " + e.pair->map);
}

std::string describe(const Explained& e) {
  const contract::Pair& pair = *e.pair;
  const std::string asked_now = has_verdict(pair) ? "" : "; asked for this answer alone";
  std::vector<std::pair<std::string, std::string>> lines = {
      {"pair", pair_text(e)},
      {"first image", image_text(e.u)},
      {"second image", image_text(e.v)},
      {"votes", std::to_string(pair.votes) + minimum(min_votes(e), "a candidate")},
  };
  if (pair.matches) lines.emplace_back("matches", std::to_string(*pair.matches) + " one-to-one" + asked_now);
  if (pair.inliers) {
    lines.emplace_back("inliers", std::to_string(*pair.inliers) + minimum(min_inliers(e), "an edge"));
  }
  if (pair.kind) lines.emplace_back("geometry", geometry_text(pair));
  lines.emplace_back("verdict", verdict_text(e));
  if (pair.reason) lines.emplace_back(is_withheld(pair) ? "why not" : "reason", reason_text(*pair.reason));
  if (pair.confidence) lines.emplace_back("confidence", confidence_text(e));
  for (const contract::Evidence& evidence : pair.evidence.value_or(std::vector<contract::Evidence>{})) {
    lines.emplace_back("  " + in_words(evidence.name), evidence_text(evidence));
  }
  return facts(lines);
}

std::string title_of(const Explained& e) {
  const contract::Pair& pair = *e.pair;
  const bool candidate = pair.verdict != "not_candidate";
  std::string title = candidate ? pair.verdict : "not a candidate";
  if (pair.verdict == "accepted") {
    title = is_withheld(pair) ? "verified, not confirmed: no edge of the map" : "an edge of the map";
    if (pair.confidence) title += ", confidence " + number_text(*pair.confidence);
  }
  title += ": " + count_text(pair.votes, "vote");
  if (pair.matches && pair.inliers) {
    title += ", " + count_text(*pair.inliers, "inlier") + " of " + count_text(*pair.matches, "match", "matches");
  }
  return title;
}

std::string subtitle_of(const Explained& e) {
  const contract::Pair& pair = *e.pair;
  const std::string why = pair.reason ? reason_text(*pair.reason) : geometry_text(pair);
  return (e.merge ? "Merge " + std::to_string(e.merge->id) + ", " : std::string()) + e.map + ", vertices " +
         std::to_string(pair.u) + " and " + std::to_string(pair.v) + ": " + why;
}

drawing::FigureImage figure_image(client::Client& server, const std::string& map, const contract::Vertex& vertex) {
  return {.bytes = server.vertex_image(map, vertex.vertex),
          .width_px = vertex.width_px,
          .height_px = vertex.height_px,
          .caption = image_text(vertex)};
}

// Nothing: `where` is a map.
std::optional<std::int64_t> merge_number(const ExplainOptions& options) {
  std::int64_t number = 0;
  const char* const end = options.where.data() + options.where.size();
  const auto [read, error] = std::from_chars(options.where.data(), end, number);
  if (options.is_map || error != std::errc() || read != end) return std::nullopt;
  return number;
}

// Without the two vertices.
Explained ask(client::Client& server, const ExplainOptions& options) {
  Explained e;
  if (const std::optional<std::int64_t> job = merge_number(options)) {
    e.pair = server.merge_pair(*job, options.u, options.v, true);
    e.merge = *server.merge(*job);
    e.map = e.merge->map;
  } else {
    e.pair = server.map_pair(options.where, options.u, options.v, true);
    e.map = options.where;
  }
  // An older server does not say who compared the two: it knows pairs of the merge itself only.
  if (e.merge && e.pair->map.empty()) return e;
  if (!e.pair->merge) {
    e.merge.reset();
    e.within = *server.map(e.pair->map);
  } else if (!e.merge || e.merge->id != *e.pair->merge) {
    e.merge = *server.merge(*e.pair->merge);
  }
  return e;
}

int explain(const Context& context, const ExplainOptions& options) {
  const bool svg = options.out.ends_with(".svg");
  if (!options.out.empty() && !svg && !options.out.ends_with(".png")) {
    throw UsageError("--out takes a file that ends in .png or .svg, not \"" + options.out + "\".");
  }
  client::Client server = context.connect();
  Explained e = ask(server, options);
  e.u = *server.vertex(e.map, e.pair->u);
  e.v = *server.vertex(e.map, e.pair->v);
  if (!options.out.empty()) {
    OutputFile out(options.out);
    const drawing::PairFigure figure{.title = title_of(e),
                                     .subtitle = subtitle_of(e),
                                     .u = figure_image(server, e.map, e.u),
                                     .v = figure_image(server, e.map, e.v),
                                     .matches = e.pair->inlier_matches.value_or(std::vector<contract::PointMatch>{})};
    out.write(svg ? drawing::pair_svg(figure) : drawing::pair_png(figure));
    out.commit();
  }
  if (context.json) {
    print_json(e.pair.json);
  } else {
    print(describe(e));
  }
  return kDone;
}

}  // namespace

void add_explain_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<ExplainOptions>();
  CLI::App* command = app.add_subcommand("explain", "Say why two images have an edge, or none");
  command->add_option("WHERE", options->where, "A merge's number, or a map's name")
      ->required()
      ->check(CLI::Validator(
          [](const std::string& where) { return where.starts_with('-') ? "neither a number nor a name" : ""; }, ""));
  command->add_option("U", options->u, "A vertex of the merge's map, or of that map")
      ->required()
      ->check(CLI::NonNegativeNumber);
  command->add_option("V", options->v, "Another one")->required()->check(CLI::NonNegativeNumber);
  command->add_flag("--map", options->is_map, "WHERE is a map's name, although it is a number");
  command->add_option("--out", options->out, "Draw both images and the matches that held: a .png or .svg file");
  command->callback([=, &context] { context.action = [=, &context] { return explain(context, *options); }; });
}

}  // namespace mapweld::command
