#include "core/merge/merge_input.h"

#include <utility>

namespace mapweld {

std::vector<MergeMember> number_members(const std::vector<std::uint32_t>& sizes) {
  std::vector<MergeMember> members;
  members.reserve(sizes.size());
  std::uint32_t next = 0;
  for (const std::uint32_t size : sizes) {
    MergeMember member;
    member.vertices.reserve(size);
    for (std::uint32_t i = 0; i < size; ++i) member.vertices.push_back(VertexId{next++});
    members.push_back(std::move(member));
  }
  return members;
}

MemberPair order_members(const std::vector<MergeMember>& members, std::size_t i, std::size_t j) {
  const bool first_is_smaller = members.at(i).vertices.size() < members.at(j).vertices.size();
  return first_is_smaller ? MemberPair{j, i} : MemberPair{i, j};
}

std::vector<MemberPair> all_member_pairs(const std::vector<MergeMember>& members) {
  std::vector<MemberPair> pairs;
  for (std::size_t i = 0; i < members.size(); ++i) {
    for (std::size_t j = i + 1; j < members.size(); ++j) pairs.push_back(order_members(members, i, j));
  }
  return pairs;
}

std::size_t place_of_pair(std::size_t i, std::size_t j, std::size_t members) {
  if (i > j) std::swap(i, j);
  return i * (2 * members - i - 1) / 2 + (j - i - 1);
}

}  // namespace mapweld
