#include "server/services/upload_session.h"

#include <stdexcept>
#include <utility>

#include "client/contract/json.h"
#include "client/contract/names.h"
#include "client/contract/problem.h"
#include "core/geometry/epipolar_verifier.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/mask_store.h"
#include "server/maps/map_snapshot.h"
#include "server/maps/stored_map.h"
#include "server/services/hashing.h"
#include "server/services/map_lookup.h"
#include "server/services/mask_service.h"
#include "server/services/timed_verifier.h"
#include "server/services/times.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

[[noreturn]] void throw_name_taken(const std::string& name) {
  throw ContractError("name_taken", "The map has an image named \"" + name + "\" with other bytes.");
}

bool is_ready(const auto& future) { return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }

}  // namespace

void UploadContext::refuse_when_stopping() const {
  if (std::chrono::steady_clock::now().time_since_epoch() < deadline.load()) return;
  throw ContractError("shutting_down", "The server is shutting down; upload the image again when it is back.");
}

UploadSession::UploadSession(UploadContext& context, const std::string& map_name,
                             const std::optional<std::string>& map_uuid, const Keep<StoredUpload>& keep,
                             const Caller* caller)
    : context_(context), keep_(keep), caller_(caller) {
  std::optional<std::vector<std::uint8_t>> mask_png;
  {
    const ReadTransaction db = context.store.read();
    map_ = require_map(db, map_name);
    mask_png = load_mask_bytes(db, map_.id);
  }
  if (map_.kind == MapKind::kMerged) {
    throw ContractError("map_is_merged", "\"" + map_name + "\" is a merged map; upload into one of its members.");
  }
  if (map_uuid && *map_uuid != map_.uuid) {
    throw ContractError("wrong_map", "The map \"" + map_name + "\" has another uuid: it is not the one you mean.");
  }
  settings_ = settings_of(map_);
  mask_ = mask_in(mask_png, context.decoder);
  vocabulary_ = context.vocabularies.load(map_.vocabulary);
  verifier_ = make_verifier({.min_inliers = settings_.parameters.min_inliers});
  open_map();
}

void UploadSession::open_map() {
  try {
    loaded_ = context_.cache.open(map_, settings_.parameters.max_features);
  } catch (const std::out_of_range&) {
    throw_deleted();
  }
}

std::vector<BatchOutcome> UploadSession::run(const std::vector<ImageUpload>& images) {
  std::vector<BatchOutcome> outcomes(images.size());
  WorkerPool::Lane lane(context_.workers);
  std::vector<std::future<Prepared>> prepared;
  for (const ImageUpload& image : images) {
    prepared.push_back(lane.submit([this, &image] { return prepare(image); }));
  }
  for (std::size_t i = 0; i < images.size();) {
    // The images that are ready, so that many share a transaction and none waits for one that is not.
    std::vector<Pending> group;
    do {
      if (auto pending = receive(images[i], prepared[i], outcomes[i])) {
        pending->place = i;
        group.push_back(std::move(*pending));
      }
      ++i;
    } while (i < images.size() && static_cast<int>(group.size()) < max_group() && is_ready(prepared[i]));
    if (group.empty()) continue;
    if (const std::exception_ptr failure = store(group)) {
      for (; i < images.size(); ++i) outcomes[i] = failure;
    }
  }
  return outcomes;
}

// An image is localized among those before it: where the map is not in memory, they must be stored first.
int UploadSession::max_group() const { return loaded_ ? context_.max_group : 1; }

UploadSession::Prepared UploadSession::prepare(const ImageUpload& upload) const {
  context_.refuse_when_stopping();
  if (!upload.name.empty()) contract::check_image_name(upload.name);
  if (upload.bytes.empty()) throw ContractError("empty_body", "The image has no bytes.");
  const Stopwatch watch;
  Prepared prepared;
  prepared.hash = sha256(upload.bytes);
  if (!upload.name.empty()) prepared.repeated = find_repeated(context_.store.read(), upload.name, prepared.hash);
  if (prepared.repeated) {
    prepared.repeated->upload.took_ms = shown_ms(watch.elapsed_s());
  } else if (!find_image(context_.store.read(), map_.id, prepared.hash)) {
    prepared.image = analyzed(upload);
  }
  return prepared;
}

