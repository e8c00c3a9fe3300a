// A queue of many, largest first, few of which will be asked for.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace mapweld {

// Gives what one heap over all items would give. But only the largest are a heap, small enough for a processor's cache;
// others are brought in, twice as many each time, when one of them is next. T: a total order by <.
template <typename T>
class LargestFirst {
 public:
  // About so many items will be asked for.
  LargestFirst(std::vector<T> items, std::size_t expected) : rest_(std::move(items)), share_(2 * expected + 64) {
    bring_in();
  }
  bool empty() const { return heap_.empty(); }
  const T& front() const { return heap_.front(); }  // the largest
  T pop() {
    std::pop_heap(heap_.begin(), heap_.end());
    const T item = heap_.back();
    heap_.pop_back();
    bring_in();
    return item;
  }
  void push(const T& item) {
    heap_.push_back(item);
    std::push_heap(heap_.begin(), heap_.end());
  }

 private:
  // Until none of the rest is larger than the front.
  void bring_in() {
    while (!rest_.empty() && (heap_.empty() || heap_.front() < largest_of_rest_)) {
      const std::size_t share = std::min(share_, rest_.size()), left = rest_.size() - share;
      const auto begin = rest_.begin() + static_cast<std::ptrdiff_t>(left);
      if (left > 0) std::nth_element(rest_.begin(), begin, rest_.end());
      heap_.insert(heap_.end(), begin, rest_.end());
      std::make_heap(heap_.begin(), heap_.end());
      rest_.erase(begin, rest_.end());
      if (left > 0) largest_of_rest_ = *std::max_element(rest_.begin(), rest_.end());
      share_ *= 2;
    }
  }

  std::vector<T> heap_, rest_;
  T largest_of_rest_{};
  std::size_t share_;
};

}  // namespace mapweld
