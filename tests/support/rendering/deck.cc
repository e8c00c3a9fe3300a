#include "tests/support/rendering/deck.h"

#include <algorithm>

#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {

Deck::Deck(std::uint64_t seed, int designs, int posters_in_two_places)
    : seed_(seed), designs_(std::max(1, designs)), to_repeat_(posters_in_two_places) {}

std::uint64_t Deck::deal(Design kind, std::uint64_t key) {
  const auto [place, is_new] = places_.try_emplace({kind, key}, 0);
  if (!is_new) return place->second;
  std::vector<std::uint64_t>& cards = cards_[kind];
  std::size_t& dealt = dealt_[kind];
  if (dealt == cards.size()) {
    std::vector<std::uint64_t> more(static_cast<std::size_t>(designs_));
    for (std::size_t i = 0; i < more.size(); ++i) more[i] = i;
    Random random(hash_of(seed_, static_cast<int>(kind), cards.size()));
    random.shuffle(more);
    cards.insert(cards.end(), more.begin(), more.end());
  }
  // Every third poster after the first eight hangs for the second time, as long as any are to be repeated.
  if (kind == Design::kPoster && to_repeat_ > 0 && dealt >= 8 && places_.size() % 3 == 0) {
    --to_repeat_;
    place->second = cards[static_cast<std::size_t>(to_repeat_) % 8];
  } else {
    place->second = cards[dealt++];
  }
  return place->second;
}

}  // namespace mapweld::rendered