AnalyzedImage UploadSession::analyzed(const ImageUpload& upload) const {
  return analyze(upload.bytes, *vocabulary_, settings_.parameters.max_features, mask_, context_.decoder,
                 context_.metrics);
}

std::optional<UploadSession::Pending> UploadSession::receive(const ImageUpload& upload, std::future<Prepared>& future,
                                                             BatchOutcome& outcome) const {
  try {
    Prepared prepared = future.get();
    if (prepared.repeated) {
      outcome = std::move(*prepared.repeated);
      return std::nullopt;
    }
    context_.refuse_when_stopping();
    Pending pending;
    pending.upload = &upload;
    pending.prepared = std::move(prepared);
    pending.outcome = &outcome;
    return pending;
  } catch (...) {
    outcome = std::current_exception();
    return std::nullopt;
  }
}

std::optional<UploadOutcome> UploadSession::find_repeated(const Reader& db, const std::string& name,
                                                          const Sha256& hash) const {
  const std::optional<ImageRow> stored = find_image(db, map_.id, name);
  if (!stored) return std::nullopt;
  if (stored->deleted_at) {
    throw ContractError("name_taken", "The image named \"" + name +
                                          "\" was deleted; it can be restored, and its name is "
                                          "free when it is purged.");
  }
  if (stored->sha256 != hash) throw_name_taken(name);
  return first_outcome(db, *stored);
}

std::exception_ptr UploadSession::store(std::vector<Pending>& group) {
  const auto quota_turn = context_.quota_turns.take(caller_);  // first: who waits for it holds up no map
  const auto turn = context_.cache.writer_turn(map_.id);
  try {
    open_map();  // as it is now: the cache forgets a map of which images are deleted
    decide_all(group);
    write_all(group);
    if (loaded_) loaded_->commit();
    return nullptr;
  } catch (...) {
    if (loaded_) loaded_->rollback();
    for (Pending& pending : group) {
      if (!pending.settled) *pending.outcome = std::current_exception();
    }
    return std::current_exception();
  }
}

void UploadSession::decide_all(std::vector<Pending>& group) {
  const ReadTransaction db = context_.store.read();
  const std::optional<MapRow> present = find_map(db, map_.id);
  if (!present) throw_deleted();
  std::uint32_t vertices = present->vertices;
  std::uint64_t ignored = present->ignored;
  NamesOfGroup names;
  ContentsOfGroup contents;
  Room room(db, caller_);
  for (Pending& pending : group) {
    if (settle_by_name(db, pending, names)) continue;
    const bool is_known = decide_by_content(db, pending, contents);
    if (refuse_without_room(pending, room)) continue;
    if (!is_known) decide_one(pending, vertices);
    contents.emplace(pending.prepared.hash, &pending);
    const bool inserts = pending.decision.outcome == MappingDecision::Outcome::kInserted;
    pending.name = pending.upload->name;
    if (pending.name.empty()) {
      pending.name = free_name(db, names, inserts ? std::to_string(vertices) : "ignored-" + std::to_string(ignored));
    }
    names.emplace(pending.name, &pending);
    if (inserts) {
      ++vertices;
    } else {
      ++ignored;
    }
  }
}

// An image of this name may have been stored since it was prepared, or stand earlier in the group.
bool UploadSession::settle_by_name(const Reader& db, Pending& pending, const NamesOfGroup& names) const {
  const std::string& name = pending.upload->name;
  if (name.empty()) return false;
  try {
    if (auto repeated = find_repeated(db, name, pending.prepared.hash)) {
      *pending.outcome = std::move(*repeated);
      return pending.settled = true;
    }
    const auto earlier = names.find(name);
    if (earlier == names.end()) return false;
    if (earlier->second->prepared.hash != pending.prepared.hash) throw_name_taken(name);
    pending.same_as = earlier->second;
    return true;
  } catch (const ContractError&) {
    *pending.outcome = std::current_exception();
    return pending.settled = true;
  }
}

