#include "client/command/watch.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <thread>
#include <vector>

#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/terminal.h"

namespace mapweld::command {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kPollInterval = std::chrono::milliseconds(200);
constexpr auto kLineInterval = std::chrono::milliseconds(500);
constexpr auto kOutage = std::chrono::seconds(30);

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

// Turns Ctrl-C into a flag while it lives.
class InterruptFlag {
 public:
  InterruptFlag() {
    interrupted = false;
    previous_ = std::signal(SIGINT, [](int) { interrupted = true; });
  }
  ~InterruptFlag() { std::signal(SIGINT, previous_); }
  InterruptFlag(const InterruptFlag&) = delete;
  InterruptFlag& operator=(const InterruptFlag&) = delete;

 private:
  void (*previous_)(int);
};

double share(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

std::string joined_text(const contract::Merge& merge) {
  std::string text;
  for (const contract::Joined& member : merge.joined) {
    text += (text.empty() ? "" : " + ") + std::to_string(member.vertices);
  }
  return text;
}

std::string budget_text(const contract::Budget& budget) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (budget.seconds) add(duration_text(*budget.seconds));
  if (budget.verifications) add(count_text(*budget.verifications, "verification"));
  if (budget.edges) add(count_text(*budget.edges, "edge"));
  if (budget.fraction_of_maximum) add(number_text(100 * *budget.fraction_of_maximum) + " % of the maximum");
  return text;
}

// Nothing while none was taken back.
std::string revoked_text(const contract::Merge& merge) {
  return merge.revoked > 0 ? ", " + count_text(merge.revoked, "confirmation") + " revoked" : "";
}

std::vector<std::string> panel_lines(const contract::Merge& merge, const std::vector<double>& connectivity) {
  std::vector<std::string> lines;
  lines.push_back("Merge " + std::to_string(merge.id) + "  " + members_text(merge) + "  " + merge.method + "  " +
                  merge.state + "  " + merge.phase);
  if (merge.words.total > 0) {
    lines.push_back("  words         " + bar(share(merge.words.done, merge.words.total), 24) + " " +
                    std::to_string(merge.words.done) + " of " + std::to_string(merge.words.total));
  }
  lines.push_back("  candidates    " + bar(share(merge.candidates.verified, merge.candidates.known), 24) + " " +
                  std::to_string(merge.candidates.verified) + " of " + std::to_string(merge.candidates.known) +
                  " verified, " + std::to_string(merge.candidates.accepted) + " passed");
  lines.push_back("  edges         " + edge_counts_text(merge.edge_counts) + revoked_text(merge) +
                  "; the confirmed ones join " + joined_text(merge) + " vertices");
  lines.push_back("  components    " + std::to_string(merge.components) + ", the largest of " +
                  count_text(merge.largest_component.vertices, "vertex", "vertices"));
  lines.push_back("  connectivity  " + number_text(merge.largest_component.algebraic_connectivity) + " (largest)  " +
                  sparkline(connectivity, 32));
  std::string time = "  time          " + duration_text(merge.elapsed_s);
  if (merge.budget.seconds || merge.budget.verifications || merge.budget.edges || merge.budget.fraction_of_maximum) {
    time += ", budget " + budget_text(merge.budget);
  }
  if (merge.eta_s && merge.state == "running") time += ", about " + duration_text(*merge.eta_s) + " to complete";
  lines.push_back(time);
  return lines;
}

std::string progress_line(const contract::Merge& merge) {
  char text[320];
  std::snprintf(text, sizeof text,
                "%8.2f s  %-12s  edges %lld confirmed, %lld verified%s  connectivity %-9s  components %-4lld  "
                "candidates %lld of %lld verified",
                merge.elapsed_s, merge.phase.c_str(), static_cast<long long>(merge.edge_counts.confirmed),
                static_cast<long long>(merge.edge_counts.verified), revoked_text(merge).c_str(),
                number_text(merge.largest_component.algebraic_connectivity).c_str(),
                static_cast<long long>(merge.components), static_cast<long long>(merge.candidates.verified),
                static_cast<long long>(merge.candidates.known));
  return text;
}

// The merge as it is now. Waits for a server that is being restarted; nothing when Ctrl-C came first.
std::optional<client::Answer<contract::Merge>> ask(client::Client& server, std::int64_t id, bool answered_before) {
  const auto give_up = Clock::now() + kOutage;
  while (!interrupted) {
    try {
      return server.merge(id);
    } catch (const client::ConnectionError&) {
      if (!answered_before || Clock::now() >= give_up) throw;
    } catch (const client::ServerProblem& error) {
      if ((error.status() != 503 && error.status() != 429) || Clock::now() >= give_up) throw;
    }
    std::this_thread::sleep_for(kPollInterval);
  }
  return std::nullopt;
}

// Shows people what has become of the merge since the last call.
class Display {
 public:
  explicit Display(client::Client& server) : server_(server) {}