bool UploadSession::refuse_without_room(Pending& pending, Room& room) const {
  try {
    room.take_image(static_cast<std::int64_t>(bytes_kept(pending).size()));
    return false;
  } catch (const ContractError&) {
    *pending.outcome = std::current_exception();
    return pending.settled = true;
  }
}

// Nothing of an image that the map has under another name.
std::span<const std::uint8_t> UploadSession::bytes_kept(const Pending& pending) const {
  const bool has_twin = pending.ignored_reason == IgnoredReason::kIdentical;
  return settings_.store_images && !has_twin ? pending.upload->bytes : std::span<const std::uint8_t>{};
}

std::string UploadSession::free_name(const Reader& db, const NamesOfGroup& names, const std::string& wanted) const {
  std::string name = wanted;
  for (int i = 2; names.contains(name) || find_image(db, map_.id, name); ++i) {
    name = wanted + "-" + std::to_string(i);
  }
  return name;
}

// A file that the map has under another name shows nothing new, and is not looked at.
bool UploadSession::decide_by_content(const Reader& db, Pending& pending, const ContentsOfGroup& contents) const {
  AnalyzedImage& image = pending.prepared.image;
  MappingDecision& decision = pending.decision;
  if (const auto stored = find_image(db, map_.id, pending.prepared.hash)) {
    image.media_type = stored->media_type;
    image.width_px = stored->width_px;
    image.height_px = stored->height_px;
    image.features = stored->features;
    decision.similar_to = stored->vertex ? *stored->vertex : stored->similar_to.value_or(VertexId{});
    decision.inliers = stored->vertex ? stored->features : stored->inliers;
  } else if (const auto earlier = contents.find(pending.prepared.hash); earlier != contents.end()) {
    const Pending& first = *earlier->second;
    const bool is_vertex = first.decision.outcome == MappingDecision::Outcome::kInserted;
    decision.similar_to = is_vertex ? first.vertex : first.decision.similar_to;
    decision.inliers = is_vertex ? first.prepared.image.features : first.decision.inliers;
  } else {
    return false;
  }
  decision.outcome = MappingDecision::Outcome::kIgnored;
  pending.ignored_reason = IgnoredReason::kIdentical;
  return true;
}

void UploadSession::decide_one(Pending& pending, std::uint32_t vertices) {
  // The image with the same bytes was deleted while this one waited.
  if (!pending.prepared.image.vector) pending.prepared.image = analyzed(*pending.upload);
  const Stopwatch watch;
  std::shared_ptr<const LeafSource> leaf = loaded_;
  if (!leaf) leaf = std::make_shared<StoredMap>(context_.store, map_.id, map_.vocabulary);
  const MapSnapshot view(map_.id, vertices, leaf);
  const TimedVerifier verifier(*verifier_);
  pending.decision = mapweld::decide(*pending.prepared.image.vector, view, verifier, settings_.parameters);
  pending.vertex = VertexId{vertices};
  if (pending.decision.outcome == MappingDecision::Outcome::kInserted) {
    pending.prepared.image.vector = std::make_shared<const AppearanceVector>(std::move(pending.decision.image));
    std::vector<VertexId> neighbours;
    for (const LocalizationMatch& match : pending.decision.edges) neighbours.push_back(match.vertex);
    if (loaded_ && loaded_->append(pending.prepared.image.vector, neighbours) != pending.vertex) {
      context_.cache.forget(map_.id);  // read anew by whoever opens it next
      throw StoreError(StoreErrorKind::kInternal, "the map in memory has other vertices than the stored one");
    }
  }
  pending.decided_in_s = watch.elapsed_s();
  context_.metrics.stage(Stage::kVerify).record(verifier.elapsed_s());
  context_.metrics.stage(Stage::kVote).record(pending.decided_in_s - verifier.elapsed_s());
}

void UploadSession::write_all(std::vector<Pending>& group) {
  const Stopwatch watch;
  std::size_t written = 0;
  {
    WriteTransaction db = context_.store.write();
    if (!find_map(db, map_.id)) throw_deleted();
    const VerifierId verifier = intern_verifier(db, verifier_->version(), verifier_parameters());
    for (Pending& pending : group) {
      if (pending.settled || pending.same_as) continue;
      write_one(db, pending, verifier);
      ++written;
    }
    if (written == 0) return finish_repeats(group);
    require_images_fit(db, caller_);
    if (keep_) keep_all(db, group, watch.elapsed_s() / static_cast<double>(written));
    db.commit();
  }
  const double commit_s = watch.elapsed_s() / static_cast<double>(written);
  for (Pending& pending : group) {
    if (pending.settled || pending.same_as) continue;
    context_.metrics.stage(Stage::kCommit).record(commit_s);
    auto& upload = std::get<UploadOutcome>(*pending.outcome).upload;
    upload.took_ms = shown_ms(pending.prepared.image.took_s + pending.decided_in_s + commit_s);
    if (context_.stored) context_.stored(map_.name, upload);
  }
  finish_repeats(group);
}

void UploadSession::keep_all(WriteTransaction& db, std::vector<Pending>& group, double written_s) const {
  for (Pending& pending : group) {
    if (pending.settled || pending.same_as) continue;
    auto& outcome = std::get<UploadOutcome>(*pending.outcome);
    outcome.upload.took_ms = shown_ms(pending.prepared.image.took_s + pending.decided_in_s + written_s);
    keep_(db, {pending.place, outcome});
  }
}

void UploadSession::finish_repeats(std::vector<Pending>& group) {
  for (Pending& pending : group) {
    if (!pending.same_as) continue;
    *pending.outcome = *pending.same_as->outcome;
    std::get<UploadOutcome>(*pending.outcome).created = false;
  }
}

void UploadSession::write_one(WriteTransaction& db, Pending& pending, VerifierId verifier) const {
  const AnalyzedImage& image = pending.prepared.image;
  const MappingDecision& decision = pending.decision;
  NewImage row;
  row.name = pending.name;
  row.sha256 = pending.prepared.hash;
  row.media_type = image.media_type;
  row.width_px = image.width_px;
  row.height_px = image.height_px;
  row.features = image.features;
  row.provenance = pending.upload->provenance;
  row.reason = decision.reason;
  row.uploaded_at = now();
  row.bytes = bytes_kept(pending);
  if (caller_ != nullptr) row.owner = caller_->id;
  if (decision.outcome == MappingDecision::Outcome::kIgnored) {
    insert_ignored(db, map_.id, row, decision.similar_to, decision.inliers, pending.ignored_reason);
    *pending.outcome =
        UploadOutcome{ignored(decision.similar_to, decision.inliers, pending.ignored_reason, row.name, row.features)};
    return;
  }
  UploadOutcome outcome{inserted(pending.vertex, row.name, row.features, decision.reason), true};
  std::vector<NewEdge> edges;
  for (const LocalizationMatch& match : decision.edges) {
    NewEdge edge;
    edge.u = match.vertex;
    edge.votes = match.votes;
    edge.verification = mirrored(match.verification);  // found as verify(new, old), stored from old to new
    outcome.upload.edges->push_back({.vertex = to_index(match.vertex),
                                     .votes = match.votes,
                                     .inliers = match.verification.inliers,
                                     .confirmed = edge.judgement.doubt == Reason::kNone,
                                     .confidence = edge.judgement.confidence});
    edges.push_back(std::move(edge));
  }
  const VertexId vertex = insert_vertex(db, map_.id, map_.vocabulary, row, *image.vector, edges, verifier);
  if (vertex != pending.vertex) throw std::logic_error("a vertex got another number than it was decided under");
  *pending.outcome = std::move(outcome);
}

std::string UploadSession::verifier_parameters() const {
  const VerifierOptions& options = verifier_->options();
  return contract::dump({{"min_inliers", options.min_inliers}, {"max_false_alarms", options.max_false_alarms}});
}

void UploadSession::throw_deleted() const {
  throw ContractError("no_such_map", "The map \"" + map_.name + "\" was deleted.");
}

}  // namespace mapweld::server