  void show(const contract::Merge& merge, bool last) {
    if (terminal_) {
      remember(merge, last);
      panel_.draw(panel_lines(merge, history_));
      return;
    }
    const bool turned = !shown_ || merge.phase != shown_->phase || merge.state != shown_->state;
    const bool moved = !shown_ || merge.step != shown_->step;
    if (turned || (moved && last) || (moved && Clock::now() - shown_at_ >= kLineInterval)) {
      print(progress_line(merge) + "\n");
      shown_ = merge;
      shown_at_ = Clock::now();
    }
  }

 private:
  // The connectivity so far: the curve when the watching begins and when it ends, what is polled in between.
  void remember(const contract::Merge& merge, bool last) {
    if (history_.empty() || last) {
      history_.clear();
      for (const contract::CurvePoint& point : *server_.curve(merge.id)) {
        history_.push_back(point.largest_component.algebraic_connectivity);
      }
    }
    history_.push_back(merge.largest_component.algebraic_connectivity);
  }

  client::Client& server_;
  bool terminal_ = is_terminal(stdout);
  Panel panel_{stdout};
  std::vector<double> history_;
  std::optional<contract::Merge> shown_;
  Clock::time_point shown_at_;
};

}  // namespace

std::string members_text(const contract::Merge& merge) {
  std::string text;
  for (const std::string& map : merge.maps) text += (text.empty() ? "" : " + ") + map;
  return text + " -> " + merge.map;
}

std::string outcome_text(const contract::Merge& merge) {
  std::string text = "Merge " + std::to_string(merge.id) + " ";
  if (merge.state == "completed") {
    text += "is complete";
  } else if (merge.state == "budget_exhausted") {
    text += "has used up its budget";
    if (merge.stop_reason) text += " (" + *merge.stop_reason + ")";
  } else if (merge.state == "failed") {
    text += "failed" + (merge.error ? ": " + printable(*merge.error) : std::string());
  } else {
    text += "is " + merge.state;
  }
  text += " after " + duration_text(merge.elapsed_s) + ": between the maps are " +
          count_text(merge.edge_counts.confirmed, "confirmed edge") +
          (merge.edge_counts.confirmed == merge.edge_counts.verified
               ? ", all that were verified.\n"
               : " (of " + std::to_string(merge.edge_counts.verified) + " verified" + revoked_text(merge) + ").\n") +
          count_text(merge.components, "component") + ", the largest of " +
          count_text(merge.largest_component.vertices, "vertex", "vertices") + " with algebraic connectivity " +
          number_text(merge.largest_component.algebraic_connectivity) + ".";
  return text;
}

int watch(client::Client& server, std::int64_t id, WatchStyle style) {
  const InterruptFlag flag;
  Display display(server);
  std::string printed;
  bool answered = false;
  for (;;) {
    const auto merge = ask(server, id, answered);
    if (!merge || interrupted) {
      std::fprintf(stderr, "\nThe merge goes on. To stop it: mapweld merges pause %lld\n", static_cast<long long>(id));
      return kInterrupted;
    }
    answered = true;
    const contract::Merge& now = merge->value;
    const bool last = contract::is_at_rest(now.state);
    if (style == WatchStyle::kPeople) display.show(now, last);
    if (style == WatchStyle::kJson) {
      std::string line = contract::dump(merge->json);
      if (line != printed) print(line + "\n");
      printed = std::move(line);
    }
    if (last) {
      if (style == WatchStyle::kPeople) print(outcome_text(now) + "\n");
      return now.state == "failed" || now.state == "cancelled" ? kMergeNotDone : kDone;
    }
    std::this_thread::sleep_for(kPollInterval);
  }
}

}  // namespace mapweld::command
